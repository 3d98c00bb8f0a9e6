"""Whole numbers and steps in samples: probabilities, indices, and what takes none."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtri

import impactlab as il
from impactlab.methods.distributions import distribution_of
from impactlab.model.case_table import case_table
from impactlab.solve import solve

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


def test_steps_are_drawn_equally_often_and_to_the_ends():
    steps = distribution_of({"distribution": "steps", "low": 0.1, "high": 0.7, "step": 0.2})
    values, counts = np.unique(steps.quantile((np.arange(400) + 0.5) / 400), return_counts=True)
    assert values.tolist() == pytest.approx([0.1, 0.3, 0.5, 0.7])
    assert counts.tolist() == [100] * 4
    assert (values[0], values[-1]) == (0.1, 0.7)
    assert steps.cumulative(values).tolist() == [0.25, 0.5, 0.75, 1.0]
    assert steps.quantile([0.0, 1.0]).tolist() == [0.1, 0.7]


def test_very_many_numbers_take_no_memory(tmp_path):
    attributes = {"distribution": "integers", "low": 0, "high": 10**15, "step": 1}
    assert distribution_of(attributes).quantile([0.25, 1.0]).tolist() == [10**15 // 4, 10**15]
    parameters = {"n": il.Integers(0, 10**15), "x": il.Uniform(0, 1)}
    sampling = il.Sobol(base_samples=8, parameters=parameters)
    study = il.Study(title="Many", function=lambda n, x: n * x, sampling=sampling, results=tmp_path)
    assert study.design()["n"].dtype.kind == "i"


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


def test_places_of_the_strike_are_drawn_on_nodes(tmp_path):
    """A beam with equal ends struck at s answers as one struck at 1 - s."""
    impact = il.paper_impact("1 m/s")
    beam = replace(impact.beam, support_left="clamped", support_right="clamped")
    parameters = {"strike_position": il.Steps(0.3, 0.7, 0.1), "velocity": il.Uniform(0.5, 1.5)}
    options = {
        "impact": replace(impact, beam=beam),
        "discretisation": il.Discretisation(nodes=21, points=3, scheme="modal"),
        "duration": "0.5 ms",
        "responses": ["peak_force"],
        "results": tmp_path,
    }
    sampling = il.Sobol(base_samples=16, parameters=parameters, second_order=False)
    study = il.Study(title="Places", sampling=sampling, **options)
    study.to_yaml(tmp_path / "places.yaml")
    assert il.Study.from_yaml(tmp_path / "places.yaml").declared.sampling.varied == parameters
    runs = study.run(workers=1)
    places, velocities = runs["strike_position"].values, runs["velocity"].values
    assert np.unique(places).tolist() == pytest.approx([0.3, 0.4, 0.5, 0.6, 0.7])
    mirrored = {"strike_position": (1.0 - places).round(9), "velocity": velocities}
    cases = case_table(
        options["impact"], options["discretisation"], duration=0.0005, varied=mirrored
    )
    assert runs["peak_force"].values == pytest.approx(solve(cases)["peak_force"], rel=1e-8)
    for parameters["strike_position"], reason in (
        (il.Uniform(0.3, 0.7), "write {distribution: steps"),
        (il.Steps(0.3, 0.7, 0.02), "0.32 lies between two of the 21 nodes"),
    ):
        with pytest.raises(il.StudyError, match=reason):
            il.Study(title="Between", sampling=replace(sampling, parameters=parameters), **options)


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
