"""Figures of Sobol indices, distributions and surrogates."""

import numpy as np
import pytest
from drawings import panel, words
from matplotlib.container import BarContainer

from impactlab.analysis import distribution
from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.indices import pairs
from impactlab.figures.samples import surrogate_validation


@pytest.fixture
def study(sobol_study):
    runs, analysis = sobol_study
    return runs[["peak_force", "number_of_contacts", "restitution", "status"]], analysis


def test_bars_and_intervals_are_the_stored_ones(study):
    _, analysis = study
    axes = panel(CATALOGUE["sobol_indices"].plot(*study), "Peak force")
    bars = [entry for entry in axes.containers if isinstance(entry, BarContainer)]
    for order, container in zip(("first_order", "total_order"), bars, strict=True):
        stored = analysis.sel(response="peak_force")
        widths = [bar.get_width() for bar in container.patches]
        np.testing.assert_allclose(widths, stored[order])
        assert container.errorbar is not None
        segments = container.errorbar.lines[2][0].get_segments()
        halves = [(segment[1][0] - segment[0][0]) / 2 for segment in segments]
        np.testing.assert_allclose(halves, stored[f"{order}_interval"])
    # parameters are in plain words
    axes = CATALOGUE["sobol_indices"].plot(*study).axes[0]
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels[:2] == ["impact velocity", "yield stress of the beam"]
    # undefined indices say why and draw nothing
    axes = panel(CATALOGUE["sobol_indices"].plot(*study), "Number of contacts")
    assert words(axes) == ["undefined:\nconstant"]


def test_an_unsound_verdict_is_written_beside_numbers(study):
    runs, analysis = study
    analysis["sensitivity_verdict"].loc[{"response": "restitution"}] = 2
    figure = CATALOGUE["sobol_indices"].plot(runs, analysis)
    assert "failed runs" in words(panel(figure, "Restitution"))
    assert words(panel(figure, "Peak force")) == []


def test_pairs_are_shown_once_and_only_significant_ones_have_numbers(study):
    runs, analysis = study
    written = words(panel(CATALOGUE["sobol_second_order"].plot(runs, analysis), "Peak force"))
    index, margin = (
        analysis[name].sel(response="peak_force")
        for name in ("second_order", "second_order_interval")
    )
    assert len(written) == int((abs(pairs(index)) > pairs(margin)).sum()) < 6
    assert "0.07" in written
    assert "−.01" not in written
    # short names stand under the columns, long ones have numbers
    names = list("abcd")
    short = {"parameter": names, "other_parameter": names}
    short |= {"parameter_long_name": ("parameter", names)}
    figure = CATALOGUE["sobol_second_order"].plot(runs, analysis.assign_coords(short))
    columns = panel(figure, "Peak force").get_xticklabels()
    assert [text.get_text() for text in columns] == ["b", "c", "d"]
    # without intervals no pair is significant
    figure = CATALOGUE["sobol_second_order"]
    assert not figure.applies(runs, analysis.drop_vars("second_order_interval"))
    # responses without a significant pair are left out
    figure = CATALOGUE["sobol_second_order"]
    shown = len(figure.plot(runs, analysis).axes) - 1  # and the bar of colours
    assert f"Left out: {3 - shown} response" in figure.caption(runs, analysis)
    analysis["second_order_interval"][:] = 1.0
    assert not figure.applies(runs, analysis)


def test_pairs_of_a_symmetric_matrix_and_of_its_upper_half_are_the_same(study):
    _, analysis = study
    upper = analysis["second_order"].sel(response="peak_force")
    lower = upper.copy(data=upper.values.T)
    symmetric = upper.fillna(0.0) + lower.fillna(0.0).values
    np.testing.assert_array_equal(pairs(upper), pairs(lower))
    np.testing.assert_array_equal(pairs(upper), pairs(symmetric))
    assert np.isfinite(pairs(symmetric)).sum() == 6


def test_histograms_count_every_finite_run(study, failing):
    runs, analysis = study
    broken = failing(runs, {"run": slice(0, 56)})
    figure = CATALOGUE["response_distributions"].plot(broken, analysis)
    axes = panel(figure, "Peak force")
    assert sum(patch.get_height() for patch in axes.containers[0].patches) == 200
    assert words(panel(figure, "Number of contacts")) == ["constant: 2"]
    caption = CATALOGUE["response_distributions"].caption(broken, analysis)
    assert "56 of 256 runs are missing" in caption


def test_the_shaded_range_holds_nine_runs_of_ten_about_the_median(study):
    runs, _ = study
    analysis = distribution.analysis(runs.assign_attrs(method="delta", responses=["peak_force"]))
    figure = CATALOGUE["response_distributions"].plot(runs, analysis)
    axes = panel(figure, "Peak force")
    (shaded,) = (patch for patch in axes.patches if patch.get_alpha() is None and patch.zorder == 0)
    box = shaded.get_extents().transformed(axes.transData.inverted())
    (median,) = (np.asarray(line.get_xdata()) for line in axes.lines)
    expected = np.percentile(1e-3 * runs["peak_force"], [5, 50, 95])
    assert [box.x0, median[0], box.x1] == pytest.approx(expected)


def test_few_values_get_a_bar_each(study):
    runs, analysis = study
    runs["number_of_contacts"][:100] = 3.0
    runs["number_of_contacts"][100:110] = 5.0
    axes = panel(CATALOGUE["response_distributions"].plot(runs, analysis), "Number of contacts")
    bars = axes.containers[0].patches
    assert [bar.get_height() for bar in bars] == [146, 100, 10]
    assert [bar.get_x() + bar.get_width() / 2 for bar in bars] == [2.0, 3.0, 5.0]
    caption = CATALOGUE["response_distributions"].caption(runs, analysis)
    assert "Bars, for there are few values: number of contacts." in caption


def test_a_value_that_most_runs_share_is_told_and_does_not_hide_the_rest(study):
    runs, analysis = study
    runs["restitution"][:192] = 0.0
    figure = CATALOGUE["response_distributions"].plot(runs, analysis)
    axes = panel(figure, "Restitution")
    assert sum(bar.get_height() for bar in axes.containers[0].patches) == 64
    assert words(axes) == ["75 % of the runs: 0\n(not drawn)"]
    caption = CATALOGUE["response_distributions"].caption(runs, analysis)
    assert "Mostly one value, drawn without it: restitution." in caption


def test_points_are_runs_held_out_in_the_panels_unit(study, failing):
    runs, analysis = study
    axes = panel(surrogate_validation.plot(runs, analysis), "Peak force (kN)")
    x, y = next(line for line in axes.lines if line.get_label() == "runs held out").get_data()
    held_out = analysis["held_out"].values
    np.testing.assert_allclose(x, runs["peak_force"].sel(run=held_out) / 1e3)
    np.testing.assert_allclose(y, analysis["surrogate_held_out"].sel(response="peak_force") / 1e3)
    assert words(axes) == ["Q² = 0.9876"]
    # a run that failed is no point
    broken = failing(runs, {"run": slice(0, 101)})
    axes = panel(surrogate_validation.plot(broken, analysis), "Peak force")
    line = next(line for line in axes.lines if line.get_label() == "runs held out")
    assert len(line.get_data()[0]) == analysis.sizes["held_out"] - 21
    assert "101 of 256 runs are missing" in surrogate_validation.caption(broken, analysis)
    # no surrogate says why and an unsound one warns
    analysis["surrogate_verdict"].loc[{"response": "restitution"}] = 2
    figure = surrogate_validation.plot(runs, analysis)
    assert words(panel(figure, "Number of contacts")) == ["no surrogate:\nconstant"]
    assert words(panel(figure, "Restitution")) == ["Q² = 0.9876\npoor"]
