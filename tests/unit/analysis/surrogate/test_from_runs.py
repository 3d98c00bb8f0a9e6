"""Surrogates of whole samples: Ishigami's indices, and what must not pass in silence."""

import numpy as np
import pytest
from known_indices import INDICES

from impactlab.analysis import ANALYSES
from impactlab.analysis.analyse import analyse
from impactlab.analysis.surrogate import analysis

KNOWN = INDICES["ishigami"]
ishigami = KNOWN.of_unit


def smooth(unit):
    return 1e4 * np.exp(unit[:, 0]) * (1 + unit[:, 1])


@pytest.fixture
def ishigami_found(drawn_runs):
    return analysis(drawn_runs(base_samples=256, peak_force=ishigami))


def test_ishigami_within_the_stated_intervals(ishigami_found):
    for name in ("first_order", "total_order"):
        found = ishigami_found[f"surrogate_{name}"].values[0]
        half_width = ishigami_found[f"surrogate_{name}_interval"].values[0]
        assert (np.abs(found - getattr(KNOWN, name)) <= half_width).all()
        assert (half_width < 0.01).all()  # an interval wide enough for anything proves nothing
    assert ishigami_found["surrogate_q2"].values[0] > 0.999


def test_errors_are_those_of_the_runs_held_out(drawn_runs):
    runs = drawn_runs(peak_force=ishigami)
    found = analysis(runs)
    computed = runs["peak_force"].sel(run=found["held_out"].values).values
    error = found["surrogate_held_out"].values[0] - computed
    assert error.any()
    rmse, q2 = np.sqrt(np.mean(error**2)), 1 - np.mean(error**2) / np.var(computed)
    assert found["surrogate_rmse"].values[0] == pytest.approx(rmse, rel=1e-12)
    assert found["surrogate_q2"].values[0] == pytest.approx(q2, rel=1e-12)
    assert found["surrogate_runs"].values[0] == found.sizes["held_out"] == runs.sizes["run"]


def test_noise_lowers_the_predictivity_and_widens_the_intervals(drawn_runs):
    """Noise of a share s of the variance: no model can predict more than 1 - s."""
    noise = np.random.default_rng(0).standard_normal(64 * 8)

    def with_noise(share):
        def answer(unit):
            clean = smooth(unit)
            return clean + np.sqrt(share / (1 - share)) * clean.std() * noise

        return answer

    found = analysis(
        drawn_runs(peak_force=smooth, impulse=with_noise(0.05), restitution=with_noise(0.5))
    )
    q2 = found["surrogate_q2"].values
    assert q2[0] > 0.99999
    np.testing.assert_allclose(q2[1:], [0.95, 0.5], atol=0.1)
    widths = found["surrogate_first_order_interval"].sel(parameter="velocity").values
    assert widths[0] < widths[1] < widths[2]


def test_responses_that_need_care_say_so(drawn_runs, verdicts_of):
    noise = np.random.default_rng(0).standard_normal(64 * 8)
    runs = drawn_runs(
        peak_force=smooth,
        number_of_contacts=lambda u: np.floor(1 + 3 * u[:, 0]),
        remote_plastic_strain=lambda u: np.maximum(u[:, 0] - 0.95, 0),
        peak_plastic_strain=lambda u: 345e6 * (1 + 1e-12 * np.sign(u[:, 0] - 0.5)),
        impulse=lambda u: noise,
        restitution=smooth,
        contact_duration=smooth,
        maximum_indentation=lambda u: np.full(len(u), np.nan),
    )
    runs["restitution"][5] = np.nan
    runs["status"][7] = 2  # first contact unfinished: matters to the contact duration alone
    found = analysis(runs)
    assert verdicts_of(found["surrogate_verdict"]) == [
        "usable",
        "jumps",
        "mostly_constant",
        "constant",
        "poor",
        "failed_runs",
        "failed_runs",
        "too_few_runs",
    ]
    assert found["surrogate_verdict"].attrs["sound_flags"] == "usable"
    given = np.isfinite(found["surrogate_q2"].values)
    assert given.tolist() == [True, True, True, False, True, True, True, False]
    for name in ("surrogate_held_out", "surrogate_coefficient", "surrogate_rmse"):
        found_at = np.isfinite(found[name].values.reshape(8, -1)).all(axis=1)
        assert found_at.tolist() == given.tolist()


def test_a_failed_run_is_fitted_around_not_filled(drawn_runs):
    whole, broken = drawn_runs(peak_force=smooth), drawn_runs(peak_force=smooth)
    broken["peak_force"][3::40] = np.nan
    exact, found = analysis(whole), analysis(broken)
    assert found["surrogate_runs"].item() < exact["surrogate_runs"].item()
    np.testing.assert_allclose(found["surrogate_held_out"], exact["surrogate_held_out"], rtol=1e-5)


def test_the_order_of_runs_and_responses_does_not_matter(drawn_runs):
    runs = drawn_runs(base_samples=64, peak_force=smooth, impulse=ishigami)
    shuffled = runs.isel(run=np.random.default_rng(0).permutation(runs.sizes["run"]))
    shuffled = shuffled.assign_attrs(responses=["impulse", "peak_force"])
    one, other = analysis(runs), analysis(shuffled)
    for name in one.data_vars:
        again = other[name]
        if "response" in again.dims:
            again = again.sel(response=one["response"].values)
        np.testing.assert_array_equal(again.values, one[name].values)


@pytest.mark.parametrize("seed", [0, 3])
def test_the_seed_repeats_bit_for_bit(drawn_runs, seed):
    def found(seed):
        runs = drawn_runs(base_samples=64, seed=seed, peak_force=ishigami)
        return analysis(runs)["surrogate_held_out"].values.tobytes()

    assert found(seed) == found(seed)
    assert found(seed) != found(seed + 1)


def test_groups_are_what_indices_are_given_for(drawn_runs):
    runs = drawn_runs(peak_force=ishigami, attrs={"groups": ["odd", "even", "odd"]})
    found = analysis(runs)
    assert found["parameter"].values.tolist() == ["odd", "even"]
    even = KNOWN.first_order[1]
    expected = [1 - even, even]
    np.testing.assert_allclose(found["surrogate_first_order"].values[0], expected, atol=0.01)
    assert found["surrogate_input"].size == 3


def test_it_is_one_of_the_analyses(drawn_runs):
    attrs = {"second_order": 1, "replicates": 8}
    runs = drawn_runs(base_samples=64, peak_force=smooth, attrs=attrs)
    assert "surrogate" in ANALYSES
    assert "surrogate_q2" in analyse(runs)
    assert "surrogate_q2" not in analyse(runs.assign_attrs(analyses=["sensitivity"]))
