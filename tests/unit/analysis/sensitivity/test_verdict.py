"""Verdicts on made-up cases, and the policies for failed runs."""

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from impactlab.analysis import sensitivity
from impactlab.analysis.analyse import analyse
from impactlab.methods import record
from impactlab.methods.saltelli import saltelli

NAMES = ["x0", "x1", "x2"]
BASE = 512


@pytest.fixture(scope="module")
def unit():
    return saltelli(NAMES, BASE, True, 7)


def _verdict(drawn, read, unit, outputs, **attrs):
    runs = drawn("sobol", unit, outputs, base_samples=BASE, second_order=1, **attrs)
    return str(read(sensitivity.analysis(runs)["sensitivity_verdict"])[0])


def _remarks(found):
    """Return the verdict on the first response, by CF alone."""
    array = found["sensitivity_remarks"]
    pairs = zip(array.attrs["flag_masks"], array.attrs["flag_meanings"].split(), strict=True)
    return {name for mask, name in pairs if int(array[0]) & mask}


def test_usable(drawn, verdicts_of, unit):
    assert _verdict(drawn, verdicts_of, unit, unit @ [1.0, 1.0, 1.0]) == "usable"
    runs = drawn("sobol", unit, unit @ [1.0, 1.0, 1.0], base_samples=BASE, second_order=1)
    assert _remarks(sensitivity.analysis(runs)) == set()


def test_jumps(drawn, verdicts_of, unit):
    """A number of contacts."""
    unit = unit[: 64 * 8]
    outputs = np.floor(unit @ [2.0, 0.5, 0.5])
    runs = drawn("sobol", unit, outputs, base_samples=64, second_order=1)
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["wide_intervals"]  # the graver of two
    assert _remarks(found) == {"jumps", "wide_intervals"}
    assert np.isfinite(found["first_order"]).all()  # shown as what they are


def test_few_runs_carry_the_variance(drawn, verdicts_of, unit):
    outputs = np.exp(3.5 * norm.ppf(np.clip(unit[:, 0], 1e-4, 1 - 1e-4)) + unit[:, 1])
    runs = drawn("sobol", unit, outputs, base_samples=BASE, second_order=1)
    assert _remarks(sensitivity.analysis(runs)) >= {"few_runs_carry_it"}
    assert not record.of_outputs(norm.ppf(unit[:, 0].clip(1e-4, 1 - 1e-4)), [unit[:, 0]], 0.0)


def test_a_part_that_all_but_stands_still_is_constant():
    """Its variance, by which indices are divided, is nothing beside that of the whole."""
    part, rest = np.array([0.0, 1e-5, 0.0, 1e-5]), np.array([-1.0, 1.0, -1.0, 1.0])
    assert record.still(np.concatenate([part, rest]), [part])
    assert not record.still(np.concatenate([part, rest]), [rest])
    assert not record.still(np.concatenate([100 * part, rest]), [100 * part])


def _found(first, total, margin):
    first, total = np.array(first), np.array(total)
    margins = {f"{name}_interval": 0 * first + margin for name in ("first_order", "total_order")}
    return {"first_order": first, "total_order": total} | margins


@pytest.mark.parametrize(
    ("first", "total", "margin", "name"),
    [
        ([0.5, 0.5], [0.5, 0.5], 0.05, "USABLE"),
        ([0.5, 0.55], [0.6, 0.6], 0.03, "USABLE"),
        ([0.6, 0.6], [0.6, 0.6], 0.03, "INCONSISTENT"),
        ([0.5, -0.05], [0.6, 0.0], 0.03, "USABLE"),
        ([0.5, -0.05], [0.6, 0.0], 0.02, "INCONSISTENT"),
        ([0.5, 0.2], [0.4, 0.3], 0.03, "USABLE"),
        ([0.5, 0.2], [0.4, 0.3], 0.02, "INCONSISTENT"),
        ([0.5, 0.2], [0.5, 0.3], 0.11, "WIDE_INTERVALS"),
        ([0.5, 0.2], [0.5, 0.3], np.nan, "WIDE_INTERVALS"),
    ],
)
def test_shares_that_contradict_themselves(first, total, margin, name):
    said = record.of_orders(_found(first, total, margin))
    assert [entry.name for entry in said] == [name] * (name != "USABLE")


def _broken(drawn, unit, share, **attrs):
    """A part of the runs failed, a fifth response; the other response is whole."""
    outputs = np.sin(3 * unit[:, 0]) + unit[:, 1] * unit[:, 2]
    gaps = outputs.copy()
    gaps[np.random.default_rng(1).random(len(unit)) < share] = np.nan
    named = {"peak_force": gaps, "impulse": outputs}
    return drawn("sobol", unit, named, base_samples=BASE, second_order=1, **attrs)


def test_imputed_runs_are_marked(drawn, verdicts_of, unit):
    runs = _broken(drawn, unit, 0.05, failed_runs="impute")
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["imputed", "usable"]
    assert "imputed" not in found["sensitivity_verdict"].attrs["sound_flags"].split()
    missing = float(np.isnan(runs["peak_force"]).mean())
    np.testing.assert_allclose(found["imputed_share"], [missing, 0], rtol=1e-12)
    assert missing > 0.03
    for name in ("first_order", "total_order"):  # the truth is known here
        np.testing.assert_allclose(found[name][0], found[name][1], atol=0.01)


def test_too_few_runs_to_impute(drawn, verdicts_of, unit):
    runs = _broken(drawn, unit, 0.25, failed_runs="impute")
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["too_few_runs", "usable"]
    assert np.isnan(found["first_order"][0]).all()
    assert found["imputed_share"][0] == 0


@pytest.mark.parametrize("where", ["anywhere", "where a parameter is large"])
def test_a_surrogate_that_misses_more_than_a_tenth_supplies_nothing(
    drawn, verdicts_of, unit, where
):
    outputs = unit[:, 0] + 0.4 * np.sin(40 * unit[:, 0] * (1 + unit[:, 1]))
    failed = np.random.default_rng(1).random(len(unit)) < 0.1
    failed = failed if where == "anywhere" else unit[:, 0] > 0.92
    named = {"peak_force": np.where(failed, np.nan, outputs)}
    attrs = {"base_samples": BASE, "second_order": 1, "failed_runs": "impute"}
    found = sensitivity.analysis(drawn("sobol", unit, named, **attrs))
    assert verdicts_of(found["sensitivity_verdict"]) == ["poor_surrogate"]
    assert np.isnan(found["total_order"]).all()
    assert found["imputed_share"].item() == 0


def test_supplied_values_widen_the_interval_of_an_inert_parameter(drawn, unit):
    """Their errors differ between near-copies of a run, which an inert parameter never does."""
    outputs = unit[:, 0] + 0.6 * unit[:, 1] + 0.15 * np.sin(9 * unit[:, 0] * (1 + unit[:, 1]))
    failed = np.random.default_rng(2).random(len(unit)) < 0.1
    named = {"peak_force": np.where(failed, np.nan, outputs), "impulse": outputs}
    attrs = {"base_samples": BASE, "second_order": 1, "failed_runs": "impute"}
    found = sensitivity.analysis(drawn("sobol", unit, named, **attrs))
    inert = found.isel(parameter=2, response=0)
    assert 0 < inert["total_order"] < inert["total_order_interval"]
    assert found["total_order"].isel(parameter=2, response=1).item() == pytest.approx(0, abs=1e-12)


def test_imputing_without_a_gap_changes_nothing(drawn, unit):
    kept = sensitivity.analysis(_broken(drawn, unit, 0.0))
    xr.testing.assert_equal(
        kept, sensitivity.analysis(_broken(drawn, unit, 0, failed_runs="impute"))
    )


@pytest.mark.parametrize("method", ["sobol", "morris", "fast", "delta", "pawn", "regression"])
def test_constants_and_failures_of_every_method(drawn, verdicts_of, method):
    """A seeded failure, one constant response, one NaN without a reason: SALib sees none."""
    unit = np.tile(np.tril(np.ones((4, 3)), -1), (64, 1))  # trajectories for Morris
    number = 252 if method == "fast" else 256
    unit = unit if method == "morris" else np.random.default_rng(1).random((number, 3))
    good = unit @ [3.0, 2.0, 1.0] + 0.1 * unit[:, 0] * unit[:, 1]
    gap = good.copy()
    gap[17] = np.nan
    named = {"peak_force": gap, "impulse": 0 * good + 7.0, "contact_duration": good}
    attrs = {"base_samples": 64, "second_order": 0, "levels": 4}
    attrs |= {"harmonics": 3, "curves": 12, "frequency": 3}
    attrs |= {"trajectories": 64, "resamples": 5}
    if method == "sobol":
        unit, named = unit[:, :2], {name: values for name, values in named.items()}
    runs = drawn(method, unit, named, **attrs)
    runs["status"][3] = 2  # first contact unfinished
    found = analyse(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["failed_runs", "constant", "failed_runs"]
    for name, array in found.data_vars.items():
        if "parameter" in array.dims or str(name).startswith("dummy"):
            assert np.isnan(array).all()
            assert array.attrs["estimator"]


@pytest.mark.parametrize("method", ["fast", "delta", "pawn", "regression"])
def test_mostly_constant_responses_break_nothing(drawn, verdicts_of, method):
    """Resamples of them may not vary at all."""
    unit = np.random.default_rng(1).random((252, 3))
    outputs = np.zeros(252)
    outputs[[5, 70, 133, 200]] = 1.0
    curves = {"harmonics": 3, "curves": 12, "frequency": 3}
    found = sensitivity.analysis(drawn(method, unit, outputs, **curves))
    worst = "no_density" if method == "delta" else "mostly_constant"
    assert verdicts_of(found["sensitivity_verdict"]) == [worst]
