"""The local compliance that law and beam model both count, taken out: `contact_compliance: beam`.

A contact law is that of two half-spaces: its approach is measured from points far away. The beam's
axis lies half a depth below, the sphere's centre a radius above. With F the contact force and M
the moment at mid-span the approach of sphere and Timoshenko beam is

    delta + c F + gamma M/(EI),   c = c_b/(E_b H) + c_s/(E_s R),   gamma = g H^2

c_b and g, of H/B and Poisson's ratio, are what 3-D elastic statics of a beam under a point force
add to the half-space and Timoshenko's deflection (k = 5/6): two spans separate the part that
grows with the moment from the rest. c_s, of Poisson's ratio, is that of a free sphere whose even
deceleration balances the force. tests/benchmarks/contact_compliance.py makes the table; on the
paper's beam finer elements change it by 0.2 %. In statics M = F L/4, and gamma M/(EI) is most of
the compliance; in an impact the moment is some tenth of that, which is why a constant from
statics takes back too much.

The indentation is the approach of sphere and axis. By the same statics the axis beneath the force
lies a part of F and one of M below Timoshenko's deflection: `AXIS_FORCE`, `AXIS_MOMENT`.

Left out: what the section does in waves across the width or shorter than it, and c_s for other
circles than R/16 (from R/33 to R/8, 6 % of it).

`contact_compliance: strip` gives the section's bending across the width its inertia
(solver/strip.py). Its stiffness D_s, inertia, lever l and twist T are tables, too, of the modes of
the elastic section (tests/benchmarks/section_modes.py): one half as deep as wide takes 1.5 times as
long to swing across as its plate would without shear and rotary inertia. What the bending across
does in statics, on a long beam, is then no part of c and gamma:

    c_w = (l + nu T/(EI))^2/(2 sqrt(e T)),   gamma_w = -nu (2 l + nu T/(EI)),
    e = D_s EI/(EI + nu^2 D_s)

(deflection of the strip's middle by waves cos(k x): parts in k^-2 and in 1/(e + T k^2)).

The same statics have the stress under the force beyond the half-space's: that of beam theory by the
moment, and one by the force, which keeps the section from bending freely beneath it. They are what
`contact_prestress: bending` takes (solver/contact/prestress.py). A strip's own static stress across
the width, -3/4 (1 + 5 nu)/sqrt(6 (1 + nu)) F/H^2 at the surface of a long beam, is no part of it.
"""

from typing import Any, NamedTuple

import numpy as np

from impactlab.model.bodies import sphere_rows
from impactlab.model.impact import OTHER_SECTION, Impact
from impactlab.model.shapes import Rectangle
from impactlab.solver import RESISTANCES
from impactlab.types import Floats

DEPTHS = (0.2, 0.3, 0.45, 0.7, 1.0, 1.5, 2.5, 4.0)
"""H/B of the table."""
RATIOS = (0.0, 0.25, 0.45)
"""Poisson's ratios of the table."""
FORCE = np.array(
    [
        [0.615, 2.2682, 3.8894],
        [-0.1538, 0.5056, 1.134],
        [-0.5792, -0.3155, -0.0515],
        [-0.869, -0.7543, -0.5982],
        [-1.0379, -0.9555, -0.7969],
        [-1.1702, -1.0871, -0.8795],
        [-1.1346, -1.0241, -0.7044],
        [-0.6394, -0.479, 0.0319],
    ]
)
"""c_b = c E H at these, shape (depths, ratios)."""
MOMENT = np.array(
    [
        [-0.0064, -0.7086, -1.4125],
        [-0.0015, -0.3307, -0.6448],
        [-0.0004, -0.1689, -0.3199],
        [-0.0004, -0.0968, -0.178],
        [-0.0002, -0.0722, -0.131],
        [-0.0002, -0.0597, -0.1076],
        [-0.0002, -0.0536, -0.0963],
        [-0.0002, -0.0515, -0.0926],
    ]
)
"""g = gamma/H^2 at these."""
AXIS_FORCE = np.array(
    [
        [1.62, 3.3521, 5.0012],
        [0.8512, 1.5578, 2.1774],
        [0.4255, 0.7031, 0.9179],
        [0.1307, 0.2189, 0.273],
        [-0.0535, -0.0347, -0.0324],
        [-0.2373, -0.2679, -0.3012],
        [-0.4589, -0.5325, -0.602],
        [-0.7315, -0.8375, -0.9307],
    ]
)
"""FORCE for the beam's axis instead of its surface."""
AXIS_MOMENT = np.array(
    [
        [-0.0064, -0.6773, -1.356],
        [-0.0015, -0.2994, -0.5884],
        [-0.0004, -0.1376, -0.2636],
        [-0.0004, -0.0655, -0.1217],
        [-0.0002, -0.041, -0.0747],
        [-0.0002, -0.0285, -0.0514],
        [-0.0002, -0.0223, -0.0401],
        [-0.0002, -0.0203, -0.0363],
    ]
)
"""MOMENT for the axis."""
AT = 0.1
"""Depths below the force at which the next two tables give stresses."""
STRESS_ALONG = np.array(
    [
        [0.0672, 0.0245, -0.004],
        [0.2251, 0.2197, 0.2184],
        [0.3854, 0.4166, 0.4426],
        [0.5641, 0.6391, 0.6951],
        [0.6891, 0.8098, 0.8824],
        [0.7862, 1.0147, 1.147],
        [0.683, 1.2933, 1.8329],
        [0.2225, 1.8398, 3.806],
    ]
)
"""Stress along the beam per F/H^2, beyond those of half-space and moment."""
STRESS_ACROSS = np.array(
    [
        [-0.424, -0.6382, -0.7655],
        [-0.2793, -0.4334, -0.5149],
        [-0.1379, -0.2135, -0.2365],
        [0.0025, 0.0446, 0.1062],
        [0.082, 0.2593, 0.4108],
        [0.189, 0.6268, 0.9754],
        [0.5749, 1.7104, 2.7709],
        [1.4004, 3.8179, 6.3569],
    ]
)
"""Stress across the beam, likewise."""
SPHERE = (0.0158, -0.2795, -0.3359)
"""c_s = c E R at these ratios."""
CROWDING, CROWDING_IN_DEPTH = 1.2, 0.18
"""c times the square of half the width, of a beam at least as deep as wide, and of half the depth,
of one at least twice as wide as deep."""
FREE_STRIP = 720.0 / 4.730041**4
"""Inertia of the shape y^2 - B^2/12 that swings as fast as a strip of plate with free edges."""
STRIP_STIFFNESS = np.array(
    [
        [0.6567, 0.6432, 0.6237],
        [0.6368, 0.6133, 0.5792],
        [0.6203, 0.5816, 0.5247],
        [0.6159, 0.5496, 0.4523],
        [0.619, 0.5136, 0.3718],
    ]
)
"""Stiffness of a strip against bending across over D B, for the first five depths."""
STRIP_INERTIA = np.array(
    [
        [0.8216, 0.8198, 0.8169],
        [0.9819, 0.9744, 0.962],
        [1.3331, 1.3012, 1.2501],
        [2.2055, 2.0587, 1.8379],
        [3.7059, 3.2083, 2.5594],
    ]
)
"""Inertia of a strip over that of the shape that swings as fast as a plate."""
STRIP_LEVER = np.array(
    [
        [1.1162, 1.0893, 1.0515],
        [1.1652, 1.1095, 1.0332],
        [1.2753, 1.1571, 1.003],
        [1.5215, 1.2347, 0.898],
        [1.8985, 1.2639, 0.6177],
    ]
)
"""Lever of the force on a strip over B^2/24."""
STRIP_TWIST = np.array(
    [
        [0.6034, 0.65, 0.7061],
        [0.4877, 0.5108, 0.5364],
        [0.3734, 0.3764, 0.3761],
        [0.2603, 0.2449, 0.2197],
        [0.1778, 0.1469, 0.1033],
    ]
)
"""Stiffness of a strip against twisting over (1 - nu) D B^3/6."""
TIMOSHENKO_OPTIONS = {"contact_compliance": "half_space", "contact_prestress": "ignored"}
"""Options that only the Timoshenko beam has, with their values for other beams."""
TIMOSHENKO_ALONE = "is for Timoshenko's beam: set beam_model: timoshenko"
LEAST_SPAN = 3.0
"""Shortest span in the table, over the larger of depth and width."""


def _at_ratio(nu: Floats, values: Floats) -> Floats:
    """Return the parabola through `values` (..., ratios), at nu (...)."""
    total = np.zeros(np.shape(nu))
    for i, ratio in enumerate(RATIOS):
        rest = [other for other in RATIOS if other != ratio]
        share = np.prod([(nu - other) / (ratio - other) for other in rest], axis=0)
        total = total + share * values[..., i]
    return total


def case_fields(impact: Impact) -> dict[str, Floats]:
    """Return the fields of solver.types.CASE that hold local compliance and stress, zero if none.

    Raises ValueError as `contact_compliance` and `contact_stress`.
    """
    local = "compliance", "bending_compliance", "axis_compliance", "axis_bending"
    across = "width_stiffness", "width_inertia", "width_lever", "width_twist"
    stress, crowded = ("stress_along", "stress_across"), ("crowding", "crowding_in_depth")
    fields: dict[str, Floats] = dict.fromkeys((*local, *across, *stress, *crowded), np.zeros(()))
    if np.any(np.not_equal(impact.contact_compliance, "half_space")):
        values = *contact_compliance(impact), *axis_compliance(impact)
        fields |= zip(local, values, strict=True)
        fields |= zip(across, bending_across(impact)[:4], strict=True)
        fields |= zip(crowded, crowding(impact), strict=True)
    if np.any(np.not_equal(impact.contact_prestress, "ignored")):
        fields |= zip(stress, contact_stress(impact), strict=True)
    return fields


def contact_compliance(impact: Impact) -> tuple[Floats, Floats]:
    """Return c (m/N) and gamma (m2) of an impact, or of many; zero for half-spaces.

    A strip's do not include its bending across the width.

    Raises ValueError where `beam_model` is not "timoshenko", the beam is outside the table, struck
    near an end, or a strip deeper than wide or with a free end.
    """
    applies = np.not_equal(impact.contact_compliance, "half_space")
    beam, sphere = impact.beam, impact.sphere
    strip = np.equal(impact.contact_compliance, "strip")
    refused = f"Impact.contact_compliance = {'strip' if np.any(strip) else 'beam'!r}: "
    _within_table(impact, applies, refused)
    if np.any(strip & (beam.depth > beam.width)):
        raise ValueError(f"{refused}needs a beam as wide as deep at least: set 'beam'")
    moving = "free", "elastic"
    free = np.isin(beam.support_left, moving) | np.isin(beam.support_right, moving)
    if np.any(strip & free):
        raise ValueError(f"{refused}needs ends that are pinned or clamped: set 'beam'")
    for name in RESISTANCES:
        if np.any(strip & np.greater(getattr(beam, name), 0.0)):
            raise ValueError(f"{refused}needs a beam without {name}: set 'beam', or {name}: 0")
    c, gamma = _of_beam(impact, FORCE, MOMENT)
    ball = _at_ratio(np.asarray(sphere.material.poissons_ratio), np.asarray(SPHERE))
    c = c + ball / (sphere.material.youngs_modulus * sphere.radius)
    across = _across_width(impact)
    c, gamma = (
        np.where(strip, value - part, value) for value, part in zip((c, gamma), across, strict=True)
    )
    return np.where(applies, c, 0.0), np.where(applies, gamma, 0.0)


def crowding(impact: Impact) -> tuple[Floats, Floats]:
    """Return c and d of contact/finite_element.py (1/m2) of an impact, or of many.

    Zero for half-spaces. A beam at least as deep as wide has c alone, one at least twice as wide as
    deep d alone, and in between what both do counts in proportion. Fitted to 3-D runs
    (tests/benchmarks/large_contacts.py, metals.py).
    """
    width, depth = np.asarray(impact.beam.width), np.asarray(impact.beam.depth)
    share = np.clip(2.0 * depth / width - 1.0, 0.0, 1.0)
    applies = 4.0 * np.not_equal(impact.contact_compliance, "half_space")
    in_depth = CROWDING_IN_DEPTH / depth**2
    # the law's powers 1.5 and 1.25 make shares of these
    c = share ** (2.0 / 3.0) * (CROWDING / width**2 + in_depth)
    return applies * c, applies * (1.0 - share) ** 0.8 * in_depth


def axis_compliance(impact: Impact) -> tuple[Floats, Floats]:
    """Return the distance of the beam's axis below mid-section, of one impact or of many.

    Per force (m/N) and per M/(EI) (m2), without a strip's bending across the width; zero for
    half-spaces, whose indentation is the approach of the sphere and the mean of the section.
    """
    applies = np.not_equal(impact.contact_compliance, "half_space")
    strip = np.equal(impact.contact_compliance, "strip")
    pairs = zip(_of_beam(impact, AXIS_FORCE, AXIS_MOMENT), _across_width(impact), strict=True)
    c, gamma = (np.where(applies, value - strip * part, 0.0) for value, part in pairs)
    return c, gamma


def contact_stress(impact: Impact) -> tuple[Floats, Floats]:
    """Return the stress under the contact along and across the beam per contact force, in 1/m2.

    Beyond those of the half-space, of the moment and of a strip's own bending, of one impact or of
    many; zero where `contact_prestress` is ignored.

    Raises ValueError where `beam_model` is not "timoshenko", or the beam is outside the table or
    struck near an end.
    """
    applies = np.not_equal(impact.contact_prestress, "ignored")
    _within_table(impact, applies, "Impact.contact_prestress = 'bending': ")
    square = impact.beam.depth * impact.beam.depth
    along, across = (_from_table(impact, table) for table in (STRESS_ALONG, STRESS_ACROSS))
    strip = _strip(impact)
    bent = (1.0 - 2.0 * AT) * 3.0 * strip.stretch * strip.decay / impact.beam.width
    across = across + np.where(np.equal(impact.contact_compliance, "strip"), bent, 0.0)
    return np.where(applies, along / square, 0.0), np.where(applies, across / square, 0.0)


def _within_table(impact: Impact, applies: np.ndarray[Any, Any], refused: str) -> None:
    """Raise ValueError, its text begun, where a beam that `applies` marks is not in the tables."""
    beam = impact.beam
    if np.any(applies & np.not_equal(impact.beam_model, "timoshenko")):
        raise ValueError(f"{refused}{TIMOSHENKO_ALONE}")
    if np.any(applies & np.not_equal(beam.shape, "rectangle")):
        default = TIMOSHENKO_OPTIONS[refused.split(" = ")[0].split(".")[1]]
        raise ValueError(f"{refused}must be {default} {OTHER_SECTION}")
    shape = np.asarray(beam.depth / beam.width)
    if np.any(applies & ((shape < DEPTHS[0]) | (shape > DEPTHS[-1]))):
        raise ValueError(
            f"{refused}needs a beam of depth over width from {DEPTHS[0]} to {DEPTHS[-1]}"
        )
    if np.any(applies & (beam.span < LEAST_SPAN * np.maximum(beam.depth, beam.width))):
        raise ValueError(f"{refused}needs a span of {LEAST_SPAN:g} depths and widths at least")
    place, near = np.asarray(impact.strike_position), 0.5 * LEAST_SPAN
    near = near * np.maximum(beam.depth, beam.width)
    others: list[Any] = [row[0] for row in sphere_rows(impact.further_spheres or ())]
    for k, other in enumerate(others):
        room = np.minimum(other, 1.0 - other)
        for neighbour in (place, *others[:k]):
            room = np.minimum(room, np.abs(neighbour - other))
        if np.any(applies & (room * beam.span < near)):
            raise ValueError(
                f"{refused}needs further_spheres {0.5 * LEAST_SPAN:g} depths and widths from each "
                "other and from the ends at least: change their strike_position, or set it to "
                f"{TIMOSHENKO_OPTIONS[refused.split(' = ')[0].split('.')[1]]}"
            )
    room = np.minimum(place, 1.0 - place) * beam.span
    if np.any(applies & (room < near)):
        raise ValueError(
            f"{refused}needs a strike {0.5 * LEAST_SPAN:g} depths and widths from the ends at "
            "least: change strike_position, or set it to "
            f"{TIMOSHENKO_OPTIONS[refused.split(' = ')[0].split('.')[1]]}"
        )


def _from_table(impact: Impact, table: Floats) -> Floats:
    """Return a table's value at the beam's depth over width and Poisson's ratio."""
    from scipy.interpolate import CubicSpline  # half a second to import, for few

    shape = np.asarray(impact.beam.depth / impact.beam.width)
    log = np.log(np.minimum(shape, DEPTHS[len(table) - 1]))  # tables of strips end at 1
    nu = np.asarray(impact.beam.material.poissons_ratio)
    return _at_ratio(nu, CubicSpline(np.log(DEPTHS[: len(table)]), table)(log))


def _of_beam(impact: Impact, force: Floats, moment: Floats) -> tuple[Floats, Floats]:
    """Return c (m/N) and gamma (m2) of the beam from two tables."""
    beam, nu = impact.beam, np.asarray(impact.beam.material.poissons_ratio)
    c, g = (_from_table(impact, table) for table in (force, moment))
    shear = (1.0 / beam.shear_correction - 6.0 / 5.0) * (1.0 + nu) / 6.0
    c = c / (beam.material.youngs_modulus * beam.depth)
    return c, (g - shear) * beam.depth * beam.depth


class Strip(NamedTuple):
    """Constants of bending across the width: stiffness D_s (N m2), inertia (kg m3), lever (m2).

    twist: T (N m4). stretch: l + nu T/(EI) (m2). decay: sqrt(e/T) (1/m) of a bend along the beam.
    """

    stiffness: Floats
    inertia: Floats
    lever: Floats
    twist: Floats
    stretch: Floats
    decay: Floats


def _strip(impact: Impact) -> Strip:
    """Return the constants of the beam as a strip, of an impact or of many."""
    beam, nu = impact.beam, np.asarray(impact.beam.material.poissons_ratio)
    square, along = beam.width * beam.width, beam.bending_stiffness
    plate = Rectangle(beam.width, beam.depth).plate_stiffness(beam.material.youngs_modulus, nu)
    stiffness = plate * _from_table(impact, STRIP_STIFFNESS)
    usual = FREE_STRIP * beam.mass_per_length * square * square / 720.0
    inertia = usual * _from_table(impact, STRIP_INERTIA)
    lever = square / 24.0 * _from_table(impact, STRIP_LEVER)
    twist = (1.0 - nu) * plate * square / 6.0 * _from_table(impact, STRIP_TWIST)
    reduced = stiffness * along / (along + nu * nu * stiffness)
    decay = np.sqrt(reduced / twist)
    return Strip(stiffness, inertia, lever, twist, lever + nu * twist / along, decay)


def _across_width(impact: Impact) -> tuple[Floats, Floats]:
    """Return c_w (m/N) and gamma_w (m2) of bending across the width, as on a strip."""
    nu, strip = np.asarray(impact.beam.material.poissons_ratio), _strip(impact)
    force = strip.stretch**2 / (2.0 * strip.decay * strip.twist)
    return force, -nu * (strip.lever + strip.stretch)


def bending_across(impact: Impact) -> Strip:
    """Return the constants of a strip (solver/strip.py), of an impact or of many.

    Zero for other beams.
    """
    strip = np.equal(impact.contact_compliance, "strip")
    return Strip(*(np.where(strip, value, 0.0) for value in _strip(impact)))
