"""The critical time step: against the eigenvalues of the linear system, and in runs."""

import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values
from impactlab.model.section import fibre_table
from impactlab.solve import fibre_section, solve, step_counts
from impactlab.solver.contact import CONTACT_LAWS
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import (
    _stiffness,
    discretise,
    largest_time_step,
    stiffest_contact,
)
from impactlab.variables import STATUS_FLAGS
from impactlab.verification.solutions.contact_laws import LAWS as REFERENCE
from impactlab.verification.solutions.contact_laws import joints, law_on_half_space

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

ELASTIC = {"contact": "hertz", "beam_yield_stress": 200e9}


def largest_frequency(case, stiffness, k_c):
    """Return that of beam and sphere (rad/s), the contact a spring k_c, by eigenvalues."""
    nodes, m_s = case.nodes, case.sphere_mass
    dx = case.beam_span / (nodes - 1)
    lumped = case.beam_density * case.beam_width * case.beam_depth * dx
    bend = (np.diag(np.full(nodes - 3, 1.0), 1) - np.eye(nodes - 2)) / dx**2
    bend = bend + bend.T  # w_xx at the inner nodes; w = M = 0 at the supports
    matrix = np.zeros((nodes - 1, nodes - 1))
    matrix[:-1, :-1] = stiffness * dx * bend @ bend
    middle = (nodes - 3) // 2
    matrix[np.ix_([middle, -1], [middle, -1])] += k_c * np.array([[1, -1], [-1, 1]])
    mass = np.append(np.full(nodes - 2, lumped), m_s)
    return np.sqrt(np.linalg.eigvalsh(matrix / np.sqrt(np.outer(mass, mass))).max())


def time_steps(case):
    """(critical time step, 2/omega of the eigenvalue problem)."""
    pair, section = make_pair(case), fibre_section(case)
    dx = case.beam_span / (case.nodes - 1)
    ours = largest_time_step(case, pair, section.stiffness, dx)
    k_c = stiffest_contact(case, pair)
    return ours, 2 / largest_frequency(case, section.stiffness, k_c)


@pytest.mark.parametrize("nodes", [5, 11, 41, 101, 201])
@pytest.mark.parametrize("rule", ["lobatto", "layers"])
@pytest.mark.parametrize("mass", [0.01, 1.4, 50.0])
def test_never_above_the_limit_of_the_linear_system(make_case, nodes, rule, mass):
    ours, exact = time_steps(make_case(nodes=nodes, rule=rule, points=2, sphere_mass=mass))
    assert ours <= exact * (1 + 1e-9)
    assert ours > 0.6 * exact


@pytest.mark.parametrize(
    "values", [{"nodes": 401}, {"nodes": 5, "sphere_mass": 1e-3}], ids=["bending", "contact"]
)
def test_close_to_the_limit_where_bending_or_the_contact_alone_sets_it(make_case, values):
    ours, exact = time_steps(make_case(**values))
    assert ours == pytest.approx(exact, rel=0.01)


def stiffness_of(law, deepest):
    """Largest tangent stiffness of loading (jumps left out) and unloading up to any depth.

    Returns it as a function of the depth, which is at most `deepest`.
    """
    depths = np.linspace(1e-3, 1, 2500) * deepest
    forces = np.array([law.loading_force(depth) for depth in depths])
    slopes = np.diff(forces) / np.diff(depths)
    jumps = [np.searchsorted(depths, joint) - 1 for joint in joints(*law.pair) if joint < deepest]
    slopes[jumps] = 0.0
    start, end, exponent = np.array([law.unloading(depth) for depth in depths]).T
    both = np.maximum(np.append(0.0, slopes), exponent * start / (depths - end))
    largest = np.maximum.accumulate(both)
    return lambda depth: largest[np.searchsorted(depths, depth * (1 + 1e-12)) - 1]


@pytest.mark.parametrize("contact", REFERENCE)
@pytest.mark.parametrize("velocity", [0.012, 0.1, 0.99, 3.0, 20.0])
def test_stiffest_contact_of_every_law_derived_twice(make_case, contact, velocity):
    """Jumps of the force at the limits of regimes are no stiffness, wherever they fall."""
    impact = il.paper_impact(contact=contact)
    law, mass = law_on_half_space(impact), impact.sphere.total_mass
    speeds = velocity * np.linspace(1.0, 1.25, 12)  # the indentations tried move along
    depths = [law.maximum_indentation(speed, mass) for speed in speeds]
    stiffness = stiffness_of(law, 1.25 * depths[-1])
    for speed, deepest in zip(speeds, depths, strict=True):
        case = make_case(velocity=speed, contact=contact, gravity=0.0)
        k_c = stiffest_contact(case, make_pair(case))
        assert (0.999 if contact in ("hertz", "stronge") else 0.97) * stiffness(deepest) <= k_c
        if CONTACT_LAWS[contact].unloading_start == 1.0:
            assert k_c <= 1.03 * stiffness(1.25 * deepest)


@pytest.mark.parametrize("contact", REFERENCE)
def test_a_jump_within_the_difference_is_no_stiffness(make_case, contact):
    """At the limits of regimes, where a difference over the jump would be hundreds of F/delta."""
    pair = make_pair(make_case(contact=contact))
    law = law_on_half_space(il.paper_impact(contact=contact))
    for joint in joints(*law.pair):
        for share in (-0.5e-4, 0.5e-4):
            delta = joint * (1.0 + share)
            start, end, n = law.unloading(delta)
            F = law.loading_force(delta)
            unloading = n * start / (delta - end)
            turning = 1000.0 * (F - start) ** 2 / (F * delta)
            assert _stiffness(pair, delta)[0] < max(
                3.0 * F / delta, 1.001 * unloading, 1.001 * turning
            )


@pytest.mark.parametrize("nodes", [11, 21, 101])
@pytest.mark.parametrize("velocity", [0.99, 20.0])
def test_a_jump_at_the_turn_brings_little_energy(nodes, velocity):
    """On coarse grids, too, where without more steps it would bring up to a quarter."""
    grid = il.Discretisation(nodes=nodes, points=9)
    run = il.simulate(il.paper_impact(velocity, "stronge_original"), grid, duration=4e-3)
    assert run.energy_error.item() < 0.01


def test_gravity_drives_the_contact_further(make_case):
    heavy = make_case(velocity=0.01, gravity=1e4, contact="hertz")
    light = make_case(velocity=0.01, gravity=0.0, contact="hertz")
    assert stiffest_contact(heavy, make_pair(heavy)) > 2 * stiffest_contact(light, make_pair(light))


def run(courant, duration=0.5e-3, **values):
    """Answers at any Courant number, also above the 1 that the model allows."""
    impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
    cases = case_table(impact, grid, duration=duration)
    cases["courant"] = courant
    return solve(cases, samples=11, profiles=True)


@pytest.mark.parametrize("rule", ["lobatto", "legendre", "layers"])
@pytest.mark.parametrize("points", [2, 9])
def test_stable_at_the_largest_time_step_and_not_5_percent_above(rule, points):
    values = ELASTIC | {"nodes": 101, "rule": rule, "points": points}
    stable, unstable = run(1.0, **values), run(1.05, **values)
    assert stable["energy_error"] < 0.02
    assert not stable["status"] & STATUS_FLAGS["diverged"][0]
    assert unstable["status"] == STATUS_FLAGS["diverged"][0]


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"beam_model": "timoshenko", "beam_shape": "box", "beam_wall_thickness": 4e-3},
        {"beam_shape": "laminate", "beam_layers": "0.7 70e9 320e6 2700"},
        {"beam_model": "von_karman"},  # whose section has the fibres below the axis, too
    ],
)
def test_steps_are_counted_for_the_section_that_is_bent(values):
    values = {"nodes": 61, "rule": "layers"} | values
    impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
    cases = case_table(impact, grid, duration=1e-3).repeat(2)
    cases["points"] = 4, 10
    counts = step_counts(cases, cases, fibre_table(cases), 0)
    for case, count in zip(cases, counts, strict=True):
        assert count == discretise(case, make_pair(case), fibre_section(case))[1]
    assert counts[0] != counts[1]  # the rule's stiffness counts


def test_the_papers_bar_wave_limit_diverges():
    """dt = dx/sqrt(E/rho): at 101 nodes already twice what bending allows."""
    impact, grid = with_values(il.paper_impact(), il.Discretisation(nodes=101), ELASTIC)
    case = case_table(impact, grid, duration=1e-3)[0]
    critical, _ = time_steps(case)
    bar_wave = impact.beam.span / 100 / np.sqrt(210e9 / 7800)
    assert bar_wave > 1.9 * critical
    answers = run(bar_wave / critical, nodes=101, **ELASTIC)
    assert answers["status"] == STATUS_FLAGS["diverged"][0]
