"""The beam that stretches and can rest in a second shape: shallow arches, and minimisation."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import impactlab as il
from impactlab.simulate import run_dataset
from impactlab.solver.beam import CLAMPED, PINNED, make_grid
from impactlab.solver.outputs import SECOND_REST, UNSTABLE_REST
from impactlab.solver.settle_stretch import has_second_rest

NODES = 81


# rise over the radius of gyration from which a bowed beam without a load rests bowed the other way,
# too: of a half-wave (pinned) and a whole one (clamped, as soon as no antisymmetric shape buckles)
SECOND_REST_FROM = {"pinned": 4.0, "clamped": 19.565}


@pytest.mark.parametrize("copies", [1, 2], ids=["whole", "half"])
@pytest.mark.parametrize("ends", SECOND_REST_FROM)
def test_a_second_rest_is_that_of_a_shallow_arch(ends, copies):
    """Under N = P_1 (a/q - 1) an arch of rise a, stress-free there, has the rise q = -s < 0.

    Its length asks for s^2 - a s + m^2 (2 r)^2 = 0 with m half-waves. The larger root is stable
    unless N is below the second buckling load (of the clamped beam 8.183 pi^2 EI/L^2).
    """
    kind, waves = (PINNED, 1) if ends == "pinned" else (CLAMPED, 2)
    grid = make_grid(401, 1.0 / 400, 1e-6, 1.0, 1.0, kind, kind, alike=copies == 2)
    assert grid.copies == copies
    x = (np.arange(grid.last + 3) - grid.first + 1) / 400.0
    gyration = 1e-3
    EA, k, room = 1.0 / gyration**2, waves * np.pi, np.zeros((5, x.size))
    for share, expected in ((0.1, False), (0.99, False), (1.01, True), (3.0, True)):
        rise = share * SECOND_REST_FROM[ends] * gyration / waves  # of each sine
        bent = k**2 * rise * (-np.sin(k * x) if waves == 1 else np.cos(k * x))
        longer = np.full(x.size, -EA * 0.25 * (k * rise) ** 2)
        rests_twice = has_second_rest(np.zeros(x.size), room, bent, longer, 1.0, EA, 0.0, grid)
        assert rests_twice is expected, share


def rest_from(start, run, beam):
    """Return the pinned beam's deflection (m) at rest near `start`, its energy (J) and stiffness.

    By Newton's steps in a trust region, under the run's plastic strains; N is the same everywhere.
    The stiffness (N/m) is that of the softest shape.
    """
    dx, E = beam.span / (run.x.size - 1), beam.material.youngs_modulus
    z, area = beam.section.cut("lobatto", run.z.size)
    plastic, share = run.plastic_strain.values, np.full(run.x.size, dx)
    share[[0, -1]] *= 0.5
    bent = -plastic @ (area * z) / (area @ z**2)
    longer = share @ (plastic @ area) / area.sum()
    EI, EA = E * (area @ z**2), E * area.sum()
    bends = np.diff(np.eye(run.x.size), 2, axis=0)[:, 1:-1] / dx**2
    slopes = np.diff(np.eye(run.x.size), axis=0)[:, 1:-1] / dx
    stiff, turns = EI * dx * bends.T @ bends, dx * slopes.T @ slopes

    def energy(w):
        N = EA / beam.span * (0.5 * w @ turns @ w - longer)
        total = 0.5 * EI * dx * ((bends @ w - bent[1:-1]) ** 2).sum() + 0.5 * N**2 * beam.span / EA
        return total, stiff @ w - EI * dx * bends.T @ bent[1:-1] + N * turns @ w

    def hessian(w):
        N, pull = EA / beam.span * (0.5 * w @ turns @ w - longer), turns @ w
        return stiff + N * turns + EA / beam.span * np.outer(pull, pull)

    rest = minimize(energy, start[1:-1], jac=True, hess=hessian, method="trust-exact")
    return np.pad(rest.x, 1), rest.fun, np.linalg.eigvalsh(hessian(rest.x))[0]


@pytest.mark.parametrize(("depth", "twice"), [(0.006, True), (0.0065, False)])
def test_a_second_rest_after_a_strike_is_remarked(depth, twice):
    """In the one of two that has the least energy the beam is put to rest."""
    paper = il.paper_impact(20.0)
    impact = replace(
        paper,
        sphere=replace(paper.sphere, mass=0.26),
        beam=replace(paper.beam, depth=depth),
        beam_model="von_karman",
        contact="hertz",
        gravity=0.0,
    )
    run = run_dataset(impact, il.Discretisation(nodes=NODES), duration=0.03, samples=2, strikes=1)
    shape = run.deflection.values
    rests = [rest_from(side * shape, run, impact.beam) for side in (1.0, -1.0)]
    assert min(stiffness for _, _, stiffness in rests) > 0.0
    (one, _, _), (other, _, _) = rests
    assert (np.abs(one - other).max() > 0.2 * depth) == twice
    least, _, _ = min(rests, key=lambda rest: rest[1])
    residual = run.residual_deflection_over_strikes.item()
    assert residual == pytest.approx(least[NODES // 2], rel=1e-5)
    assert bool(run.remarks.item() & SECOND_REST) == twice


@pytest.mark.parametrize(("depth", "unstable"), [(0.0035, True), (0.004, False)])
def test_a_half_beam_that_would_buckle_on_its_foundation_is_remarked(depth, unstable):
    """The stiffness of the whole beam against shapes that are 0 in its middle, by its matrix."""
    paper = il.paper_impact(20.0)
    beam = replace(paper.beam, depth=depth)
    bed = 8.0 * beam.bending_stiffness * (np.pi / beam.span) ** 4
    impact = replace(
        paper,
        sphere=replace(paper.sphere, mass=0.26),
        beam=replace(beam, foundation_stiffness=bed),
        beam_model="von_karman",
        contact="hertz",
        gravity=0.0,
        strikes=2,  # after which the shape at rest is kept
    )
    run = il.simulate(impact, il.Discretisation(nodes=NODES), duration=0.03, samples=2)
    dx, E, w = beam.span / (NODES - 1), beam.material.youngs_modulus, run.deflection.values
    _, area = beam.section.cut("lobatto", run.z.size)
    longer = np.trapezoid(run.plastic_strain.values @ area, dx=dx) / area.sum()
    N = E * area.sum() * (0.5 * (np.diff(w) ** 2).sum() / dx - longer) / beam.span
    bends = np.diff(np.eye(NODES), 2, axis=0)[:, 1:-1] / dx**2
    slopes = np.diff(np.eye(NODES), axis=0)[:, 1:-1] / dx
    stiffness = beam.bending_stiffness * bends.T @ bends + N * slopes.T @ slopes
    values, shapes = np.linalg.eigh(stiffness + bed * np.eye(NODES - 2))
    odd = np.abs(shapes + shapes[::-1]).max(axis=0) < 1e-6
    assert (values[odd].min() < 0.0) == unstable
    assert bool(run.remarks.item() & UNSTABLE_REST) == unstable
