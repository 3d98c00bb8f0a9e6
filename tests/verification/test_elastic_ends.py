"""Ends on springs: closed-form frequencies, limits, energy, in leapfrog and the modal scheme."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from end_modes import sprung_roots

import impactlab as il
from impactlab.model.beam_modes import mode_table, wave_numbers
from impactlab.model.case_table import case_table
from impactlab.simulate import solve
from impactlab.solver import SUPPORTS
from impactlab.solver.beam import make_beam, make_grid, mirror, move_virgin

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

SPRINGS = [  # k_t and k_r of the left end and of the right one, over EI and span
    ((50.0, 3.0), (np.inf, 0.0)),
    ((200.0, 0.0), (7.0, 40.0)),
    ((5.0, 1.0), (0.0, 0.0)),
    ((300.0, 20.0), (300.0, 20.0)),
    ((0.0, 4.0), (np.inf, np.inf)),
]
PLAIN = [*itertools.product([(np.inf, 0.0), (np.inf, np.inf), (0.0, 0.0)], repeat=2)]
"""Pinned, clamped and free."""


def kinds(springs):
    """Supports, as numbers, and what make_grid takes of springs; EI and span are 1."""
    names = {(np.inf, 0.0): "pinned", (np.inf, np.inf): "clamped", (0.0, 0.0): "free"}
    ends = [SUPPORTS.index(names.get(spring, "elastic")) for spring in springs]
    finite = np.where(np.isinf(springs), 0.0, springs)
    return ends, (*finite[:, 0], *finite[:, 1])


@pytest.mark.parametrize("springs", SPRINGS)
def test_modes_have_the_frequencies_of_the_characteristic_equation(springs):
    exact = sprung_roots(springs, 5)  # beyond, the exponentials take the digits of this determinant
    b = wave_numbers(np.array(springs), 12)
    assert b[b > 0.0][:5] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("springs", [*SPRINGS, *PLAIN])
def test_the_grids_frequencies_converge_to_it_at_second_order(springs):
    exact, errors = sprung_roots(springs, 4) ** 2, []
    still = max(2 - np.count_nonzero(springs), 0) + springs.count((np.inf, np.inf))
    ends, stiffnesses = kinds(springs)
    for nodes in (41, 81):
        grid = make_grid(nodes, 1 / (nodes - 1), 1e-6, 1.0, 1.0, *ends, 4, *stiffnesses)
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
        values = np.sort(values.real)
        largest = 16.0 * (nodes - 1) ** 4 + 2.0 * max(stiffnesses[:2]) * (nodes - 1)
        assert values[-1] <= largest * (1 + 1e-9)  # that of stability.py
        frequencies = np.sqrt(np.maximum(values, 0.0))
        assert np.count_nonzero(frequencies < 0.09) == still
        errors.append(frequencies[still : still + 4] / exact - 1)
    assert np.abs(errors[1]).max() < 6e-3
    assert np.abs(errors[1]) == pytest.approx(np.abs(errors[0]) / 4, rel=0.07, abs=1e-7)


def on_springs(springs, place=0.25, velocity=15.0):
    impact = il.paper_impact(velocity, "hertz")
    beam, span = impact.beam, impact.beam.span
    names = [SUPPORTS[kind] for kind in kinds(springs)[0]]
    k_left, k_right, turn_left, turn_right = kinds(springs)[1]
    EI = beam.bending_stiffness
    beam = replace(
        beam,
        support_left=names[0],
        support_right=names[1],
        stiffness_left=k_left * EI / span**3,
        stiffness_right=k_right * EI / span**3,
        rotational_stiffness_left=turn_left * EI / span,
        rotational_stiffness_right=turn_right * EI / span,
        material=replace(beam.material, isotropic_hardening_modulus=5e9),
    )
    return replace(impact, beam=beam, strike_position=place)


def solved(impact, scheme, nodes):
    grid = il.Discretisation(nodes=nodes, points=15, scheme=scheme)
    return il.simulate(impact, grid, duration=3e-3)


@pytest.mark.parametrize("place", [0.25, 0.5])
@pytest.mark.parametrize("springs", SPRINGS)
def test_both_schemes_have_one_limit_and_keep_the_energy(springs, place):
    impact = on_springs(springs, place)
    leapfrog, modal = (solved(impact, *grid) for grid in (("leapfrog", 401), ("modal", 121)))
    for name, rel in (("peak_force", 5e-3), ("impulse", 0.02), ("plastic_dissipation", 0.03)):
        assert modal[name].item() == pytest.approx(leapfrog[name].item(), rel=rel)
    size = np.abs(leapfrog.midspan_deflection).max().item()
    difference = modal.midspan_deflection.values - leapfrog.midspan_deflection.values
    assert np.abs(difference).max() < 0.015 * size
    assert leapfrog.energy_error.item() < 1e-4
    assert modal.energy_error.item() < 1e-3
    profile = modal.deflection.values - np.interp(modal.x, leapfrog.x, leapfrog.deflection)
    assert np.abs(profile).max() < 0.02 * np.abs(leapfrog.deflection).max().item()


@pytest.mark.long
@pytest.mark.parametrize(
    ("springs", "place"),
    [(SPRINGS[3], 0.5), (((200.0, 10.0), (np.inf, 0.0)), 0.25)],
    ids=["both ends", "one end"],
)
def test_yielding_beam_is_that_of_opensees(springs, place):
    """Under the same force, extrapolated from two meshes; where `opensees` is installed."""
    pytest.importorskip("openseespy")
    from ..benchmarks.opensees_beam import strike

    impact, duration = on_springs(springs, place), 3e-3
    metal = replace(impact.beam.material, isotropic_hardening_modulus=0.0)
    impact = replace(impact, beam=replace(impact.beam, material=metal))
    grid = il.Discretisation(nodes=321, points=9)
    run = il.simulate(impact, grid, duration=duration, samples=8001)
    coarse, fine = (
        np.array(strike(impact.beam, run.contact_force.values, duration, n, 4000, place=place))
        for n in (40, 80)
    )
    deflection, dissipation = 2.0 * fine - coarse
    assert np.abs(fine / coarse - 1.0).max() < 0.05
    assert run.midspan_deflection.max() == pytest.approx(deflection, rel=0.01)
    assert run.plastic_dissipation == pytest.approx(dissipation, rel=0.02)


@pytest.mark.parametrize(
    ("model", "scheme"),
    [("euler_bernoulli", "leapfrog"), ("euler_bernoulli", "modal"), ("timoshenko", "leapfrog")],
)
@pytest.mark.parametrize(
    ("springs", "limit"),
    [
        (((1e-9, 0.0), (1e-9, 0.0)), ("free", "free")),
        (((1e7, 0.0), (1e7, 0.0)), ("pinned", "pinned")),
        (((1e7, 1e7), (1e-9, 0.0)), ("clamped", "free")),
        (((1e7, 1e7), (1e7, 0.0)), ("clamped", "pinned")),
    ],
)
def test_springs_have_the_other_ends_as_limits(springs, limit, model, scheme):
    impact = replace(on_springs(springs, velocity=0.5), beam_model=model)
    plain = replace(impact.beam, support_left=limit[0], support_right=limit[1])
    nodes = 101 if scheme == "leapfrog" else 41
    ours, other = (solved(each, scheme, nodes) for each in (impact, replace(impact, beam=plain)))
    size = np.abs(other.midspan_deflection).max().item()
    difference = ours.midspan_deflection.values - other.midspan_deflection.values
    assert np.abs(difference).max() < 1e-3 * size
    assert ours.peak_force.item() == pytest.approx(other.peak_force.item(), rel=1e-4)


def test_half_a_beam_on_springs_is_the_whole():
    """Equal springs and a strike in the middle; nearly equal ones make the whole."""
    impact = on_springs(((300.0, 20.0), (300.0, 20.0)), 0.5)
    uneven = replace(impact.beam, stiffness_left=impact.beam.stiffness_left * (1 + 1e-9))
    for scheme in ("leapfrog", "modal"):
        cases = [
            case_table(each, il.Discretisation(nodes=41, scheme=scheme), duration=3e-3)
            for each in (impact, replace(impact, beam=uneven))
        ]
        if scheme == "modal":
            assert mode_table(cases[1][0]).shape[1] > 1.5 * mode_table(cases[0][0]).shape[1]
        answers = solve(np.concatenate(cases))  # in one batch, of unlike sizes
        for name in ("peak_force", "impulse", "plastic_dissipation"):
            assert answers[name][0] == pytest.approx(answers[name][1], rel=1e-4)
