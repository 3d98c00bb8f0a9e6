"""Beams of any supports, struck anywhere: closed-form modes, symmetry, statics, momentum."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

import impactlab as il
from impactlab.solver import SUPPORTS
from impactlab.solver.beam import (
    add_moment,
    copies,
    make_beam,
    make_grid,
    mirror,
)
from impactlab.verification.solutions.bending import plastic_moment

from ..end_modes import PAIRS, held, response_errors

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")


@pytest.mark.parametrize("struck", [4, 10])
@pytest.mark.parametrize(("left", "right"), PAIRS)
def test_plastic_moments_do_the_work_of_their_curvatures(left, right, struck):
    """The nodes' kicks times their deflections are the moments times the curvatures."""
    kinds = SUPPORTS.index(left), SUPPORTS.index(right)
    grid, random = make_grid(21, 0.05, 1e-6, 2.0, 3.0, *kinds, struck), np.random.default_rng(1)
    beam, moments = make_beam(grid), np.zeros(grid.last + 3)
    sections = np.arange(2, grid.last + 1)
    for i, end in ((2, grid.left), (grid.last, grid.right)):
        sections = sections[(sections != i) | (end != SUPPORTS.index("free"))]
    for i in sections:
        add_moment(beam.plastic, moments, np.uint64(i), random.uniform(-1.0, 1.0), grid)
    beam.w[1, 2 : grid.last + 1] = random.uniform(-1.0, 1.0, grid.last - 1)
    mirror(beam.w, 0, beam.u, grid)
    w, curvatures = beam.w[1, 1:-1], np.diff(beam.w[1], 2)
    shares = np.array([copies(grid, i) for i in range(1, grid.last + 2)])
    kicks, work = beam.plastic[1:-1] * w, grid.factor * moments[1:-1] * curvatures
    assert np.sum((shares * kicks)[1:-1]) == pytest.approx(np.sum(shares * work), rel=1e-12)


@pytest.mark.parametrize("place", [0.1, 0.3, 0.5])
@pytest.mark.parametrize(("left", "right"), PAIRS)
def test_the_elastic_response_converges_to_that_of_closed_form_modes(left, right, place):
    """Leapfrog at second order, down to the modes left out."""
    coarse, fine = (response_errors(left, right, place, nodes) for nodes in (101, 201))
    assert (fine < np.maximum(0.28 * coarse, 1e-3)).all()
    assert fine.max() < (0.026 if place == 0.1 else 0.005)
    coarse, fine = (response_errors(left, right, place, nodes, "modal") for nodes in (21, 41))
    assert (fine < 0.5 * coarse).all()
    assert fine.max() < 5e-4


MIRRORED = {
    "point": {"load": "point"},
    "contact_patch": {},
    "timoshenko": {"beam_model": "timoshenko"},
    "strip": {"beam_model": "timoshenko", "contact_compliance": "strip"},
    "modal": {"load": "point"},
    "modal contact_patch": {},
}


@pytest.mark.parametrize("velocity", [1.0, 15.0])
@pytest.mark.parametrize(
    ("model", "left", "right"),
    [
        (model, *pair)
        for model, pair in itertools.product(MIRRORED, PAIRS)
        if pair[0] <= pair[1]  # the other order is in the mirror image
        if model != "strip" or "free" not in pair  # which is refused
    ],
)
def test_a_mirrored_impact_has_the_same_answers(left, right, velocity, model):
    base = replace(il.paper_impact(velocity), **{"load": "contact_patch"} | MIRRORED[model])
    modal = model.startswith("modal")
    grid = il.Discretisation(nodes=41, scheme="modal" if modal else "leapfrog")
    one, other = (
        il.simulate(held(*case, base), grid, duration=3e-3)
        for case in ((left, right, 0.3), (right, left, 0.7))
    )
    share = 1e-5 if modal else 1e-6
    for name in ("peak_force", "impulse", "contact_duration", "plastic_dissipation"):
        assert one[name].item() == pytest.approx(other[name].item(), rel=share, nan_ok=True)
    size = np.abs(one.deflection).max().item()
    assert one.deflection.values[::-1] == pytest.approx(other.deflection.values, abs=share * size)
    strain = one.equivalent_plastic_strain.values
    assert strain[::-1] == pytest.approx(other.equivalent_plastic_strain.values, abs=1e-8)
    assert one.energy_error.item() < (2e-3 if modal else 1e-3)
    assert (velocity > 1.0) == bool(strain.max() > 1e-4)
    assert one.plastic_zone_length.item() == pytest.approx(
        other.plastic_zone_length.item(), abs=1e-6
    )


@pytest.mark.parametrize("place", [0.0, 0.3, 0.5])
@pytest.mark.parametrize(
    ("model", "scheme"),
    [("euler_bernoulli", "leapfrog"), ("timoshenko", "leapfrog"), ("euler_bernoulli", "modal")],
)
def test_a_free_beam_keeps_momentum_and_moment_of_momentum(place, model, scheme):
    """rho A times the integrals of w and x w are those of the force, twice over the time.

    Rotary inertia has a thousandth of the moment.
    """
    impact = replace(held("free", "free", place, il.paper_impact(15.0)), beam_model=model)
    plain = (model, scheme) == ("euler_bernoulli", "leapfrog")
    grid = il.Discretisation(nodes=81 if scheme == "modal" else 41, scheme=scheme)
    run = il.simulate(impact, grid, duration=2e-3, samples=8001)
    t, x, w = run.time.values, run.x.values, run.deflection.values
    force, mass = run.contact_force.values, impact.beam.mass_per_length
    twice = cumulative_trapezoid(cumulative_trapezoid(force, t, initial=0.0), t, initial=0.0)[-1]
    assert run.peak_plastic_strain.item() > 0.0 or place == 0.0
    rel = 2e-3 if scheme == "modal" else 1e-3
    assert mass * np.trapezoid(w, x) == pytest.approx(twice, rel=rel)
    moment = mass * np.trapezoid(w * (x - x[-1] / 2), x)
    arm = (place - 0.5) * impact.beam.span
    assert moment == pytest.approx(arm * twice, rel=1e-3 if plain else 5e-3, abs=1e-6 * twice)


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
