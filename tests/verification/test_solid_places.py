"""The 3-D model with any ends, struck anywhere: mirrored, halved, balanced, as stiff as a beam."""

from dataclasses import replace

import numpy as np
import pytest
from end_modes import roots
from scipy.sparse.linalg import eigsh
from solid_matrices import matrices

import impactlab as il
from impactlab.fem3d.solver import impact_mesh, march, solve_on
from impactlab.fem3d.solver.mesh import BEAM
from impactlab.fem3d.solver.system import System, ThreadPool

COARSE = {"element_size": 3e-3, "ratio": 2.0, "coarsest": 14e-3}
STEP = 3e-7
"""Seconds, 0.7 of the largest stable step on these meshes; Lanczos ends a bit elsewhere on each."""
COMPARED = ("contact_force", "midspan_deflection", "strain_work", "plastic_work", "kinetic_energy")


SPRINGS = {
    f"{kind}stiffness_{side}": value
    for side in ("left", "right")
    for kind, value in (("", 3e7), ("rotational_", 4e4))
}


def held(left, right, place, velocity=5.0, **values):
    paper = il.paper_impact(velocity)
    beam = replace(paper.beam, support_left=left, support_right=right, **values)
    return replace(paper, beam=beam, strike_position=place, beam_model="solid", gravity=0.0)


def solved(monkeypatch, impact, duration=1.2e-4, **options):
    monkeypatch.setattr(march, "critical_step", lambda system: STEP)
    return solve_on(impact_mesh(impact, **COARSE, **options), impact, duration=duration)


def assert_same(run, expected):
    for name in COMPARED:
        scale = float(abs(expected[name]).max())
        np.testing.assert_allclose(run[name], expected[name], rtol=0.0, atol=1e-9 * scale)
    for name in ("plastic_zone_length", "peak_plastic_strain", "impulse"):
        assert float(run[name]) == pytest.approx(float(expected[name]), rel=1e-9, nan_ok=True)


@pytest.mark.parametrize("ends", ["pinned", "clamped", "free", "elastic"])
def test_a_half_answers_as_the_quarter_of_a_symmetric_impact(monkeypatch, ends):
    impact = held(ends, ends, 0.5, **(SPRINGS if ends == "elastic" else {}))
    quarter = solved(monkeypatch, impact)
    half = solved(monkeypatch, impact, quarters=False)
    assert half.sizes["element"] == 2 * quarter.sizes["element"]
    assert float(quarter["plastic_work"].max()) > 0.1
    assert_same(half, quarter)


@pytest.mark.parametrize(
    ("end", "springs", "bed"),
    [("clamped", {}, 0.0), ("elastic", {"stiffness": 1e8, "rotational_stiffness": 5e4}, 1e9)],
)
def test_a_mirrored_strike_has_the_mirrored_answer(monkeypatch, end, springs, bed):
    left, right = (
        {f"{name}_{side}": value for name, value in springs.items()} | {"foundation_stiffness": bed}
        for side in ("left", "right")
    )
    run = solved(monkeypatch, held(end, "free", 0.05, **left))
    assert_same(solved(monkeypatch, held("free", end, 0.95, **right)), run)
    if springs:
        assert float(run["spring_energy"].max()) > 0.1
        return
    middle = solved(monkeypatch, held("clamped", "clamped", 0.5))
    deflection, free = (solution["midspan_deflection"] for solution in (run, middle))
    assert float(deflection.max()) < 0.95 * float(free.max())  # the clamp is near


def test_a_free_beam_struck_beside_its_middle_keeps_momentum_and_energy():
    impact = held("free", "free", 0.3)
    momentum = impact.sphere.total_mass * impact.velocity
    mesh = impact_mesh(impact, **COARSE)
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        history = march.March(system, impact).run(3e-4)
    assert history.table()[1][-1] == 0.0  # they have parted
    mass, x, v = mesh.copies * system.mass, system.x, system.v
    beam = np.unique(mesh.elements[mesh.body == BEAM])
    turning = mass * (x[:, 2] * v[:, 0] - x[:, 0] * v[:, 2])
    centre = 0.2 * impact.beam.span  # from the impact
    total, of_beam = mass @ v, mass[beam] @ v[beam]
    np.testing.assert_allclose(total[[0, 2]], [0.0, -momentum], atol=1e-9 * momentum)
    assert abs(turning.sum()) < 1e-4 * momentum * centre
    assert -of_beam[2] > 0.8 * momentum
    beams = turning[beam].sum()  # about the impact: the beam turns about its centre as it moves
    assert abs(beams) < 1e-3 * momentum * centre
    balance = np.array([entry.balance for entry in history.energies])
    np.testing.assert_allclose(balance, 0.5 * momentum * impact.velocity, rtol=1e-4)


@pytest.mark.parametrize(
    ("left", "right"),
    [("clamped", "clamped"), ("free", "clamped"), ("clamped", "pinned"), ("free", "free")],
)
def test_the_lowest_frequency_is_that_of_a_beam_with_such_ends(left, right):
    paper = il.paper_impact()
    beam = replace(paper.beam, span=0.5, width=0.02, depth=0.02)
    beam = replace(beam, support_left=left, support_right=right)
    impact = replace(paper, beam=beam, strike_position=0.4, beam_model="solid")
    sizes = {"element_size": 5e-3, "patch": 5e-3, "ratio": 3.0, "coarsest": 20e-3}
    stiffness, mass, _ = matrices(impact, impact_mesh(impact, **sizes))
    # A beam without clamps slides; one without any supports rises and turns, too.
    rigid = ("clamped" not in (left, right)) + 2 * ((left, right) == ("free", "free"))
    near = -((2.0 * np.pi * 10.0) ** 2)  # below all, so that nothing is singular
    squares = np.sort(eigsh(stiffness, rigid + 1, mass, sigma=near, return_eigenvectors=False))
    assert abs(squares[:rigid]).max(initial=0.0) < 1e-3 * squares[-1]
    wave = roots(left, right, 1)[0] / beam.span
    per_length = beam.bending_stiffness / beam.mass_per_length
    assert squares[-1] ** 0.5 == pytest.approx(wave**2 * per_length**0.5, rel=0.015)
