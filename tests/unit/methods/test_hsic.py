"""HSIC: zero of independent parameters, exact by definition, and that of the limit beside it."""

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.methods import hsic
from impactlab.methods.record import SensitivityVerdict
from impactlab.methods.runs import Sample


def sample_of(inputs, seed, **attributes):
    columns = {f"x{i}": ("run", column) for i, column in enumerate(inputs.T)}
    attrs = {"varied": list(columns), "seed": seed, "method": "hsic", "resamples": 30}
    runs = xr.Dataset(coords={"run": np.arange(len(inputs)), **columns}, attrs=attrs | attributes)
    return Sample.of(runs)


@pytest.mark.parametrize("runs", [64, 128])
def test_intervals_cover_and_independence_is_rejected_rarely(runs):
    """Against the mean over 200 samples, which has no bias of noise; x1 is independent."""
    rows = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        inputs = rng.normal(size=(runs, 2))
        outputs = inputs[:, 0] ** 2 + 0.5 * rng.normal(size=runs)
        rows.append(hsic.INDICES.estimate(outputs, sample_of(inputs, seed), "y"))
    values = np.array([row["hsic"] for row in rows])
    margins = np.array([row["hsic_interval"] for row in rows])
    p_values = np.array([row["hsic_p_value"] for row in rows])
    covered = np.abs(values - [values[:, 0].mean(), 0.0]) <= margins
    assert covered.mean(axis=0).min() >= 0.92
    assert abs(values[:, 1].mean()) < 3 * values[:, 1].std() / np.sqrt(200)
    rejected = np.mean(p_values <= 0.05, axis=0)
    assert rejected[0] > 0.9
    assert rejected[1] < 0.09  # 0.05, and 2.6 standard errors


def test_target_indices_are_those_of_the_limit(tmp_path):
    """Only with `a` above 0.9 is it exceeded; `b` has most of the variance."""
    uniform = il.Uniform(0.0, 1.0)

    def study(**stated):
        sampling = il.Latin(
            samples=256, indices=["hsic", "target_hsic"], parameters={"a": uniform, "b": uniform}
        )
        return il.Study(
            title="Limit",
            function=lambda a, b: np.where(a > 0.9, 1.5, 0.0) + 2.0 * b,
            sampling=sampling,
            results=tmp_path,
            **stated,
        )

    indices = il.analyse(study(limits={"value": 2.0}).run(workers=1)).squeeze()
    a, b = indices.hsic.sel(parameter="a"), indices.hsic.sel(parameter="b")
    assert b > 2.0 * a
    assert indices.target_hsic.sel(parameter="a") > 3.0 * indices.target_hsic.sel(parameter="b")
    assert indices.target_hsic_p_value.sel(parameter="a") < 0.01
    with pytest.raises(il.StudyError, match=r"sampling\.indices: target_hsic needs `limits`"):
        study()


@pytest.mark.parametrize("limited", [{"z": 0.0}, {"y": 9.0}])
def test_a_response_without_runs_beyond_a_limit_has_no_target_index(limited):
    inputs = np.random.default_rng(1).uniform(size=(64, 2))
    sample = sample_of(inputs, 1, limited=list(limited), limits=list(limited.values()))
    indices = hsic.TARGET.estimate(inputs[:, 0], sample, "y")
    assert np.isnan(indices["target_hsic"]).all()
    assert hsic.TARGET.judge(indices) == [SensitivityVerdict.NO_LIMIT]
