"""The comparison with the 3-D model in one call."""

from dataclasses import replace

import pytest

import impactlab as il
from impactlab.fem3d.solver import solve

IMPACT = il.paper_impact("1 m/s")
GRID = il.Discretisation(nodes=41)
pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")


def test_values_are_those_of_each_solver():
    models = il.witness(IMPACT, GRID, element_size="4 mm", duration="0.3 ms", workers=2)
    solid = solve(IMPACT, element_size=4e-3, duration=3e-4)
    timoshenko = il.simulate(replace(IMPACT, beam_model="timoshenko"), GRID, duration=3e-4)
    for name in ("peak_force", "maximum_indentation"):
        values = models.value.sel(response=name)
        assert values.sel(model="solid") == solid[name]
        assert values.sel(model="timoshenko") == timoshenko[name]
        share = float(timoshenko[name] / solid[name] - 1.0)
        difference = models.difference.sel(response=name, model="timoshenko").item()
        assert difference == pytest.approx(share)
    assert models.attrs == {"element_size": 4e-3, "duration": 3e-4}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"element_size": "2 mm", "patch": "2 mm", "duration": "0.1 ms"}, "take patch = "),
        ({"element_size": "0.01 mm"}, "of memory"),
        ({"element_size": "3 s"}, "witness.element_size"),
    ],
)
def test_runs_that_give_no_comparison_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        il.witness(il.paper_impact("5 m/s"), **arguments)
