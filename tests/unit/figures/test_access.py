"""Data access: missing runs with their reasons, and verdicts."""

import numpy as np
import pytest
import xarray as xr

from impactlab.figures import access
from impactlab.figures.access import usable, verdict
from impactlab.variables import STATUS_FLAGS


def test_nothing_is_said_when_nothing_is_missing(velocity_study, failing):
    runs, _ = velocity_study
    assert access.missing_note(runs, ["peak_force", "contact_force"]) == ""
    # missing runs are counted with their reasons
    broken = failing(failing(runs, {"velocity": 5, "contact": 1}), {"velocity": 6, "contact": 0})
    bit, words = STATUS_FLAGS["first_contact_unfinished"]
    broken["status"][{"velocity": 6, "contact": 0}] = bit
    both = access.missing_note(broken, ["contact_duration", "peak_force"])
    assert both.startswith("2 of 16 runs are missing in one panel or more: ")
    note = access.missing_note(broken, ["contact_duration"])
    assert note.startswith("2 of 16 runs are missing here: ")
    assert f"1 × “{words}”" in note
    assert f"1 × “{STATUS_FLAGS['diverged'][1]}”" in note


@pytest.mark.parametrize("method", ["delta", "sobol"])
def test_intervals_of_means_by_word_cover_the_means(method):
    random, covered = np.random.default_rng(3), []
    choice = {"distribution": "choice", "values": ["a", "b"]}
    for _ in range(200):
        x, word = random.random((2, 128, 1)), random.integers(0, 2, (2, 128, 1))
        if method == "sobol":  # A, AB of x, AB of the word, B
            x, word = x[[0, 1, 0, 1]], word[[0, 0, 1, 1]]
        words, y = np.array(["a", "b"])[word.ravel()], (word * (1 + 9 * x)).ravel()
        attrs = {"base_samples": 128} if method == "sobol" else {}
        runs = xr.Dataset({"y": ("run", y)}, {"word": ("run", words, choice)}, attrs)
        means = access.means_by_word(runs, "word", "y")
        assert means["a"] == (0.0, 0.0)
        covered.append(abs(means["b"][0] - 5.5) <= means["b"][1])
    assert 0.91 <= np.mean(covered) <= 1.0
    runs["y"][:] = np.where(words == "a", np.nan, y)
    assert np.isnan(access.means_by_word(runs, "word", "y")["a"]).all()


def test_status_overrules_a_number(velocity_study):
    runs, _ = velocity_study
    runs["status"][0, 0] = STATUS_FLAGS["first_contact_unfinished"][0]
    assert np.isnan(usable(runs, "contact_duration")[0, 0])
    assert np.isfinite(usable(runs, "number_of_contacts")[0, 0])
    runs["status"][0, 0] = STATUS_FLAGS["diverged"][0]
    assert np.isnan(usable(runs, "contact_force")[0, 0]).all()
    # a gap without a status is not silent
    runs["peak_force"][1, 0] = np.nan
    assert access.UNEXPLAINED in access.missing_note(runs, ["peak_force"])
    assert access.UNEXPLAINED in access.missing_note(runs.drop_vars("status"), ["peak_force"])


def test_a_history_is_missing_only_when_all_of_it_is():
    history = xr.DataArray([[np.nan, 1.0], [np.nan, np.nan]], dims=("velocity", "time"))
    assert access.absent(xr.Dataset({"force": history}), "force").values.tolist() == [False, True]


def test_flag_soundness_and_meaning(discretisation_study):
    _, analysis = discretisation_study
    good = verdict(analysis, "nodes_summary", "peak_force")
    bad = verdict(analysis, "nodes_summary", "peak_plastic_strain")
    assert good is not None
    assert bad is not None
    assert (good.words, good.sound) == ("converged", True)
    assert (bad.flag, bad.sound, bad.meaning) == ("divergent", False, "meaning of divergent")
    # no verdict where there is none
    assert verdict(analysis, "sensitivity_verdict", "peak_force") is None
    assert verdict(analysis, "nodes_summary", "no_such_response") is None
    # an unknown number is not sound
    analysis["nodes_summary"].loc[{"response": "peak_force"}] = 99
    found = verdict(analysis, "nodes_summary", "peak_force")
    assert found is not None
    assert not found.sound
