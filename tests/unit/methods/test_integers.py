"""Whole numbers in samples: exact probabilities, indices of a product, and what takes none."""

import numpy as np
import pytest
from scipy.special import ndtri

import impactlab as il
from impactlab.methods.distributions import distribution_of

ATTRIBUTES = {"distribution": "integers", "low": 3, "high": 11, "step": 2}
NUMBERS = [3, 5, 7, 9, 11]
PARAMETERS = {"n": il.Integers(1, 4), "x": il.Uniform(0, 1)}


def total(n, x):
    return sum(x for _ in range(n))  # needs an int


@pytest.fixture
def study(tmp_path):
    sampling = il.Sobol(base_samples=256, parameters=PARAMETERS)
    return il.Study(title="Product", function=total, sampling=sampling, results=tmp_path)


def test_each_number_has_its_share_of_the_probabilities():
    integers = distribution_of(ATTRIBUTES)
    edges = np.arange(1, 5) / 5
    assert integers.quantile(edges - 1e-9).tolist() == NUMBERS[:-1]
    assert integers.quantile(edges + 1e-9).tolist() == NUMBERS[1:]
    assert integers.quantile([0.1, 0.5, 2**-31, 1 - 2**-31]).tolist() == [3, 7, 3, 11]
    assert integers.at_scores(ndtri([0.1, 0.3, 0.5, 0.7, 0.9])).tolist() == NUMBERS
    shares = integers.cumulative([2, 3, 4, 5, 11, 12])
    assert shares == pytest.approx([0.0, 0.2, 0.2, 0.4, 1.0, 1.0])


def test_a_sample_draws_each_number_equally_often(study):
    numbers, counts = np.unique(study.design()["n"].values, return_counts=True)
    assert numbers.dtype.kind == "i"
    assert numbers.tolist() == [1, 2, 3, 4]
    assert counts == pytest.approx(study.design().sizes["run"] / 4, rel=0.02)


def test_indices_are_those_of_the_product(study):
    """With y = n x: Var n = 5/4, Var x = 1/12, and their means 5/2 and 1/2."""
    indices = il.analyse(study.run(workers=1))
    variance = (5 / 4 + 25 / 4) * (1 / 12 + 1 / 4) - (5 / 4) ** 2
    n, x = 5 / 4 / 4 / variance, 25 / 4 / 12 / variance
    for name, exact in {"first_order": [n, x], "total_order": [1 - x, 1 - n]}.items():
        values, intervals = indices[name].values[0], indices[f"{name}_interval"].values[0]
        assert (np.abs(values - exact) < 2 * intervals).all()
        assert (intervals < 0.06).all()
    assert "surrogate" not in " ".join(map(str, indices.data_vars))


def test_the_dents_of_sampled_strikes_are_those_of_grids(tmp_path):
    options = {"impact": il.paper_impact("5 m/s"), "duration": "10 ms", "results": tmp_path}
    options |= {"discretisation": il.Discretisation(nodes=21, points=3, scheme="modal")}
    options |= {"responses": ["permanent_indentation"]}
    parameters = {"strikes": il.Integers(1, 3), "beam_depth": il.Uniform("26 mm", "29 mm")}
    sampling = il.Sobol(base_samples=8, second_order=False, parameters=parameters)
    study = il.Study(title="Strikes", sampling=sampling, **options)
    study.to_yaml(tmp_path / "strikes.yaml")
    assert il.Study.from_yaml(tmp_path / "strikes.yaml").declared.sampling.varied == (
        study.declared.sampling.varied
    )
    runs = study.run(workers=1)
    assert runs.sizes["strike"] == 3
    (last,) = np.flatnonzero(runs.strikes.values == 3)[:1]
    grid = il.Grid(parameters={"strikes": [1, 3], "beam_depth": [runs.beam_depth[last].item()]})
    alone = il.Study(title="Alone", sampling=grid, **options).run(workers=1)
    assert runs.permanent_indentation[last] == alone.permanent_indentation.values[-1, 0]
    assert alone.permanent_indentation.values[-1] > alone.permanent_indentation.values[0]


def test_methods_that_need_distinct_values_and_refinement_refuse_them(tmp_path):
    for sampling in (
        il.Delta(samples=64, parameters=PARAMETERS),
        il.Morris(trajectories=4, parameters=PARAMETERS),
    ):
        with pytest.raises(il.StudyError, match="which method sobol alone does"):
            il.Study(title="No", function=total, sampling=sampling)
    parameters = {"nodes": il.Integers(21, 41, step=20), "beam_depth": il.Uniform(0.026, 0.029)}
    study = il.Study(
        title="Nodes",
        impact=il.paper_impact(),
        duration="0.3 ms",
        responses=["peak_force"],
        sampling=il.Sobol(base_samples=8, second_order=False, parameters=parameters),
        results=tmp_path,
    )
    study.run(workers=1)
    with pytest.raises(ValueError, match="draws its nodes, so there is no grid to refine"):
        study.refine(workers=1)
