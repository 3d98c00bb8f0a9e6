from __future__ import annotations

from typing import Any

from impactlab.figures.access import verdict

Study = Any


def test_flag_soundness_and_meaning(discretisation_study: Study) -> None:
    _, analysis = discretisation_study
    good = verdict(analysis, "nodes_summary", "peak_force")
    bad = verdict(analysis, "nodes_summary", "peak_plastic_strain")
    assert good is not None
    assert bad is not None
    assert (good.words, good.sound) == ("converged", True)
    assert (bad.flag, bad.sound, bad.meaning) == ("divergent", False, "meaning of divergent")


def test_no_verdict_where_there_is_none(discretisation_study: Study) -> None:
    _, analysis = discretisation_study
    assert verdict(analysis, "sensitivity_verdict", "peak_force") is None
    assert verdict(analysis, "nodes_summary", "no_such_response") is None


def test_an_unknown_number_is_not_sound(discretisation_study: Study) -> None:
    _, analysis = discretisation_study
    analysis["nodes_summary"].loc[{"response": "peak_force"}] = 99
    found = verdict(analysis, "nodes_summary", "peak_force")
    assert found is not None
    assert not found.sound
