"""Misprints of the paper, then observations of ours on what it leaves open.

All but the last are tested by closed forms, without runs. The scheme's stability: the elastic beam
under leapfrog, w_tt = -(EI/mu) w_xxxx by second differences twice, simply supported, without
contact and without fibres, by von Neumann's analysis (see e.g. Hughes, The Finite Element Method
(1987), section 9.2) and by a plain march. Symbols there: dx (m), node spacing; dt (s), time step;
EI (N m2); mu (kg/m); omega (1/s), the highest frequency of the grid; lambda, the factor by which
its mode grows each step.
"""

import math
from collections.abc import Callable

import numpy as np

from impactlab.model.bodies import Beam
from impactlab.model.impact import paper_impact
from impactlab.paper.statements.resolution import READINGS_OF_P
from impactlab.paper.statements.statement import (
    Assessment,
    Data,
    Number,
    Ruling,
    Subject,
    judged,
    runs_of,
    select_response,
    statement,
)
from impactlab.types import Floats
from impactlab.verification.solutions import bending, hertz
from impactlab.verification.solutions.contact_laws import (
    CONSTRAINT,
    HARDNESS,
    LAWS,
    U_PLASTIC,
    stronge_impact,
)

EQUAL = 1e-9  # relative difference within which two forces agree


def bar_wave_step(beam: Beam, nodes: int) -> float:
    """Return dx/sqrt(E/rho) in s: a bar wave's time over one spacing (the paper's rule)."""
    speed = math.sqrt(beam.material.youngs_modulus / beam.material.density)
    return beam.span / (nodes - 1) / speed


def bending_step(beam: Beam, nodes: int) -> float:
    """Return (dx^2/2) sqrt(mu/EI) in s: 2/omega, from which on bending is unstable."""
    return 2.0 / highest_frequency(beam, nodes)


def highest_frequency(beam: Beam, nodes: int) -> float:
    """Return omega = (4/dx^2) sqrt(EI/mu) in 1/s, of the mode that changes sign at every node.

    An upper bound that the grid reaches but for a factor of 1 - (pi/(2 nodes))^2.
    """
    dx = beam.span / (nodes - 1)
    return 4.0 / dx**2 * math.sqrt(beam.bending_stiffness / beam.mass_per_length)


def growth(frequency: float, dt: float, sign: float = 1.0) -> float:
    """Return |lambda|, the larger root of lambda^2 - (2 - sign (omega dt)^2) lambda + 1 = 0.

    sign: -1 for w_tt = +(EI/mu) w_xxxx, the moment's sign turned round.
    """
    half = abs(0.5 * sign * (frequency * dt) ** 2 - 1.0)
    return 1.0 if half <= 1.0 else half + math.sqrt(half**2 - 1.0)


def march(beam: Beam, nodes: int, dt: float, steps: int, sign: float = 1.0) -> Floats:
    """Return the largest |w| in m after each of `steps` steps of dt, from 1 m/s at mid-span.

    sign: see growth. Steps after an overflow hold infinity.
    """
    dx = beam.span / (nodes - 1)
    stiffness = sign * beam.bending_stiffness / beam.mass_per_length
    w, v = np.zeros(nodes), np.zeros(nodes)
    v[nodes // 2] = 1.0
    largest = np.full(steps, np.inf)
    for step in range(steps):
        w += dt * v
        largest[step] = np.abs(w).max()
        if largest[step] > 1e100:  # far below the floating-point limit
            largest[step:] = np.inf
            break
        curvature = np.zeros(nodes)
        curvature[1:-1] = (w[:-2] - 2.0 * w[1:-1] + w[2:]) / dx**2
        v[1:-1] -= dt * stiffness * (curvature[:-2] - 2.0 * curvature[1:-1] + curvature[2:]) / dx**2
    return largest


@statement(
    kind=Subject.MISPRINT,
    text="The scheme is stable for dt < dx/√(E/ρ).",
    test=(
        "ω dt ≤ 2 with ω = (4/dx²) √(EI/ρA), the highest frequency of the grid; and an explicit "
        "integration of the elastic beam alone with that step, after an impulse at mid-span, stays "
        "bounded. N = 601."
    ),
    cases=(
        ("as printed", bar_wave_step),
        ("the limit of bending instead, dt < (dx²/2) √(ρA/EI)", bending_step),
    ),
    holds=(
        "dt ≤ (dx²/2) √(ρA/(EI)q), (EI)q the stiffness that the integration rule gives; with "
        "the contact ω² ≤ 16 (EI)q/(ρA dx⁴) + k (1/(ρA dx) + 1/m)"
    ),
)
def time_step(data: Data, limit: Callable[[Beam, int], float]) -> Assessment:
    """Judge a step, given as a function of the beam and the number of nodes."""
    beam, nodes, steps = paper_impact().beam, 601, 20
    dt = 0.99 * limit(beam, nodes)  # the printed rule says “less than”
    frequency = highest_frequency(beam, nodes)
    largest = march(beam, nodes, dt, steps)
    grown = float(largest[-1] / largest[0])
    numbers = (
        Number("ω dt", frequency * dt, "1"),
        Number("growth of the highest mode per step", growth(frequency, dt), "1"),
        Number(f"deflection after {steps} steps over that after 1", grown, "1"),
    )
    return judged(
        numbers,
        frequency * dt <= 2.0 and grown < 1e3,
        "The solution stays bounded.",
        "It is the limit of a bar wave; bending is stiffer on a fine grid, and the solution "
        "diverges.",
    )


@statement(
    kind=Subject.MISPRINT,
    text="Eqs. 6 to 8: ρA w_tt = F − M_xx.",
    test=(
        "Every mode of the beam without load oscillates: its factor per step is at most 1, and an "
        "explicit integration after an impulse at mid-span stays bounded, at 0.99 of the largest "
        "stable step for bending, N = 601. M = −EI w_xx, as in the paper's Eq. 4."
    ),
    cases=(("as printed, − M_xx", -1.0), ("as in Eq. 4, + M_xx", 1.0)),
    holds="ρA w_tt = F + M_xx, as in its own Eq. 4",
)
def moment_sign(data: Data, sign: float) -> Assessment:
    """Judge the sign of the moment's second derivative."""
    beam, nodes, steps = paper_impact().beam, 601, 20
    dt = 0.99 * bending_step(beam, nodes)
    factor = growth(highest_frequency(beam, nodes), dt, sign)
    largest = march(beam, nodes, dt, steps, sign)
    grown = float(largest[-1] / largest[0])
    numbers = (
        Number("growth of the highest mode per step", factor, "1"),
        Number(f"deflection after {steps} steps over that after 1", grown, "1"),
    )
    stands = factor <= 1.0 and grown < steps  # an impulse spreads; it adds up at most
    why = "The solution stays bounded."
    return judged(numbers, stands, why, "Every mode grows exponentially: no beam does this.")


@statement(
    kind=Subject.MISPRINT,
    text="Eq. 9: w_t(n + 1/2) = w_t(n − 1/2) + Δt w_tt(n − 1/2), and below Eq. 10 “w_t at n”.",
    test=(
        "The step is of second order, as central differences are: on w = cos(ωt + 1) the error of "
        "w_tt falls to a quarter as Δt is halved (order 2, rounded)."
    ),
    cases=(
        ("Eq. 9 as printed, w_tt at n − 1/2", lambda dt: -math.cos(1.0 - 0.5 * dt)),
        ("the text below Eq. 10 as printed, w_t at n", lambda dt: -math.sin(1.0)),
        ("w_tt at n", lambda dt: -math.cos(1.0)),
    ),
    holds="w_tt at n, both times",
)
def acceleration_time(data: Data, acceleration: Callable[[float], float]) -> Assessment:
    """Judge what is taken for the acceleration of a step at t = 0, with omega = 1."""
    errors = []
    for dt in (1e-2, 5e-3):
        before, after = (-math.sin(1.0 + half * dt) for half in (-0.5, 0.5))
        errors.append(abs((after - before) / dt - acceleration(dt)))
    order = math.log2(errors[0] / errors[1])
    off = f"The error is of order {order:.1f}."
    numbers = (Number("observed order", order, "1"),)
    return judged(numbers, round(order) == 2, "The step is of second order.", off)


@statement(
    kind=Subject.MISPRINT,
    text="The unloading curve has the radius R_e of Eq. 17, and of Table 1.",
    test=(
        "With δ_r = δ_m − δ_y R_e/R* (Eq. 15), the unloading force (4/3) E* √R_e (δ_m − δ_r)^1.5 "
        "at the deepest indentation equals the loading force F_m (Eq. 16) within 10⁻⁹, for "
        "δ_m = 65 µm (the paper's case) and δ_m/δ_y = 3, 30, 300. X = 3 F_m/(4 E*), in m²; the "
        "unit of Eq. 17's R_e is not a length: SI numbers are taken."
    ),
    cases=(
        ("Eq. 17 as printed, [X (R*/δ_y)^(3/4)]^(1/4)", 0.25, 0.1875),
        ("Table 1 as printed, [X (R*/δ_y)^(3/4)]^(1/2)", 0.5, 0.375),
        ("as derived from Eqs. 15 and 16, √X (R*/δ_y)^(3/4)", 0.5, 0.75),
    ),
    holds="R_e = √(3 F_m/(4 E*)) (R*/δ_y)^(3/4), that is R_e/R* = √(F_m/F_y)",
)
def unloading_radius(data: Data, outer: float, inner: float) -> Assessment:
    """Judge R_e = (3 F_m/(4 E*))^outer (R*/delta_y)^inner, in SI numbers."""
    law = stronge_impact(paper_impact())
    ratio = law.effective_radius / law.yield_indentation
    shares = []
    for depth in (65e-6, *(law.yield_indentation * x for x in (3.0, 30.0, 300.0))):
        peak = law.loading_force(depth)
        radius = (0.75 * peak / law.effective_modulus) ** outer * ratio**inner
        recovered = law.yield_indentation * radius / law.effective_radius
        force = hertz.stiffness(law.effective_modulus, radius) * recovered**1.5
        shares.append(float(force / peak))
    worst = max(abs(share - 1.0) for share in shares)
    return judged(
        (Number("unloading over loading force at 65 µm", shares[0], "1"),),
        worst <= EQUAL,
        "Loading and unloading forces agree, with this form alone.",
        "The force would jump where unloading begins.",
    )


@statement(
    kind=Subject.MISPRINT,
    text="Table 1, elastic phase: F = (4/3) E* √R* δ_y^(3/2).",
    test="F = 0 where the contact begins (δ = 0), and the force grows with the indentation.",
    cases=(("as printed", 1.0), ("with δ in the place of δ_y", 0.0)),
    holds="F = (4/3) E* √R* δ^(3/2)",
)
def elastic_phase(data: Data, begins: float) -> Assessment:
    """Judge the expression; begins: its depth over delta_y where the contact begins."""
    law = stronge_impact(paper_impact())
    stiffness = hertz.stiffness(law.effective_modulus, law.effective_radius)
    first, last = (stiffness * (share * law.yield_indentation) ** 1.5 for share in (begins, 1.0))
    numbers = (Number("force at δ = 0", first, "N"), Number("force at δ = δ_y", last, "N"))
    constant = "The printed expression is a constant, not a force law."
    return judged(numbers, first == 0.0 < last, "It grows from zero.", constant)


@statement(
    kind=Subject.MISPRINT,
    text="The beam has a mass of 10.929 kg (Table 2).",
    test=(
        "|ρ B H L − printed mass| ≤ U; U: half of the last printed digit of density (7800 kg/m³, "
        "± 50) and sizes (27.8 mm, ± 0.05; 60 and 780 mm, ± 0.5), all in one direction."
    ),
    cases=(("density 7800 kg/m³, 27.8 × 60 × 780 mm", 10.929),),
    holds="10.148 kg; a beam of 840 mm would have 10.929 kg",
)
def beam_mass(data: Data, printed: float) -> Assessment:
    """Judge the `printed` mass in kg."""
    beam = paper_impact().beam
    mass = beam.mass_per_length * beam.span
    # half of the last printed digit over the value, of each factor
    share = 50.0 / 7800.0 + 0.05 / 27.8 + 0.5 / 60.0 + 0.5 / 780.0
    numbers = (
        Number("ρ B H L", mass, "kg", share * mass),
        Number("span of the printed mass", printed / beam.mass_per_length, "m"),
    )
    off = printed / mass - 1.0
    why = f"Printed and computed mass differ by {100 * off:.1f} % of the latter."
    return judged(numbers, abs(printed - mass) <= share * mass, why)


@statement(
    kind=Subject.MISPRINT,
    text="Under Hertz's law repeated contacts accumulate permanent indentation.",
    test="The indentation at which Hertz's unloading has no force left is above 0.",
    cases=(("after 10 µm", 10e-6), ("after 100 µm", 100e-6)),
    holds="Hertz's law is elastic: it unloads along its loading and leaves none",
)
def hertz_indentation(data: Data, depth: float) -> Assessment:
    """Judge what the law's unloading leaves; depth: the largest indentation in m."""
    impact = paper_impact()
    steel = impact.beam.material
    of = hertz.effective_modulus(impact), impact.sphere.radius, steel.yield_stress
    loading, unloading = LAWS["hertz"]
    force = loading(depth, *of, steel.poissons_ratio)
    _, residual, _ = unloading(depth, force, *of, steel.poissons_ratio)
    left = Number("indentation left over the largest", float(residual) / depth, "1", percent=True)
    return judged((left,), residual > 0.0, "A part is left.", "None is left.")


@statement(
    kind=Subject.MISPRINT,
    text="The sphere is elastic-perfectly plastic.",
    test=(
        "The largest mean pressure of the contact, 2.8 times the beam's yield stress (Tabor), "
        "reaches that at which the sphere begins to yield, 1.1 times its own (Stronge's ϑ)."
    ),
    cases=(("at any velocity",),),
    holds="the sphere stays elastic: its yield stress, of 2550 MPa, plays no part",
)
def sphere_yields(data: Data) -> Assessment:
    """Judge the pressures of beam and sphere."""
    impact = paper_impact()
    pressure = HARDNESS * impact.beam.material.yield_stress
    first = CONSTRAINT * impact.sphere.material.yield_stress
    numbers = (
        Number("largest mean pressure", pressure, "Pa"),
        Number("the sphere's at first yield", first, "Pa"),
    )
    why = "The beam flows long before; in 3-D runs at 5 to 20 m/s the sphere has no PEEQ."
    return judged(numbers, pressure >= first, "The sphere yields.", why)


@statement(
    kind=Subject.OBSERVATION,
    text="Where the fully plastic phase begins, which the paper does not give.",
    test=(
        "The elastic-plastic force F_y u (1 + ln(u)/3.3) and the fully plastic one 2.8 F_y u/1.1 "
        "agree there within 10⁻⁹; u = 2 δ/δ_y − 1."
    ),
    cases=(("the often quoted 84 δ_y", 84.0), ("by continuity", 0.5 * (U_PLASTIC + 1.0))),
    holds="continuity: ln(u) = 3 (2.8 − 1.1), δ/δ_y = 82.511",
)
def fully_plastic(data: Data, depth: float) -> Assessment:
    """Judge a depth over the yield indentation at which the phase would begin."""
    u = 2.0 * depth - 1.0
    jump = HARDNESS / CONSTRAINT / (1.0 + math.log(u) / (3.0 * CONSTRAINT)) - 1.0
    numbers = (Number("δ/δ_y", depth, "1"), Number("jump of the force", jump, "1", percent=True))
    jumps = "The force jumps there."
    return judged(numbers, abs(jump) <= EQUAL, "The two forces agree.", jumps)


@statement(
    kind=Subject.OBSERVATION,
    text="P = 2 integration points represent the section.",
    test=(
        "The rule's elastic stiffness B Σ E w z² and its full plastic moment B Σ σ_y w |z| equal "
        "E B H³/12 and σ_y B H²/4 within 10⁻⁹."
    ),
    cases=READINGS_OF_P,
    holds="2 Lobatto points are 3 times too stiff; with 3 the section yields all at once",
)
def few_points(data: Data, rule: str, points: int, literal: bool) -> Assessment:
    """Judge an integration rule by its stiffness and its plastic moment."""
    beam = paper_impact().beam
    # At a thousand times that of first yield every fibre but one on the axis has yielded.
    curvature = np.array([1e-6, 1e3]) * bending.yield_curvature(beam)
    exact = np.array([beam.bending_stiffness * curvature[0], bending.plastic_moment(beam)])
    moments = bending.path_moments(beam, curvature, *bending.rule(rule, points))
    ratios = dict(zip(("stiffness", "full plastic moment"), moments / exact, strict=True))
    numbers = tuple(
        Number(f"{name} over the exact one", float(ratio), "1") for name, ratio in ratios.items()
    )
    wrong = [name for name, ratio in ratios.items() if abs(ratio - 1.0) > EQUAL]
    off = f"Not exact: {', '.join(wrong)}."
    return judged(numbers, not wrong, "Both are exact.", off, literal=literal)


@statement(
    kind=Subject.OBSERVATION,
    text="Unloading with force continuity (Eqs. 15 to 17) creates no energy.",
    test=(
        "The coefficient of restitution of the contact alone is at most 1 for every "
        "1 < δ_m/δ_y < 300."
    ),
    cases=(("Stronge's law",),),
    holds="the coefficient is above 1 for small δ_m/δ_y: the law itself creates energy there",
)
def restitution(data: Data) -> Assessment:
    """Judge the law by the works of its loading and unloading."""
    law = stronge_impact(paper_impact())
    ratios = np.geomspace(1.0, 300.0, 4001)[1:]
    depths = (ratios * law.yield_indentation).tolist()
    restitution = np.sqrt([law.released_work(d) / law.loading_work(d) for d in depths])
    above = restitution > 1.0
    largest = Number("largest restitution", float(restitution.max()), "1")
    if not above.any():
        return Assessment((largest,), Ruling.HOLDS, "It is at most 1.")
    end = float(ratios[above].max())
    numbers = (largest, Number("δ_m/δ_y up to which it is above 1", end, "1", end * 0.0015))
    why = "The law creates energy in shallow contacts; the energy audit of the runs counts it."
    return Assessment(numbers, Ruling.FAILS, why)


@statement(
    kind=Subject.OBSERVATION,
    text="An impact has one contact.",
    test="The runs of figure 5 have one contact each.",
    cases=(("Stronge contact, 0.99 m/s",),),
    studies=("fig05",),
    holds="an impact has several sub-impacts: state which contact is meant (here the first)",
)
def sub_impacts(data: Data) -> Assessment:
    """Judge the largest number of contacts."""
    runs = runs_of(data, "fig05")
    where = {"contact": "stronge"} if "contact" in runs.dims else {}
    count = float(select_response(runs, "number_of_contacts", **where).max())
    number = Number(f"contacts within {float(runs['duration']) * 1e3:g} ms", count, "1")
    again = "The beam comes back and strikes the sphere again."
    return judged((number,), count == 1.0, "There is one.", again)
