from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import surrogate_validation

Study = Any


@pytest.fixture
def study(sobol_study: Study) -> Study:
    runs, analysis = sobol_study
    return runs[["peak_force", "number_of_contacts", "restitution", "status"]], analysis


def _panel(figure: Figure, title: str) -> Axes:
    return next(ax for ax in figure.axes if ax.get_title(loc="left").startswith(title))


def _words(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_points_are_runs_held_out_in_the_panels_unit(study: Study) -> None:
    runs, analysis = study
    axes = _panel(surrogate_validation.plot(runs, analysis), "Peak force (kN)")
    x, y = next(line for line in axes.lines if line.get_label() == "runs held out").get_data()
    held_out = analysis["held_out"].values
    np.testing.assert_allclose(x, runs["peak_force"].sel(run=held_out) / 1e3)
    np.testing.assert_allclose(y, analysis["surrogate_held_out"].sel(response="peak_force") / 1e3)
    assert _words(axes) == ["Q² = 0.9876"]


def test_a_run_that_failed_is_no_point(study: Study, failing: Any) -> None:
    runs, analysis = study
    broken = failing(runs, {"run": slice(0, 101)})
    axes = _panel(surrogate_validation.plot(broken, analysis), "Peak force")
    line = next(line for line in axes.lines if line.get_label() == "runs held out")
    assert len(line.get_data()[0]) == analysis.sizes["held_out"] - 21
    assert "101 of 256 runs are missing" in surrogate_validation.caption(broken, analysis)


def test_no_surrogate_says_why_and_an_unsound_one_warns(study: Study) -> None:
    runs, analysis = study
    analysis["surrogate_verdict"].loc[{"response": "restitution"}] = 2
    figure = surrogate_validation.plot(runs, analysis)
    assert _words(_panel(figure, "Number of contacts")) == ["no surrogate:\nconstant"]
    assert _words(_panel(figure, "Restitution")) == ["Q² = 0.9876\npoor"]
