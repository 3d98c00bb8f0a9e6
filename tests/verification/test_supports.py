"""Beams of any supports, struck anywhere: closed-form modes, symmetry, statics, momentum."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, simpson
from scipy.optimize import brentq

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values
from impactlab.simulate import fibre_section
from impactlab.solver import SUPPORTS, euler_bernoulli
from impactlab.solver.beam import make_beam, make_grid, mirror, move_virgin
from impactlab.solver.contact.history import make_pair
from impactlab.solver.fibre_plasticity import make_plastic_state
from impactlab.solver.stability import discretise
from impactlab.solver.state import State
from impactlab.verification.solutions.bending import plastic_moment

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

PAIRS = list(itertools.product(SUPPORTS, SUPPORTS))
IMPACT = replace(il.paper_impact(1.0, "hertz"), beam_model="elastic")


def held(left, right, place, impact=IMPACT):
    beam = replace(impact.beam, support_left=left, support_right=right)
    return replace(impact, beam=beam, strike_position=place)


def characteristic(left, right):
    """(function of beta L whose roots are the modes, estimate of the n-th root).

    Rayleigh's equations, divided by cosh, with free and clamped ends alike.
    """
    kinds = sorted("pinned" if end == "pinned" else end for end in (left, right))
    if kinds == ["pinned", "pinned"]:
        return np.sin, lambda n: n * np.pi
    if "pinned" in kinds:
        return lambda b: np.sin(b) - np.tanh(b) * np.cos(b), lambda n: (n + 0.25) * np.pi
    sign = 1.0 if kinds == ["clamped", "free"] else -1.0
    shift = -0.5 if sign > 0 else 0.5
    return lambda b: np.cos(b) + sign / np.cosh(b), lambda n: (n + shift) * np.pi


def roots(left, right, number):
    function, near = characteristic(left, right)
    return np.array(
        [brentq(function, near(n) - 0.4, near(n) + 0.4, xtol=1e-13) for n in range(1, number + 1)]
    )


def basis(b, x, derivative):
    """Four solutions of y'''' = b^4 y on (0, 1), of size one each: rows x, columns solutions."""
    quarter = derivative * np.pi / 2
    falling, rising = np.exp(-b * x), np.exp(-b * (1 - x))
    columns = np.sin(b * x + quarter), np.cos(b * x + quarter), (-1) ** derivative * falling, rising
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


CONDITIONS = {"pinned": (0, 2), "clamped": (0, 1), "free": (2, 3)}


def modes(left, right, number, x):
    """(beta L, shapes on x, with unit mean square) of the bending modes."""
    betas, shapes, fine = roots(left, right, number), [], np.linspace(0, 1, 8001)
    for b in betas:
        rows = [basis(b, 0.0, order) for order in CONDITIONS[left]]
        rows += [basis(b, 1.0, order) for order in CONDITIONS[right]]
        coefficients = np.linalg.svd(np.array(rows))[2][-1]
        shape = basis(b, fine, 0) @ coefficients
        shapes.append(basis(b, x, 0) @ coefficients / np.sqrt(simpson(shape**2, x=fine)))
    return betas, np.array(shapes)


def rigid_shapes(left, right, x):
    """Shapes in which the beam moves without bending, with unit mean square."""
    if (left, right) == ("free", "free"):
        return [np.ones_like(x), np.sqrt(12) * (x - 0.5)]
    if {left, right} == {"pinned", "free"}:
        return [np.sqrt(3) * (x if left == "pinned" else 1 - x)]
    return []


def discrete_frequencies(left, right, nodes, struck):
    """Return the grid's frequencies over sqrt(EI/(rho A L^4)), ascending, from its steps alone."""
    grid = make_grid(
        nodes, 1 / (nodes - 1), 1e-6, 1.0, 1.0, SUPPORTS.index(left), SUPPORTS.index(right), struck
    )
    columns = []
    for i in range(2, grid.last + 1):
        beam = make_beam(grid)
        beam.w[1, i] = 1.0
        mirror(beam.w, 0, beam.u, grid)
        move_virgin(beam.w, 1, beam.u, 2, grid.last + 1, grid, np.inf)
        mirror(beam.w, 1, beam.u, grid)
        columns.append(-beam.u[2 : grid.last + 1] / grid.dt**2)
    values = np.linalg.eigvals(np.array(columns).T)
    assert np.abs(values.imag).max() < 1e-3
    return np.sqrt(np.maximum(np.sort(values.real), 0.0))


@pytest.mark.parametrize(("left", "right"), PAIRS)
def test_frequencies_converge_at_second_order_to_the_closed_form(left, right):
    exact = roots(left, right, 4) ** 2
    still = len(rigid_shapes(left, right, np.zeros(1)))
    errors = []
    for nodes in (41, 81):
        frequencies = discrete_frequencies(left, right, nodes, struck=4)
        frequencies = frequencies[frequencies > 0.5]
        assert frequencies[-1] <= 4 * (nodes - 1) ** 2 * (1 + 1e-9)  # that of stability.py
        assert len(frequencies) == nodes - still - sum(end != "free" for end in (left, right))
        errors.append(frequencies[:4] / exact - 1)
    assert np.abs(errors[1]).max() < 6e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx([2.0] * 4, abs=0.1)


def modal_errors(left, right, place, nodes):
    """Return errors of history and last shape, over the largest deflection, under the same force.

    Every closed-form mode is integrated exactly under that force.
    """
    impact = held(left, right, place)
    run = il.simulate(impact, il.Discretisation(nodes=nodes), duration=3e-3, samples=6001)
    beam, t, x = impact.beam, run.time.values, run.x.values / impact.beam.span
    force, mass = run.contact_force.values, beam.mass_per_length * beam.span
    places = np.append(x, place)
    betas, shapes = modes(left, right, 60, places)
    speeds = betas**2 * np.sqrt(beam.bending_stiffness / (mass * beam.span**3))
    turns = np.exp(-1j * np.outer(speeds, t))
    sums = cumulative_trapezoid(force * turns, t, initial=0.0) / turns
    amplitudes = sums.imag / (mass * speeds[:, np.newaxis])
    twice = cumulative_trapezoid(cumulative_trapezoid(force, t, initial=0.0), t, initial=0.0)
    for shape in rigid_shapes(left, right, places):
        shapes, amplitudes = np.vstack([shapes, shape]), np.vstack([amplitudes, twice / mass])
    amplitudes *= shapes[:, -1:]
    history, profile = shapes[:, -1] @ amplitudes, amplitudes[:, -1] @ shapes[:, :-1]
    size = np.abs(history).max()
    assert size > 2e-5
    errors = run.midspan_deflection.values - history, run.deflection.values - profile
    return np.array([np.abs(error).max() for error in errors]) / size


@pytest.mark.parametrize("place", [0.1, 0.3, 0.5])
@pytest.mark.parametrize(("left", "right"), PAIRS)
def test_the_elastic_response_converges_to_that_of_closed_form_modes(left, right, place):
    coarse, fine = (modal_errors(left, right, place, nodes) for nodes in (101, 201))
    assert (
        fine < np.maximum(0.28 * coarse, 1e-3)
    ).all()  # second order, down to the modes left out
    assert fine.max() < (0.026 if place == 0.1 else 0.005)


@pytest.mark.parametrize("velocity", [1.0, 15.0])
@pytest.mark.parametrize(("left", "right"), PAIRS)
@pytest.mark.parametrize("load", ["point", "contact_patch"])
def test_a_mirrored_impact_has_the_same_answers(left, right, velocity, load):
    base = replace(il.paper_impact(velocity), load=load)
    one, other = (
        il.simulate(held(*case, base), il.Discretisation(nodes=41), duration=3e-3)
        for case in ((left, right, 0.3), (right, left, 0.7))
    )
    for name in ("peak_force", "impulse", "contact_duration", "plastic_dissipation"):
        assert one[name].item() == pytest.approx(other[name].item(), rel=1e-6, nan_ok=True)
    size = np.abs(one.deflection).max().item()
    assert one.deflection.values[::-1] == pytest.approx(other.deflection.values, abs=1e-6 * size)
    strain = one.equivalent_plastic_strain.values
    assert strain[::-1] == pytest.approx(other.equivalent_plastic_strain.values, abs=1e-8)
    assert one.energy_error.item() < 1e-3
    assert (velocity > 1.0) == bool(strain.max() > 1e-4)
    assert one.plastic_zone_length.item() == pytest.approx(
        other.plastic_zone_length.item(), abs=1e-6
    )


@pytest.mark.parametrize("end", SUPPORTS)
def test_the_whole_beam_moves_as_its_half(end):
    """Under a force in the middle by which sections yield; the whole has another struck node."""
    impact = held(end, end, 0.5, il.paper_impact(10.0))
    case = case_table(impact, il.Discretisation(nodes=41), duration=2e-3)[0]
    section = fibre_section(case)
    half, steps = discretise(case, make_pair(case), section)
    sizes = 41, half.dx, half.dt, half.mu, section.stiffness
    kind = SUPPORTS.index(end)
    whole = make_grid(*sizes, kind, kind, 4)
    whole = whole._replace(mid=whole.mid + 16)
    assert (whole.mid, whole.last > half.last) == (half.mid, True)
    states = []
    for grid in (half, whole):
        state = State(
            make_pair(case),
            section,
            grid,
            make_beam(grid),
            make_plastic_state(grid, section),
            euler_bernoulli.MODEL.make(case, section, grid),
        )
        states.append(state)
    for step in range(steps):
        F = max(8e4 * np.sin(np.pi * step * half.dt / 5e-4), 0.0) * (step * half.dt < 5e-4)
        now, before = step % 2, [state.beam.u[half.mid] for state in states]
        for state in states:
            euler_bernoulli.MODEL.step(state, now, F)
        if step % 500 == 0:
            ours, both = (
                euler_bernoulli.MODEL.energy(state, now, F, u_mid)
                for state, u_mid in zip(states, before, strict=True)
            )
            assert ours == pytest.approx(both, rel=1e-9)
    left = slice(0, half.mid + 1)
    w, peeq = states[0].beam.w[:, left], states[0].plastic.peeq[left]
    assert peeq.max() > 1e-4
    assert np.abs(w).max() > 1e-4
    assert states[1].beam.w[:, left] == pytest.approx(w, abs=1e-9 * np.abs(w).max())
    assert states[1].plastic.peeq[left] == pytest.approx(peeq, abs=1e-9)


@pytest.mark.parametrize("place", [0.0, 0.3, 0.5])
def test_a_free_beam_keeps_momentum_and_moment_of_momentum(place):
    """rho A times the integrals of w and x w are those of the force, twice over the time."""
    impact = held("free", "free", place, il.paper_impact(15.0))
    run = il.simulate(impact, il.Discretisation(nodes=41), duration=2e-3, samples=8001)
    t, x = run.time.values, run.x.values
    force = run.contact_force.values
    twice = cumulative_trapezoid(cumulative_trapezoid(force, t, initial=0.0), t, initial=0.0)[-1]
    weights = np.full(x.size, impact.beam.mass_per_length * (x[1] - x[0]))
    weights[[0, -1]] /= 2
    assert run.peak_plastic_strain.item() > 0.0 or place == 0.0
    assert weights @ run.deflection.values == pytest.approx(twice, rel=1e-3)
    moment = (weights * (x - x[-1] / 2)) @ run.deflection.values
    arm = (place - 0.5) * impact.beam.span
    assert moment == pytest.approx(arm * twice, rel=1e-3, abs=1e-6 * twice)


@pytest.mark.parametrize(
    ("ends", "place", "factor"),
    [
        (("pinned", "pinned"), 0.5, 4.0),
        (("clamped", "clamped"), 0.5, 8.0),
        (("clamped", "clamped"), 0.25, 32.0 / 3.0),
        (("clamped", "pinned"), 0.5, 6.0),
        (("clamped", "free"), 1.0, 1.0),
    ],
)
def test_a_heavy_sphere_pushes_the_beam_to_its_collapse_load(ends, place, factor):
    """F = factor M_p/L, of mechanisms with a hinge at each clamped end and under the force."""
    impact = held(*ends, place, il.paper_impact(0.3, "hertz"))
    impact = replace(impact, sphere=replace(impact.sphere, mass=1e5), gravity=0.0)
    grid = il.Discretisation(nodes=41, points=15)
    run = il.simulate(impact, grid, duration="0.4 s" if factor > 1 else "1.2 s", samples=2001)
    force = run.contact_force.values[-500:].mean()
    assert force == pytest.approx(factor * plastic_moment(impact.beam) / impact.beam.span, rel=0.02)


@pytest.mark.parametrize(
    ("varied", "message"),
    [
        (
            {"strike_position": 0.33},
            r"^strike_position = 0\.33: .* take 0\.325 or 0\.35, or 101 nodes$",
        ),
        ({"strike_position": 0.0}, r"^Impact\.strike_position = 0\.0: must be a share"),
        (
            {"support_left": "clamped", "scheme": "modal"},
            r"^scheme = 'modal': must be leapfrog with",
        ),
        (
            {"support_right": "free", "beam_model": "timoshenko"},
            r"^Impact\.beam_model = 'timoshenko'",
        ),
        (
            {"strike_position": 0.25, "beam_model": "rigid"},
            r"^Impact\.beam_model = 'rigid': must be",
        ),
        (
            {"strike_position": 0.25, "beam_model": "solid"},
            r"^Impact\.beam_model = 'solid': must be",
        ),
    ],
)
def test_what_lacks_other_beams_refuses_them(varied, message):
    with pytest.raises(ValueError, match=message):
        case_table(
            *with_values(il.paper_impact(), il.Discretisation(nodes=41), varied), duration=1e-3
        )
