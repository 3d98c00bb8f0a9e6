"""Blocks of a sample: the same bits as the whole, and of large samples without the others."""

import itertools
import json

import numpy as np
import pytest

from impactlab.methods import hypercube
from impactlab.methods.sampling import DRAWN_TOGETHER
from impactlab.study.design import design
from impactlab.study.schema.readers import study_of_text
from impactlab.validation.errors import StudyError

NUMBERS = {
    "beam_depth": {"distribution": "uniform", "low": 0.02, "high": 0.03},
    "beam_width": {"distribution": "log_uniform", "low": 0.05, "high": 0.07},
    "velocity": {"distribution": "lognormal", "median": 2, "geometric_standard_deviation": 1.2},
    "beam_span": {
        **{"distribution": "truncated_normal", "mean": 1.0, "standard_deviation": 0.1},
        **{"low": 0.9, "high": 1.2},
    },
    "gravity": {"distribution": "triangular", "low": 5, "mode": 6, "high": 10},
}
ENDED = {name: entry for name, entry in NUMBERS.items() if name != "velocity"}
WORDS = NUMBERS | {"contact": {"distribution": "choice", "values": ["mjg", "brake"]}}
MATERIAL = {
    f"{body}_{name}": {"distribution": "uniform", "low": low, "high": 1.01 * low}
    for body in ("beam", "sphere")
    for name, low in {"density": 7800, "youngs_modulus": 2e11, "yield_stress": 3e9}.items()
}
PAIRS = {"correlations": [["beam_depth", "beam_width", 0.5]]}
SAMPLES = [
    {"method": "sobol", "base_samples": 4, "parameters": NUMBERS},
    {"method": "sobol", "base_samples": 64, "parameters": WORDS},
    {"method": "sobol", "base_samples": 64, "second_order": False, "parameters": NUMBERS},
    {"method": "morris", "trajectories": 20, "parameters": ENDED},
    {"method": "fast", "samples": 1800, "parameters": NUMBERS},
    {"method": "delta", "samples": 501, "parameters": WORDS},
    {"method": "delta", "samples": 501, "parameters": NUMBERS} | PAIRS,
    {
        "method": "grid",
        "parameters": {"velocity": [1, 2, 3], "nodes": [11, 21], "contact": ["mjg", "brake"]},
    },
]


def study(sampling):
    whole = {"title": "-", "impact": {"base": "paper"}, "duration": 5e-4, "sampling": sampling}
    return study_of_text("some", json.dumps(whole))


@pytest.mark.parametrize("sampling", SAMPLES, ids=lambda entry: str(entry["method"]))
@pytest.mark.parametrize("large", [False, True])
def test_blocks_are_the_whole(sampling, large, monkeypatch):
    """In order, as parts draw them, and in any other; large samples in their own way."""
    if large:
        if sampling.get("correlations"):
            pytest.skip("correlations are those of all runs together")
        monkeypatch.setattr(hypercube, "DRAWN_TOGETHER", 0)
    whole, blocked = (study(sampling).sampling for _ in range(2))
    columns, runs = whole.columns(), whole.runs
    if sampling["method"] == "grid":
        columns = blocked.columns()
        grid = np.meshgrid(*map(np.array, whole.parameters.values()), indexing="ij")
        columns = {name: values.ravel() for name, values in zip(columns, grid, strict=True)}
    cuts = [0, 1, 7, runs // 2, runs - 1, runs]
    blocks = list(itertools.pairwise(cuts))
    for start, stop in [*blocks, *reversed(blocks)]:
        block = blocked.columns(start, stop)
        assert [*block] == [*columns]
        for name, values in columns.items():
            assert block[name].dtype == values.dtype
            assert block[name].tobytes() == values[start:stop].tobytes(), (name, start)


@pytest.mark.parametrize("sampling", [SAMPLES[1], SAMPLES[-1]])
def test_a_design_in_blocks(sampling):
    whole, block = design(study(sampling)), design(study(sampling), 3, 9)
    assert block.attrs == whole.attrs
    runs = np.arange(3, 9)
    assert np.array_equal(block["run"], runs)
    if "run" in whole.dims:
        assert block.identical(whole.isel(run=runs))
    else:
        stacked = whole.stack(run=whole.attrs["varied"])
        for name in whole.attrs["varied"]:
            assert np.array_equal(block[name], stacked[name][runs])


def test_a_block_late_in_a_large_sample_is_drawn_alone():
    """A billion runs have 24 GB: no block draws the others."""
    for method, size in (
        ("sobol", {"base_samples": 2**27, "second_order": False}),
        ("delta", {"samples": 10**9}),
        ("fast", {"samples": 2 * 10**8}),
    ):
        sampling = study({"method": method, "parameters": NUMBERS, **size}).sampling
        runs = sampling.runs
        assert runs > 9e8
        values = sampling.columns(runs - 1000, runs)["beam_depth"]
        assert values.size == 1000
        assert ((values > 0.02) & (values < 0.03)).all()


def test_a_large_hypercube_has_one_value_per_stratum(monkeypatch):
    monkeypatch.setattr(hypercube, "DRAWN_TOGETHER", 0)
    for runs in (500, 1024, 1025):
        sampling = study({"method": "delta", "samples": runs, "parameters": NUMBERS}).sampling
        strata = np.floor(sampling.draws() * runs).astype(int)
        for column in strata.T:
            assert np.array_equal(np.sort(column), np.arange(runs))
        others = np.corrcoef(strata.T)[np.triu_indices(len(NUMBERS), 1)]
        assert (np.abs(others) < 4 / np.sqrt(runs)).all()
        neighbours = [np.corrcoef(column[1:], column[:-1])[0, 1] for column in strata.T]
        assert (np.abs(neighbours) < 4 / np.sqrt(runs)).all()


def test_samples_drawn_together_have_a_limit():
    study(SAMPLES[-2] | {"samples": DRAWN_TOGETHER})
    for large in (
        SAMPLES[-2] | {"samples": DRAWN_TOGETHER + 1},
        SAMPLES[3] | {"trajectories": 10**6, "parameters": ENDED | MATERIAL},
    ):
        with pytest.raises(StudyError, match="10,000,000 or fewer, for they are drawn together"):
            study(large)
