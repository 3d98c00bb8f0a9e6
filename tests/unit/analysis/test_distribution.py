"""Distributions and exceedance probabilities of samples whose distributions are known."""

import csv

import numpy as np
import pytest
import scipy.stats
import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.analysis.distribution import (
    COLUMNS,
    PROBABILITIES,
    analysis,
    cumulative,
    drawn_outputs,
    table_rows,
)
from impactlab.files import write_csv
from impactlab.methods import NO_DISTRIBUTION, independent_runs
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import saltelli


def runs_of(inputs, outputs, limits=None, **attrs):
    """Return a Latin hypercube, or what attrs say, with these columns."""
    size = len(next(iter(outputs.values())))
    given = {"study": "synthetic", "method": "delta", "seed": 1, "varied": list(inputs)} | attrs
    given |= {"responses": list(outputs), "analyses": "distribution"}
    if limits:
        given |= {"limited": list(limits), "limits": list(limits.values())}
    variables = {name: ("run", np.array(each, float)) for name, each in outputs.items()}
    variables["status"] = ("run", np.zeros(size, int))
    coordinates = {name: ("run", np.asarray(each)) for name, each in inputs.items()}
    return xr.Dataset(variables, {"run": np.arange(size)} | coordinates, given)


def test_intervals_of_a_normal_cover_what_they_should():
    """100 samples of 200 draws; each interval misses about 5 of them, exact ones fewer."""
    random, limit = np.random.default_rng(8), 1.3
    names = [f"y{at}" for at in range(100)]
    outputs = {name: 3.0 + 0.5 * random.normal(size=200) for name in names}
    limits = dict.fromkeys(names, 3.0 + 0.5 * limit)
    found = analysis(runs_of({"x": np.arange(200.0)}, outputs, limits))
    exact = {
        "mean": 3.0,
        "standard_deviation": 0.5,
        "exceedance": scipy.stats.norm.sf(limit),
        "quantile": 3.0 + 0.5 * scipy.stats.norm.ppf(PROBABILITIES[1:-1]),  # 1 % has no lower end
    }
    inner = found.isel(probability=slice(1, -1))
    for name, value in exact.items():
        low, high = inner.get(f"{name}_low"), inner.get(f"{name}_high")
        if low is None or high is None:
            low, high = (inner[name] + sign * inner[f"{name}_interval"] for sign in (-1, 1))
        held = ((low <= value) & (value <= high)).mean("response")
        assert (held > 0.9).all()
        assert (held < 1.0).any(), "an interval that never misses is too wide"
    tests = (scipy.stats.quantile_test(outputs["y0"], p=p) for p in PROBABILITIES)
    ends = np.array([test.confidence_interval(0.95) for test in tests], float)
    both = [found[f"quantile_{end}"].sel(response="y0").values for end in ("low", "high")]
    np.testing.assert_array_equal(both, ends.T)
    bands = [cumulative(each, 0.95) for each in outputs.values()]
    normal = scipy.stats.norm(3.0, 0.5)
    inside = [
        (low <= normal.cdf(y)).all() and (high >= normal.cdf(y)).all() for y, _, low, high in bands
    ]
    assert 0.9 < np.mean(inside) < 1.0


def test_of_a_saltelli_sample_only_a_and_b_are_draws():
    drawn = saltelli(list("abc"), 64, True, 1)
    inputs = dict(zip("abc", drawn.T, strict=True))
    attrs = {"method": "sobol", "base_samples": 64, "second_order": 1, "replicates": 8}
    runs = runs_of(inputs, {"y": drawn.sum(axis=1)}, {"y": 2.0}, **attrs)
    rows = independent_runs(Sample.of(runs))
    assert rows.size == 2 * 64
    for column in inputs.values():  # every other run has a value in common with one of these
        assert np.unique(column[rows]).size == rows.size == np.unique(column).size
    found = analysis(runs)
    assert found["number_of_draws"].item() == rows.size
    # the sum of three uniforms is above 2 with a probability of 1/6
    assert found["exceedance_low"].item() < 1 / 6 < found["exceedance_high"].item()
    shuffled = runs.isel(run=np.random.default_rng(1).permutation(runs.sizes["run"]))
    xr.testing.assert_identical(analysis(shuffled), found)
    with pytest.raises(ValueError, match="solve it again"):
        analysis(runs.isel(run=slice(0, -1)))


@pytest.mark.parametrize(("above", "low", "high"), [(0, 0.0, 0.025), (90, 0.025, 1.0)])
def test_no_draw_or_every_draw_above_the_limit_has_its_bound(above, low, high):
    """P(0 of n) = (1 - p)^n is 2.5 % at the upper end."""
    outputs = np.arange(90.0)
    found = analysis(runs_of({"x": outputs}, {"y": outputs}, {"y": 89.5 - above}))
    ends = found["exceedance_low"].item(), found["exceedance_high"].item()
    bound = 1 - 0.025 ** (1 / 90)
    assert ends == pytest.approx((0.0, bound) if above == 0 else (1 - bound, 1.0))
    assert found["exceedance_probability"].item() == above / 90
    assert found["exceedance_distance"].isnull().all()


def test_missing_answers_are_counted_and_may_have_any_value():
    random = np.random.default_rng(3)
    whole = random.normal(size=400)
    gaps = whole > 1.2  # as an impact that is too fast: just those above the limit
    inputs = {"x": random.normal(size=400)}
    found = analysis(runs_of(inputs, {"y": np.where(gaps, np.nan, whole)}, {"y": 1.0}))
    assert found["missing_draws"].item() == gaps.sum() > 20
    above = (whole[~gaps] > 1.0).sum()
    assert found["exceedance_if_none"].item() == above / 400
    assert found["exceedance_if_all"].item() == (whole > 1.0).mean()
    assert found["exceedance_probability"].item() == above / (~gaps).sum()
    assert found["exceedance_low"].item() < above / 400 < found["exceedance_high"].item()
    for filled in (whole, np.where(gaps, -9.0, whole), np.where(gaps, 0.0, whole)):
        other = analysis(runs_of(inputs, {"y": filled}, {"y": 1.0}))
        for name in ("exceedance", "quantile"):
            for end, sign in (("low", 1), ("high", -1)):
                inner, outer = (each[f"{name}_{end}"].values for each in (other, found))
                assert (sign * (inner - outer) >= 0)[np.isfinite(outer)].all()
        _, _, low, high = cumulative(np.where(gaps, np.nan, whole), 0.95)
        shown = np.unique(whole[~gaps])
        share = (filled <= shown[:, None]).mean(axis=1)
        assert ((low <= share) & (share <= high)).all()
    empty = analysis(runs_of(inputs, {"y": np.full(400, np.nan)}, {"y": 1.0}))
    assert empty["missing_draws"].item() == 400
    assert empty["exceedance_probability"].isnull().all()
    assert empty["mean"].isnull().all()


def test_parameters_beyond_the_limit_of_a_known_sum():
    """x + y > 1.5 has P = 1/8, with x distributed as (2 x - 1)²: farthest from x at 5/8."""
    random = np.random.default_rng(2)
    x, y, z = random.random((3, 40_000))
    words = np.where(x > 0.75, "late", "early")
    inputs = {"x": x, "minus": -y, "word": words, "z": z}
    found = analysis(runs_of(inputs, {"sum": x + y, "other": z}, {"sum": 1.5}))
    one = found.sel(response="sum")
    assert one["exceedance_distance"].values[:2] == pytest.approx(9 / 16 / (7 / 8), abs=0.02)
    assert one["exceedance_direction"].values[:3].tolist() == [1, -1, 0]
    # "late" has a share of 3/4 of those above, of 1/4 - 3/32 over 7/8 of the others
    assert one["exceedance_distance"].values[2] == pytest.approx(3 / 4 - 5 / 28, abs=0.02)
    p_values = one["exceedance_p_value"].values
    assert (p_values[:3] < 1e-9).all()
    assert p_values[3] > 0.01
    assert found.sel(response="other")["exceedance_distance"].isnull().all()


def test_a_parameter_that_does_not_matter_is_significant_as_often_as_stated():
    random = np.random.default_rng(5)
    inputs = {f"x{at}": random.random(300) for at in range(100)}
    found = analysis(runs_of(inputs, {"y": random.normal(size=300)}, {"y": 1.5}))
    share = (found["exceedance_p_value"] < 0.2).mean().item()
    assert share == pytest.approx(0.2, abs=0.12)


@pytest.mark.parametrize("method", NO_DISTRIBUTION)
def test_designs_that_are_no_draws_have_no_distribution(method):
    runs = runs_of({"x": np.arange(80.0)}, {"y": np.arange(80.0)}, method=method)
    assert "quantile" not in analyse(runs)
    assert "quantile" in analyse(runs.assign_attrs(method="pawn"))


def test_the_table_has_every_number(tmp_path):
    random = np.random.default_rng(2)
    x = random.normal(size=200)
    runs = runs_of({"x": x, "z": random.normal(size=200)}, {"y": x, "w": -x}, {"y": 1.0})
    found = analyse(runs)
    write_csv(table_rows(found), COLUMNS, tmp_path / "distribution.csv")
    with (tmp_path / "distribution.csv").open(newline="", encoding="utf-8") as file:
        rows = {(row["response"], row["quantity"], row["at"]): row for row in csv.DictReader(file)}
    assert len(rows) == 2 * (2 + len(PROBABILITIES)) + 3 + 3 * 2
    row = rows["y", "exceedance_probability", "1.0"]
    assert float(row["value"]) == (x > 1.0).mean() == drawn_outputs(runs, "y").__gt__(1.0).mean()
    assert float(row["high"]) == found["exceedance_high"].sel(response="y")
    row = rows["w", "quantile", "0.05"]
    assert float(row["low"]) < float(row["value"]) == np.quantile(-x, 0.05) < float(row["high"])
    assert (row["draws"], row["missing"]) == ("200", "0")
    assert rows["y", "exceedance_direction", "x"]["value"] == "1.0"


@pytest.mark.parametrize(("where", "share"), [("anywhere", 0.0), ("upper end", 1.0)])
def test_draws_missing_at_some_values_of_a_parameter_carry_a_warning(where, share, tmp_path):
    """The mean of x alone is too low where its upper end fails; a false alarm is one in twenty."""
    random, verdicts = np.random.default_rng(4), []
    for _ in range(40):
        x, other = random.random((2, 200))
        failed = x > 0.93 if where == "upper end" else random.random(200) < 0.07
        found = analysis(runs_of({"x": x, "other": other}, {"y": np.where(failed, np.nan, x)}))
        verdicts.append(found["distribution_verdict"].item())
    assert np.mean(np.array(verdicts) == 2) == pytest.approx(share, abs=0.1)
    write_csv(table_rows(found), COLUMNS, tmp_path / "distribution.csv")
    with (tmp_path / "distribution.csv").open(encoding="utf-8") as file:
        written = {row["verdict"] for row in csv.DictReader(file)}
    assert written == {"selected" if where == "upper end" else "missing"}
