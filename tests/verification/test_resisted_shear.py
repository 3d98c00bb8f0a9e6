"""Timoshenko beams on springs, damped, on a foundation: closed forms, decrement, energy, limits."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section
from impactlab.solver import strip, timoshenko
from impactlab.solver.beam import make_beam, mirror
from impactlab.solver.contact.history import make_pair
from impactlab.solver.fibre_plasticity import make_plastic_state
from impactlab.solver.stability import discretise
from impactlab.solver.state import State

from ..end_modes import PAIRS, roots
from .test_resistance import observed

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

BED = {"foundation_stiffness": 3e7}
RAYLEIGH = {"mass_damping": 60.0, "stiffness_damping": 1e-5}
SPRINGS = {
    "support_left": "elastic",
    "stiffness_left": 2e7,
    "rotational_stiffness_left": 1e5,
    "support_right": "elastic",
    "stiffness_right": 3e6,
    "rotational_stiffness_right": 2e4,
}
CANTILEVER = {
    "support_left": "elastic",
    "rotational_stiffness_left": 3e5,
    "stiffness_left": 1e8,
    "support_right": "free",
}
CLAMPED = {"support_left": "clamped", "support_right": "clamped"}
EQUAL = {
    f"{kind}stiffness_{side}": value
    for side in ("left", "right")
    for kind, value in (("", 3e6), ("rotational_", 2e4))
}
EQUAL |= {"support_left": "elastic", "support_right": "elastic"}


def beam_of(velocity=0.5, model="timoshenko", radius=0.01, place=0.5, load="point", **values):
    impact = il.paper_impact(velocity, "hertz")
    sphere, beam = replace(impact.sphere, radius=radius), replace(impact.beam, **values)
    return replace(
        impact, sphere=sphere, beam=beam, beam_model=model, strike_position=place, load=load
    )


def ends(beam):
    """The conditions of both ends on w, psi, M = EI psi_x and Q, over the units of `matrix`."""
    EI, L, rows = beam.bending_stiffness, beam.span, []
    for side, inward in (("left", 1.0), ("right", -1.0)):
        k_t, k_r = {"pinned": (np.inf, 0.0), "clamped": (np.inf, np.inf), "free": (0.0, 0.0)}.get(
            getattr(beam, f"support_{side}"),
            (
                getattr(beam, f"stiffness_{side}") * L**3 / EI,
                getattr(beam, f"rotational_stiffness_{side}") * L / EI,
            ),
        )
        t, r = (1.0 if np.isinf(k) else k / (k + 1.0) for k in (k_t, k_r))
        rows.append([[t, 0, 0, -inward * (1.0 - t)], [0, r, -inward * (1.0 - r), 0]])
    return np.array(rows)


def matrix(impact, speed):
    """d/dx of w, psi, M and Q at a frequency (rad/s), in units of span and EI."""
    beam = impact.beam
    EI, L = beam.bending_stiffness, beam.span
    case = case_table(impact, il.Discretisation(), duration=1e-3)[0]
    held = beam.foundation_stiffness - beam.mass_per_length * speed**2
    return np.array(
        [
            [0, 1, 0, EI / L**2 / case.shear_stiffness],
            [0, 0, 1, 0],
            [0, -case.rotary_inertia * speed**2 * L**2 / EI, 0, -1],
            [held * L**4 / EI, 0, 0, 0],
        ]
    )


def determinant(impact, speed):
    """Zero at a frequency (rad/s), by exponentials across the span."""
    left, right = ends(impact.beam)
    across = expm(matrix(impact, speed)) @ np.linalg.svd(left)[2][2:].T
    return np.linalg.det(right @ across)


def frequencies(impact, nodes):
    """Return the frequencies of the solver's beam (rad/s), ascending, from its accelerations."""
    case = case_table(impact, il.Discretisation(nodes=nodes), duration=1e-3)[0]
    section, columns = fibre_section(case), []
    grid, _ = discretise(case, make_pair(case), section)
    deflected, turned = slice(2, grid.last + 1), slice(grid.first - 1, grid.stop)
    for part, moved in ((0, deflected), (1, turned)):
        for i in range(moved.start, moved.stop):
            beam, plastic = make_beam(grid), make_plastic_state(grid, section)
            extra = strip.MODEL.make(case, section, grid)
            shear = extra.shear
            (shear.psi if part else beam.w[0])[i] = 1e-9
            mirror(beam.w, 1, beam.u, grid)
            timoshenko.mirror_rotation(shear.psi, grid)
            strip.MODEL.step(State(make_pair(case), section, grid, beam, plastic, extra), 0, 0.0)
            columns.append(np.append(beam.u[deflected], shear.spin[turned]) / (-1e-9 * grid.dt**2))
    values = np.sort(np.linalg.eigvals(np.array(columns).T).real)
    assert 2 / np.sqrt(values[-1]) >= grid.dt  # stable
    return np.sqrt(np.maximum(values, 0.0))


PLAIN = [{"support_left": left, "support_right": right} for left, right in PAIRS]


@pytest.mark.long  # the step is compiled by itself
@pytest.mark.parametrize(
    "values",
    [SPRINGS, CANTILEVER, BED, SPRINGS | BED, {"support_right": "free"} | BED, *PLAIN],
)
def test_frequencies_converge_at_second_order_to_the_characteristic_equation(values):
    impact, errors = beam_of(place=0.4, **values), []
    beam = impact.beam
    unit = np.sqrt(beam.bending_stiffness / beam.mass_per_length) / beam.span**2
    for nodes in (41, 81):
        ours = frequencies(impact, nodes)
        ours = ours[ours > unit][:4]
        bounds = ([0.97 * f, 1.03 * f] for f in ours)
        exact = [brentq(lambda speed: determinant(impact, speed), *bound) for bound in bounds]
        errors.append(ours / exact - 1)
    if values in PLAIN:
        slender = roots(beam.support_left, beam.support_right, 4) ** 2 * unit
        assert (exact < 0.999 * slender)[1:].all()
    assert np.abs(errors[1]).max() < 6e-3
    assert np.abs(errors[1]) == pytest.approx(np.abs(errors[0]) / 4, rel=0.1, abs=1e-7)


@pytest.mark.parametrize(
    "values",
    [{"mass_damping": 60.0}, {"stiffness_damping": 1e-5}, RAYLEIGH | BED],
    ids=["mass", "stiffness", "all"],
)
def test_free_vibration_has_the_logarithmic_decrement(values):
    """Two modes of the grid are sines of w and psi with zeta = alpha/(2 omega) + beta omega/2."""
    impact, n = beam_of(**values), np.array([1, 3])
    case = case_table(impact, il.Discretisation(), duration=1e-3)[0]
    EI, kGA, beam = fibre_section(case).stiffness, case.shear_stiffness, impact.beam
    s = 200 / beam.span * np.sin(n * np.pi / 200)
    omega = []
    for wave in s:
        stiffness = np.array(
            [
                [kGA * wave**2 + beam.foundation_stiffness, -kGA * wave],
                [-kGA * wave, EI * wave**2 + kGA],
            ]
        )
        inertia = np.diag([beam.mass_per_length, case.rotary_inertia])
        omega.append(np.sqrt(np.linalg.eigvals(np.linalg.solve(inertia, stiffness)).min()))
    omega = np.array(omega)
    zeta = beam.mass_damping / (2 * omega) + beam.stiffness_damping * omega / 2
    expected = zeta * omega, omega * np.sqrt(1 - zeta**2)
    shapes = [lambda x, n=n: np.sin(n * np.pi * x) for n in (1, 3)]
    ours = observed(impact, "leapfrog", 101, shapes, np.transpose(expected))
    assert ours == pytest.approx(np.array(expected), rel=1e-3)


@pytest.mark.parametrize(
    ("model", "values", "place", "load", "velocity"),
    [
        ("timoshenko", SPRINGS, 0.5, "point", 10.0),
        ("timoshenko", CANTILEVER | BED, 0.25, "contact_patch", 10.0),
        ("timoshenko", {}, 0.25, "contact_patch", 10.0),
        ("timoshenko", BED, 0.5, "point", 1.0),
        ("von_karman", SPRINGS, 0.375, "point", 20.0),
        ("von_karman", EQUAL | BED, 0.5, "contact_patch", 20.0),
        ("von_karman", CLAMPED | BED, 0.25, "point", 20.0),
        ("von_karman", {"support_right": "roller"}, 0.5, "contact_patch", 20.0),
    ],
)
@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
def test_the_balance_of_energy_counts_springs_foundation_and_damping(
    model, values, place, load, velocity
):
    """The error is no more than that of an undamped run, though damping takes much."""
    runs = [
        il.simulate(
            beam_of(velocity, model, 0.035, place, load, **values, **damping),
            il.Discretisation(nodes=65, points=9),
            duration=4e-3,
        )
        for damping in ({}, {"mass_damping": 200.0, "stiffness_damping": 1e-5})
    ]
    assert [run.energy_error.item() < 5e-4 for run in runs] == [True, True]
    lower = [np.abs(run.midspan_deflection[-400:]).max().item() for run in runs]
    assert lower[1] < 0.95 * lower[0]
    assert (velocity > 1.0) == bool(runs[1].plastic_dissipation.item() > 0.0)


@pytest.mark.parametrize(
    "values",
    [BED, SPRINGS, SPRINGS | BED, {"support_left": "free", "support_right": "free"} | BED],
    ids=["bed", "springs", "both", "free"],
)
@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
def test_a_sphere_at_rest_bends_the_beam_as_in_statics(values):
    """Once damping has its way, w = m g times the closed form's flexibility, shear included."""
    impact = beam_of(1e-3, radius=0.035, mass_damping=1500.0, **values)
    impact = replace(impact, gravity=50.0)
    run = il.simulate(impact, il.Discretisation(nodes=41), duration=0.05, samples=2001)
    late = slice(1500, None)
    force = impact.sphere.total_mass * impact.gravity
    assert run.contact_force.values[late].mean() == pytest.approx(force, rel=1e-3)
    half, (left, right) = expm(0.5 * matrix(impact, 0.0)), ends(impact.beam)
    start = np.linalg.svd(left)[2][2:].T
    beam = impact.beam
    jump = np.array([0.0, 0.0, 0.0, -force * beam.span**2 / beam.bending_stiffness])
    open_ends = np.linalg.solve(right @ half @ half @ start, -right @ half @ jump)
    exact = beam.span * (half @ start @ open_ends)[0]
    assert run.midspan_deflection.values[late].mean() == pytest.approx(exact, rel=3e-3)


@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
@pytest.mark.parametrize("values", [SPRINGS | RAYLEIGH | BED, SPRINGS, RAYLEIGH, BED])
def test_a_slender_beam_moves_as_euler_bernoullis(values):
    """The sphere is soft, so that the contact is as long as the beam swings."""
    histories = []
    for model in ("euler_bernoulli", "timoshenko"):
        impact = beam_of(0.05, model, 0.035, depth=6e-3, width=0.6, **values)
        soft = replace(impact.sphere.material, youngs_modulus=1e8, yield_stress=1e7)
        impact = replace(impact, sphere=replace(impact.sphere, material=soft))
        run = il.simulate(impact, il.Discretisation(nodes=41), duration=6e-3, samples=601)
        histories.append(run.midspan_deflection.values)
    size = np.abs(histories[0]).max()
    assert np.abs(histories[1] - histories[0]).max() < 2e-3 * size
