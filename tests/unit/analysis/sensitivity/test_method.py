"""Resampling by counts: every row as likely as any other, whatever is held at a time."""

import numpy as np
import pytest
import xarray as xr

from impactlab.methods import runs
from impactlab.methods.runs import Sample


def _sample(resamples, confidence=0.95):
    given = {"varied": ["x0"], "resamples": resamples, "confidence": confidence, "seed": 0}
    return Sample.of(xr.Dataset(coords={"x0": ("run", [0.0]), "run": [0]}, attrs=given))


def test_counts_are_multinomial():
    """Mean 1, variance 1 - 1/rows, and rows in all."""
    tallies = np.concatenate(list(runs.counts(50, 4000, np.random.default_rng(1))))
    assert tallies.shape == (4000, 50)
    np.testing.assert_array_equal(tallies.sum(axis=1), 50)
    np.testing.assert_allclose(tallies.mean(axis=0), 1.0, atol=0.07)
    np.testing.assert_allclose(tallies.var(axis=0), 0.98, atol=0.1)


def test_chunks_change_nothing(monkeypatch):
    whole = np.concatenate(list(runs.counts(7, 20, np.random.default_rng(1))))
    monkeypatch.setattr(runs, "_CELLS", 21)
    parts = list(runs.counts(7, 20, np.random.default_rng(1)))
    assert [len(part) for part in parts] == [3] * 6 + [2]
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    monkeypatch.setattr(runs, "_CELLS", 5)
    assert [len(part) for part in runs.counts(7, 3, np.random.default_rng(1))] == [1, 1, 1]


@pytest.mark.parametrize(("confidence", "quantile"), [(0.95, 1.959964), (0.68, 0.994458)])
def test_half_width_of_a_mean(confidence, quantile):
    """The quantile times the standard error of the mean."""
    rows = np.random.default_rng(2).normal(size=(400, 1))

    def mean(means):
        return {"mean": means[..., 0]}

    sample = _sample(4000, confidence)
    found = runs.half_widths(rows, mean, sample, "y")
    expected = quantile * rows.std() / np.sqrt(400)
    np.testing.assert_allclose(found["mean_interval"], expected, rtol=0.04)
