"""Beams of every shape, struck: elastic series, collapse loads, balance of energy, OpenSees."""

from dataclasses import replace

import numpy as np
import pytest
from shapes import SIZES, beam_of

import impactlab as il
from impactlab.simulate import run_dataset
from impactlab.verification.cases import elastic
from impactlab.verification.solutions import modal
from impactlab.verification.solutions.bending import plastic_moment

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

FURTHER = [shape for shape in SIZES if shape != "rectangle"]


def struck(shape, velocity, **changes):
    return replace(il.paper_impact(velocity, "hertz"), beam=beam_of(shape), **changes)


@pytest.mark.parametrize(
    ("model", "series", "nodes", "tolerance"),
    [("elastic", modal.solve, 301, 7e-3), ("timoshenko", modal.solve_timoshenko, 601, 1.3e-2)],
    ids=["elastic", "timoshenko"],
)
@pytest.mark.parametrize("shape", FURTHER)
def test_elastic_impact_is_that_of_the_modal_series(shape, model, series, nodes, tolerance):
    """The series takes rho A and EI, and rho I and k G A, from the section."""
    impact, duration = replace(elastic(struck(shape, 1.0)), beam_model=model), 1e-3
    exact = series(impact, duration)
    run = run_dataset(impact, il.Discretisation(nodes=nodes), duration=duration, samples=401)
    for name in ("contact_force", "midspan_deflection"):
        expected = exact.at(name, run.time.values)
        assert np.abs(run[name] - expected).max() < tolerance * expected.max(), name


@pytest.mark.parametrize("shape", FURTHER)
def test_a_heavy_sphere_pushes_the_beam_to_its_collapse_load(shape):
    """F = 4 M_p/L."""
    impact = struck(shape, 0.3, gravity=0.0)
    impact = replace(impact, sphere=replace(impact.sphere, mass=1e5))
    grid = il.Discretisation(nodes=41, scheme="modal")
    run = il.simulate(impact, grid, duration="0.4 s")
    force = run.contact_force.values[-500:].mean()
    assert force == pytest.approx(4 * plastic_moment(impact.beam) / impact.beam.span, rel=0.02)


@pytest.mark.parametrize("model", ["euler_bernoulli", "timoshenko"])
@pytest.mark.parametrize("shape", FURTHER)
def test_energy_balances_and_remarks_say_what_the_beam_lacks(shape, model):
    run = il.simulate(
        struck(shape, 15.0, beam_model=model), il.Discretisation(nodes=101), duration="3 ms"
    )
    assert run.plastic_dissipation > 0.05 * 0.5 * run.sphere_mass * 15**2
    assert run.energy_error < 1e-3
    meanings = run.remarks.attrs["flag_meanings"].split()
    bits = zip(meanings, run.remarks.attrs["flag_masks"], strict=True)
    expected = {"wall_may_dent": ("box", "tube", "i", "profile"), "round_top": ("tube", "circle")}
    expected |= {"skin_may_give": ("laminate",)}
    remarks = {name for name, bit in bits if int(run.remarks) & bit} - {"stretching_left_out"}
    assert remarks == {name for name, shapes in expected.items() if shape in shapes}


@pytest.mark.long
@pytest.mark.parametrize("shape", ["i", "box"])
def test_yielding_beam_is_that_of_opensees(shape):
    """Under the same force; where the extra `opensees` is installed."""
    pytest.importorskip("openseespy")
    from ..benchmarks.opensees_beam import strike

    impact, duration = struck(shape, 10.0), 2e-3
    grid = il.Discretisation(nodes=201, points=21, scheme="modal")
    run = il.simulate(impact, grid, duration=duration, samples=8001)
    deflection, dissipation = strike(impact.beam, run.contact_force.values, duration, 80, 4000)
    assert run.midspan_deflection.max() == pytest.approx(deflection, rel=6e-3)
    assert run.plastic_dissipation == pytest.approx(dissipation, rel=2e-2)
