"""Physical limits of beams and spheres, which an impact is checked against before it is solved.

The model's classes refuse values that have no meaning in an equation (a mass of zero, a depth
above the span). The limits here come from physics, each with its reason: impossible values are
refused in studies and commands, and implausible ones give a warning.
"""

from collections.abc import Iterator, Mapping
from math import inf, sqrt
from operator import attrgetter
from typing import Any, NamedTuple

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.model.quantities import misread
from impactlab.model.section import THICKNESSES

LIGHT = 299_792_458.0
"""Speed of light, m/s."""
_PIERCES = 0.1
"""Damage number rho v^2/sigma_y from which on metals deform extensively (Johnson, Impact Strength
of Materials, 1972): a dent is then no longer small beside the sphere."""
_DAMPED = 0.2  # of critical, of the first mode
_STOCKY = 0.2  # depth over span from which on shear is no small part of a beam's deflection


class ImplausibleWarning(UserWarning):
    """A value that is implausible, or even impossible.

    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", il.ImplausibleWarning)
    ...     run = il.simulate(il.paper_impact("2 km/s"), duration="1 ms")
    Traceback (most recent call last):
    impactlab.model.plausibility.ImplausibleWarning: velocity: 2000 m/s: density velocity²/yield ...
    """


class TooShortWarning(UserWarning):
    """A duration that ends before some responses can be given.

    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", il.TooShortWarning)
    ...     run = il.simulate(il.paper_impact(), duration="0.3 ms")
    """


class Implausibility(NamedTuple):
    """A parameter with an implausible, or even impossible, value, and the reason."""

    name: str
    reason: str
    impossible: bool


HEAVIEST = 23e3
"""Density of osmium in kg/m3; a denser body stands for one that does not move: no waves in it."""
_DENSITY = (0.1, 10.0, HEAVIEST, inf, "kg/m3", "solids have 10 (foam) to 22,600 (osmium)")
_STIFFNESS = (1e3, 1e6, 1.3e12, 1e15, "Pa", "solids have 1 MPa (rubber) to 1.2 TPa (diamond)")
_STRENGTH = (1e3, 1e5, 1e11, 1e15, "Pa", "solids yield from 0.1 MPa on; mPa is not MPa")
_LIMITS = {
    "sphere_density": _DENSITY,
    "beam_density": _DENSITY,
    "sphere_youngs_modulus": _STIFFNESS,
    "beam_youngs_modulus": _STIFFNESS,
    "sphere_yield_stress": _STRENGTH,
    "beam_yield_stress": _STRENGTH,
    "gravity": (0.0, 0.0, 300.0, inf, "m/s2", "274 is that of the sun"),
    "velocity": (1e-9, 1e-6, inf, inf, "m/s", "atoms are 1e-10 m wide"),
    "sphere_mass": (1e-18, 1e-12, 1e6, inf, "kg", "a speck of dust has 1e-12 kg"),
    "beam_span": (1e-9, 1e-6, 1e3, inf, "m", "atoms are 1e-10 m wide"),
    "sphere_radius": (1e-9, 1e-6, 10.0, inf, "m", "atoms are 1e-10 m wide"),
    "beam_depth": (1e-9, 1e-6, 10.0, inf, "m", "atoms are 1e-10 m wide"),
    "beam_width": (1e-9, 1e-6, 100.0, inf, "m", "atoms are 1e-10 m wide"),
    "foundation_stiffness": (0.0, 0.0, 1e11, inf, "N/m2", "a block of steel has about 1e11"),
    "damping_ratio": (0.0, 0.0, _DAMPED, inf, "of critical", "metal structures have 0.001 to 0.05"),
    **{
        f"beam_{field}": (1e-9, 1e-6, 1.0, inf, "m", "atoms are 1e-10 m wide")
        for field in THICKNESSES
    },
}
"""By parameter: the least possible value, the ends of what is plausible, the largest possible
value; units and reason."""

Extremes = Mapping[str, tuple[float, float]]
"""The least and the greatest value of every number of some impacts, in SI units."""


def numbers(impact: Impact, discretisation: Discretisation) -> dict[str, tuple[float, float]]:
    """Return the extremes of one impact: each number twice."""
    values = flatten(impact, discretisation).items()
    return {name: (value, value) for name, value in values if not isinstance(value, str)}


def implausibilities(ends: Extremes) -> list[Implausibility]:
    """Return the impossible and implausible values, one per parameter."""
    entries = []
    for name, (least, low, high, most, units, basis) in _LIMITS.items():
        first, last = ends.get(name, (low, high))
        for value, impossible, doubted in (
            (first, first < least, first < low),
            (last, last > most, last > high),
        ):
            if impossible or doubted:
                verdict = "is impossible" if impossible else "is implausible"
                reason = f"{value:g} {units} {verdict}: {basis}"
                entries.append(Implausibility(name, reason, impossible))
    entries = sorted([*entries, *_together(ends)], key=attrgetter("impossible"))
    doubts = {}
    for name, reason, impossible in entries:
        remarks = [without_unit({name: value}) for value in ends[name]]
        reason += next(filter(None, remarks), "")
        doubts[name] = Implausibility(name, reason, impossible)
    return list(doubts.values())


def without_unit(values: Mapping[str, Any]) -> str:
    """Return the remark of `misread` on the first parameter that needs it, "" where none does.

    values: by name of the parameter, in SI units; words are left out.
    """
    for name, value in values.items():
        if name in _LIMITS and isinstance(value, float | int):
            _, low, high, *_ = _LIMITS[name]
            low = max(low, 1e9) if name.endswith("modulus") else low  # in GPa, as metals have it
            if remark := misread(value, PARAMETERS[name].units, low, high):
                return remark
    return ""


def _together(ends: Extremes) -> Iterator[Implausibility]:
    """Yield values that are implausible together, at the worst ends."""
    velocity = ends["velocity"][1]
    for body in ("beam", "sphere"):
        lightest, heaviest = ends[f"{body}_density"]
        soft, stiff = ends[f"{body}_youngs_modulus"]
        weak, strong = ends[f"{body}_yield_stress"]
        if (fastest := sqrt(stiff / lightest)) >= LIGHT:
            reason = (
                f"a bar wave in the {body} would run at {fastest:.3g} m/s, faster than light: "
                "check the units of density and Young's modulus"
            )
            yield Implausibility(f"{body}_density", reason, True)
        if velocity >= (wave := sqrt(soft / min(heaviest, HEAVIEST))):
            reason = (
                f"{velocity:g} m/s is above the speed of a bar wave in the {body} ({wave:.4g} m/s)"
                ": quasi-static contact laws and beam theory do not apply: reduce it"
            )
            yield Implausibility("velocity", reason, True)
        number = min(lightest, HEAVIEST) * velocity**2 / weak
        if number > _PIERCES:
            reason = (
                f"{velocity:g} m/s: density velocity²/yield stress of the {body} is {number:.2g}; "
                f"above {_PIERCES} metals flow, and the dent is no longer small"
            )
            yield Implausibility("velocity", reason, False)
        if strong > 0.1 * soft:
            reason = (
                f"{strong:g} Pa is above a tenth of Young's modulus, the strength of a perfect "
                "crystal: are both in Pa?"
            )
            yield Implausibility(f"{body}_yield_stress", reason, False)
    depth, span, radius = ends["beam_depth"][1], ends["beam_span"][0], ends["sphere_radius"][1]
    if depth > _STOCKY * span:
        reason = f"{depth:g} m is above a fifth of the span: shear matters (beam_model: timoshenko)"
        yield Implausibility("beam_depth", reason, False)
    depths, spans = ends["beam_depth"], ends["beam_span"]
    slowest, fastest = (
        9.87
        * depths[i]
        / spans[1 - i] ** 2
        * sqrt(ends["beam_youngs_modulus"][i] / ends["beam_density"][1 - i] / 12.0)
        for i in (0, 1)
    )
    for field, ratio in (
        ("mass_damping", 0.5 * ends["mass_damping"][1] / slowest),
        ("stiffness_damping", 0.5 * ends["stiffness_damping"][1] * fastest),
    ):
        if ratio > _DAMPED:
            reason = (
                f"{ends[field][1]:g} {PARAMETERS[field].units} damps the first mode of a pinned "
                f"beam by {ratio:.2g} of critical: metal structures have 0.001 to 0.05"
            )
            yield Implausibility(field, reason, False)
    if radius > 0.5 * span:
        reason = f"{radius:g} m makes the sphere wider than the span"
        yield Implausibility("sphere_radius", reason, False)
