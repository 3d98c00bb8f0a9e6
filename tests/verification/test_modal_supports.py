"""The modal scheme with any ends and places: closed-form modes, stability, leapfrog's limit."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.beam_modes import mode_table
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section, solve
from impactlab.solver.beam import copies
from impactlab.solver.contact.history import make_pair
from impactlab.solver.flight import LEAST, MOST, bound_swing, leap_modes, make_tables
from impactlab.solver.modes import make_modes, move_modes, rest_modes, take_modes
from impactlab.solver.stability import discretise, stiffest_contact

from ..end_modes import PAIRS, basis, held, modes, roots

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

ENDS = [(*pair, place) for pair, place in itertools.product(PAIRS, (0.1, 0.5))]
ENDS += [("free", end, 0.0) for end in ("pinned", "clamped", "free")]
ENDS.remove(("pinned", "pinned", 0.5))  # of sines


def modes_of(left, right, place, nodes, impact=None, **values):
    """Return case, section, grid and modes of a beam at rest."""
    impact = held(left, right, place, impact or il.paper_impact())
    grid = il.Discretisation(nodes=nodes, scheme="modal", **values)
    case = case_table(impact, grid, duration=1e-3)[0]
    section = fibre_section(case)
    grid, _ = discretise(case, make_pair(case), section)
    bending = section.stiffness, section.yield_curvature
    ours = make_modes(grid, *bending)
    take_modes(ours, mode_table(case))
    rest_modes(ours, grid, *bending)
    return case, section, grid, ours


@pytest.mark.parametrize(("left", "right", "place"), ENDS)
def test_steps_turn_modes_at_the_closed_forms_frequencies(left, right, place):
    case, section, grid, ours = modes_of(left, right, place, 41, courant=1e-3)
    exact = roots(left, right, 38)[:: int(grid.copies)]  # of half a beam, the even ones
    D = ours.D[ours.D > 1e-20][: exact.size]
    omega = 2.0 * np.arcsin(0.5 * np.sqrt(D)) / grid.dt
    speed = np.sqrt(section.stiffness / case.mass_per_length) / case.beam_span**2
    assert omega == pytest.approx(exact[: D.size] ** 2 * speed, rel=1e-9)


@pytest.mark.parametrize(("left", "right", "place"), ENDS)
def test_curvatures_are_orthogonal_and_follow_the_closed_form(left, right, place):
    """The sections' stiffness is that of each mode, and none for two: yielding takes no more."""
    errors = []
    for nodes in (41, 81):
        case, section, grid, ours = modes_of(left, right, place, nodes)
        lengths = np.array([copies(grid, i) for i in range(2, grid.last + 1)]) * grid.dx
        bent, root = ours.bent[2 : grid.last + 1, :-1], np.sqrt(ours.push / ours.D)[:-1]
        rigid = np.count_nonzero(ours.D < 1e-20)
        root[:rigid] = 0.0
        unit = bent.T @ (bent * lengths[:, np.newaxis]) * section.stiffness
        unit *= root * root[:, np.newaxis]
        expected = np.diag(np.arange(root.size) >= rigid).astype(float)
        assert unit == pytest.approx(expected, rel=0, abs=1e-9)
        x = np.linspace(0.0, 0.5 if grid.copies > 1.0 else 1.0, grid.stop - grid.first + 2)
        x = x[1 if left == "pinned" else 0 :][: bent.shape[0]]
        betas, shapes = modes(left, right, 6, np.append(x, place))
        step, curvatures = int(grid.copies), []
        for b, shape in zip(betas, shapes, strict=True):
            functions = [basis(b, x, order) for order in (0, 2)]
            factors = np.linalg.lstsq(functions[0], shape[:-1], rcond=None)[0]
            curvatures.append(b**2 * functions[1] @ factors / shape[-1])
        ours = (bent.T[rigid:] * case.beam_span**2)[: 6 // step]
        exact = np.array(curvatures)[::step]
        errors.append(np.abs(ours - exact).max(axis=1) / np.abs(exact).max(axis=1))
    assert errors[1].max() < 0.02
    assert (errors[1] < np.maximum(0.3 * errors[0], 1e-9)).all()


@pytest.mark.parametrize("nodes", [5, 21, 61])
@pytest.mark.parametrize(
    ("left", "right", "place", "stiff"),
    [
        *((*end, True) for end in ENDS if end[2] != 0.1),
        *(("pinned", "pinned", 0.5, stiff) for stiff in (True, False)),
    ],
)
def test_a_step_with_any_sections_yielding_is_stable(left, right, place, stiff, nodes):
    """At the largest time step all eigenvalues of the step lie on the unit circle.

    The contact is a spring, which sets the step where it is stiff; sections keep some or none of
    their stiffness.
    """
    impact = il.paper_impact()
    if stiff:
        impact = il.paper_impact(30.0, "hertz")
        thin = replace(impact.beam, depth=0.002, width=0.001)
        impact = replace(impact, beam=thin, sphere=replace(impact.sphere, mass=1e-3))
    case, section, grid, ours = modes_of(left, right, place, nodes, impact, courant=1.0)
    wave = grid.dx * np.sqrt(case.beam_density / case.beam_youngs_modulus)
    assert (grid.dt < 0.9 * wave) == stiff
    k_c, random = stiffest_contact(case, make_pair(case)), np.random.default_rng(1)
    lengths = np.array([copies(grid, i) for i in range(2, grid.last + 1)]) * grid.dx
    bent, n = ours.bent[2 : grid.last + 1], ours.q.size - 1
    for share in (0.0, 0.3, 1.0):
        left_over = np.where(random.random(lengths.size) < share, 0.0, section.stiffness)
        stiffness = np.zeros((n + 2, n + 2))
        stiffness[:-1, :-1] = bent.T @ (bent * (left_over * lengths)[:, np.newaxis])
        stiffness[n, n] = ours.D[n] / ours.push[n]
        touch = np.append(np.ones(n + 1), -1.0)
        stiffness += k_c * np.outer(touch, touch)
        root = np.sqrt(np.append(ours.push, grid.dt**2 / case.sphere_mass))
        squares = np.linalg.eigvalsh(root[:, np.newaxis] * stiffness * root)
        assert squares.min() > -1e-9
        assert squares.max() < 4.0 * (1.0 - 1e-9)


@pytest.mark.parametrize("level", [LEAST, MOST])
@pytest.mark.parametrize("left", ["free", "clamped"])
def test_a_leap_of_any_modes_is_as_many_steps(left, level):
    """The rigid modes are among them, whose deflection grows without end."""
    results = []
    for leaps in (False, True):
        *_, ours = modes_of(left, "free", 0.3, 21)
        random, table = np.random.default_rng(level), ours.leaps
        size = 1e-3 / np.arange(1, ours.q.size + 1) ** 3
        ours.q[:], ours.u[:] = random.normal(0, size), random.normal(0, size * np.sqrt(ours.D))
        ours.u[: np.count_nonzero(ours.D < 1e-20)] = 1e-6
        q, u, k2, D, push, source, _, seen, _, slack = ours[:10]
        bound_swing(
            *(q, u, k2, D, push, source),
            *(table.rest, table.A, table.swing, table.bounds),
        )
        make_tables(table, D, MOST)
        if leaps:
            w, _ = leap_modes(q, u, D, table.rest, table.D, table.S, level, q, u)
        else:
            for _ in range(1 << level):
                w = move_modes(q, u, D, push, source, k2, seen, slack, 0.0)
        results.append(np.array([w, *q, *u]))
    assert results[1] == pytest.approx(results[0], rel=0, abs=1e-11 * np.abs(results[0]).max())


def yielding(left, right, place, velocity=15.0):
    impact = il.paper_impact(velocity)
    metal = replace(impact.beam.material, isotropic_hardening_modulus=5e9)
    return held(left, right, place, replace(impact, beam=replace(impact.beam, material=metal)))


@pytest.mark.parametrize(
    ("left", "right", "place"),
    [
        ("clamped", "clamped", 0.5),
        ("clamped", "pinned", 0.25),
        ("clamped", "free", 0.5),
        ("free", "free", 0.25),
        ("free", "pinned", 0.5),
        ("pinned", "pinned", 0.25),
    ],
)
def test_yielding_has_leapfrogs_limit(left, right, place):
    impact = yielding(left, right, place)
    runs = [
        il.simulate(impact, il.Discretisation(nodes=nodes, points=15, scheme=scheme), duration=3e-3)
        for scheme, nodes in (("leapfrog", 201), ("modal", 161))
    ]
    leapfrog, ours = runs
    for name, rel in (("peak_force", 1e-3), ("impulse", 0.02), ("plastic_dissipation", 0.03)):
        assert ours[name].item() == pytest.approx(leapfrog[name].item(), rel=rel)
    size = np.abs(leapfrog.midspan_deflection).max().item()
    difference = ours.midspan_deflection.values - leapfrog.midspan_deflection.values
    assert np.abs(difference).max() < 0.01 * size
    assert ours.energy_error.item() < 1e-3
    peeq = [run.equivalent_plastic_strain.max("z").integrate("x").item() for run in runs]
    assert peeq[1] == pytest.approx(peeq[0], rel=0.05)
    assert (leapfrog.equivalent_plastic_strain.values[0].max() > 1e-3) == (left == "clamped")


@pytest.mark.parametrize(("left", "right", "place"), [*ENDS, ("clamped", "free", 0.9)])
def test_leaps_of_any_modes_hide_no_event(left, right, place):
    """Against single steps: with damping, however little, a beam does not leap."""
    leapt = yielding(left, right, place, 20.0)
    stepped = replace(leapt, beam=replace(leapt.beam, mass_damping=1e-30))
    grid = il.Discretisation(nodes=41, scheme="modal")
    leapt, stepped = (solve(case_table(run, grid, duration=0.02)) for run in (leapt, stepped))
    for name, values in leapt.items():
        if name != "energy_error":
            assert values == pytest.approx(stepped[name], rel=1e-6, nan_ok=True), name
