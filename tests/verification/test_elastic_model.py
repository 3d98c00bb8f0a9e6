"""The elastic model is the paper's beam with a yield stress out of reach, and no other."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.solver import SCHEMES
from impactlab.variables import HISTORIES, RESPONSES
from impactlab.verification.cases import elastic

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

GRID = il.Discretisation(nodes=51, points=9)
GRIDS = [replace(GRID, scheme=scheme) for scheme in SCHEMES]


@pytest.mark.parametrize("grid", GRIDS, ids=SCHEMES)
@pytest.mark.parametrize("velocity", [0.99, 20.0])
def test_elastic_model_is_a_beam_that_does_not_yield(velocity, grid):
    impact = il.paper_impact(velocity, "hertz")  # Stronge's law would know the yield stress
    ours = il.simulate(replace(impact, beam_model="elastic"), grid, duration=2e-3)
    expected = il.simulate(elastic(impact), grid, duration=2e-3)
    for name in (*HISTORIES, *RESPONSES):
        np.testing.assert_allclose(ours[name], expected[name], rtol=1e-12, err_msg=name)
    yielding = il.simulate(impact, grid, duration=2e-3)
    assert (yielding.plastic_dissipation.item() > 0) == (velocity > 1.0)
    assert ours.plastic_dissipation.item() == 0
