"""The figures of a verification: nothing hidden, nothing overlapping."""

import json
from dataclasses import replace

import numpy as np
import pytest
from drawings import (
    assert_panels_and_legends_are_on_the_page_and_apart,
    assert_text_is_apart,
    assert_texts_are_fit_for_print,
    laid_out,
)

from impactlab.figures import data, style
from impactlab.figures import findings as drawn
from impactlab.figures.draw import draw_findings
from impactlab.verification.finding import Curve, CurvePanel, Finding, gravest_first
from impactlab.verification.outcomes import packed

MANY = [Curve(f"{n} nodes", np.arange(9.0), n + np.arange(9.0), n % 2 == 1) for n in range(9)]


def _with_panels(outcomes, *panels):
    return replace(outcomes[1], finding=Finding((), panels))


def test_files_are_the_overview_and_each_check_with_curves(findings, outcomes, tmp_path):
    written = [path.name for path in draw_findings(findings, tmp_path)]
    kinds = ("svg", "png", "csv", "nc")
    files = [f"{name}.{kind}" for name in ("overview", "bad") for kind in kinds]
    assert written == [*files, "captions.json"]
    captions = json.loads((tmp_path / "captions.json").read_text("utf-8"))
    assert captions["bad"]["title"] == "A bad check"
    assert "a series & more" in captions["bad"]["caption"]
    empty = _with_panels(outcomes, CurvePanel("t", ("x", "m"), ("y", "m"), []))
    draw_findings(packed([outcomes[0], empty]), tmp_path)
    assert not list(tmp_path.glob("bad.*"))


def test_every_comparison_is_a_point_and_the_failed_ones_look_different(outcomes):
    (axes,) = drawn.plot_overview(outcomes).axes
    found = [line for line in axes.lines if line.get_marker() not in ("None", "")]
    assert sum(len(line.get_xdata()) for line in found) == 21
    failed = [line for line in found if line.get_label() in ("failed", "_data: failed")]
    assert sum(len(line.get_xdata()) for line in failed) == 3
    assert all(np.min(line.get_xdata()) > 1.0 for line in failed)
    assert {line.get_color() for line in failed} == {style.COLOURS[1]}
    assert {line.get_color() for line in found if line not in failed} == {style.COLOURS[0]}
    ends = [line for line in found if line.get_marker() == ">"]
    assert [len(line.get_xdata()) for line in ends] == [1]  # NaN: at the edge, not left out
    assert axes.get_xlim()[1] >= np.max(ends[0].get_xdata())
    said = [text.get_text() for text in axes.texts]
    assert said == ["all 3", "3 of 18 failed", "error", "nothing"]
    # the data have every comparison with its check
    curves = list(data.drawn(drawn.plot_overview(outcomes)))
    assert sum(curve.x.size for curve in curves) == 21
    assert sum(curve.x.size for curve in curves if curve.curve == "failed") == 3
    checks = {name for curve in curves for name in curve.category}
    assert checks == {outcome.title for outcome in outcomes if outcome.finding.comparisons}
    text = data.alt(drawn.plot_overview(outcomes))
    assert text.startswith("Error over tolerance (–): ")
    assert "largest for A bad check" in text
    assert "all 3" not in text  # a note beside data, none in place of them
    # the caption counts what lies at the edges
    assert "1 above 1000 or without a number at the right edge" in drawn.overview_caption(outcomes)
    assert "triangles" not in drawn.overview_caption(outcomes[:1])


@pytest.mark.parametrize("kind", ["overview", "same legend", "other legends", "one", "many"])
def test_nothing_overlaps_at_paper_width(kind, outcomes):
    bad = outcomes[1]
    first, second = bad.finding.panels
    long = "a title that goes on and on, for it states every parameter of the case"
    figure = laid_out(
        {
            "overview": lambda: drawn.plot_overview(gravest_first(outcomes * 4)),
            "same legend": lambda: drawn.plot_curves(_with_panels(outcomes, first, first)),
            "other legends": lambda: drawn.plot_curves(bad),
            "one": lambda: drawn.plot_curves(_with_panels(outcomes, second)),
            "many": lambda: drawn.plot_curves(
                _with_panels(outcomes, *[first, replace(first, title=long, curves=MANY)] * 3)
            ),
        }[kind]()
    )
    width = figure.get_figwidth() / style.MILLIMETRE
    assert min(abs(width - style.SINGLE), abs(width - style.DOUBLE)) < 1e-6
    assert_texts_are_fit_for_print(figure)
    assert_text_is_apart(figure)
    assert_panels_and_legends_are_on_the_page_and_apart(figure)
    heights = [axes.get_window_extent().height for axes in figure.axes]
    assert min(heights) > 20 * style.MILLIMETRE * figure.dpi


def test_ours_and_independent_curves_differ_without_colour(outcomes):
    ours, independent = drawn.plot_curves(outcomes[1]).axes[0].lines
    assert independent.get_linewidth() > 2 * ours.get_linewidth()
    assert independent.get_zorder() < ours.get_zorder(), "the solver's colours stay visible"
    marked, open_ = drawn.plot_curves(outcomes[1]).axes[1].lines
    assert marked.get_marker() not in ("", "None")
    assert marked.get_markerfacecolor() != "none"
    assert open_.get_markerfacecolor() == "none"
    # axes are in display units and decades
    force, error = drawn.plot_curves(outcomes[1]).axes
    assert (force.get_xlabel(), force.get_ylabel()) == ("Time (ms)", "Contact force (kN)")
    assert np.max(force.lines[0].get_xdata()) == pytest.approx(1.0)
    assert np.max(force.lines[0].get_ydata()) == pytest.approx(20.0, rel=1e-3)
    assert force.get_xscale() == "linear"
    assert (error.get_xscale(), error.get_yscale()) == ("log", "log")
    assert error.get_ylabel().replace("\n", " ").endswith("(–)")


def test_few_points_beside_a_dense_curve_are_not_joined(outcomes):
    x, dense = np.arange(5.0), np.linspace(0.0, 4.0, 99)
    curves = [Curve("solver", x, x**2), Curve("closed form", dense, dense**2, True)]
    panel = CurvePanel("t", ("x", "m"), ("y", "m"), curves)
    (axes,) = drawn.plot_curves(_with_panels(outcomes, panel)).axes
    assert [line.get_linestyle() for line in axes.lines] == ["None", "-"]
    assert [line.get_marker() for line in axes.lines] == ["o", ""]
    # a curve named as the solvers is told apart
    x = np.arange(3.0)
    panel = CurvePanel(
        "t", ("x", "m"), ("y", "m"), [Curve("steel", x, x), Curve("steel", x, x, True)]
    )
    (axes,) = drawn.plot_curves(_with_panels(outcomes, panel)).axes
    assert [line.get_label() for line in axes.lines] == ["steel", "steel, independent"]
    # nothing to draw is said
    x = np.arange(3.0)
    below = CurvePanel("t", ("x", "m"), ("y", "m"), [Curve("a", x, -1.0 - x)], log=True)
    missing = CurvePanel("t", ("x", "m"), ("y", "m"), [Curve("a", x, x * np.nan)])
    figure = laid_out(drawn.plot_curves(_with_panels(outcomes, below, missing)))
    said = [axes.texts[0].get_text() for axes in figure.axes]
    assert said == ["no finite values above zero", "no finite values"]
