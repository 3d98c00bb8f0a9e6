import numpy as np
import pytest
from drawings import curve, panel, words

from impactlab.figures.catalogue import CATALOGUE

NODES, POINTS = CATALOGUE["nodes_convergence"], CATALOGUE["points_convergence"]
TIME, COST = CATALOGUE["time_step_convergence"], CATALOGUE["convergence_cost"]


@pytest.fixture
def study(discretisation_study):
    runs, analysis = discretisation_study
    kept = ["peak_force", "peak_plastic_strain", "number_of_contacts", "status"]
    return runs[kept], analysis


def test_differences_are_to_the_extrapolated_value(study):
    runs, analysis = study
    spacing, difference = curve(panel(NODES.plot(*study), "Peak force"), "15 m/s, 17 points")
    where = {"velocity": 15.0, "points": 17, "rule": "lobatto"}
    limit = float(analysis["nodes_extrapolated"].sel(response="peak_force", **where))
    values = runs["peak_force"].sel(where)
    np.testing.assert_allclose(spacing, 780.0 / (runs["nodes"] - 1))
    np.testing.assert_allclose(difference, abs(values - limit) / limit)
    order = np.polyfit(np.log(spacing), np.log(difference), 1)[0]
    assert order == pytest.approx(2.0, abs=0.1)
    # the guide has second order
    x, y = curve(panel(NODES.plot(*study), "Peak force"), "_guide: second order")
    assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(2.0)
    # the bar reaches up to the uncertainty
    axes = panel(NODES.plot(runs, analysis), "Peak force")
    spacing, errors = curve(axes, "0.99 m/s, 3 points")
    x, y = curve(axes, "_bar")
    assert x.tolist() == [spacing.min()] * 2
    np.testing.assert_allclose(y, [errors[-1], 2e-3])


def test_without_an_extrapolated_value_the_finest_is_the_reference(study):
    runs, _ = study
    _, difference = curve(panel(NODES.plot(*study), "Peak plastic strain"), "15 m/s, 17 points")
    values = runs["peak_plastic_strain"].sel(velocity=15.0, points=17, rule="lobatto").values
    np.testing.assert_allclose(difference[:2], abs(values[:2] - values[2]) / values[2])
    assert np.isnan(difference[2])
    # elastic runs have no curve of plastic strain
    axes = panel(NODES.plot(*study), "Peak plastic strain")
    labels = {str(line.get_label()) for line in axes.lines}
    curves = {label for label in labels if not label.startswith("_")}
    assert curves == {"15 m/s, 3 points", "15 m/s, 17 points"}


def test_verdicts_are_written_and_warnings_stand_out(study):
    figure = NODES.plot(*study)
    good, bad = (
        panel(figure, "Peak force").texts[0],
        panel(figure, "Peak plastic strain").texts[0],
    )
    assert (good.get_text(), good.get_fontweight()) == ("converged", "normal")
    assert (bad.get_text(), bad.get_fontweight()) == ("divergent", "bold")
    strain = panel(POINTS.plot(*study), "Peak plastic strain")
    assert words(strain) == ["not yet converged"]


def test_what_does_not_change_says_so(study, failing):
    contacts = "Number of contacts"
    assert "same on every grid" in words(panel(NODES.plot(*study), contacts))
    assert "same for every number" in words(panel(POINTS.plot(*study), contacts))
    # round off is no difference
    runs, analysis = study
    analysis["points_error"].loc[{"response": "number_of_contacts", "points": 3}] = 1e-12
    axes = panel(POINTS.plot(runs, analysis), "Number of contacts")
    assert "same for every number" in words(axes)
    # one value is not the same everywhere
    broken = failing(runs, {"nodes": slice(1, None)})
    assert "too few values" in words(panel(NODES.plot(broken, analysis), "Number of contacts"))
    analysis["points_error"].loc[{"points": [3, 5, 9]}] = np.nan
    assert "too few values" in words(panel(POINTS.plot(runs, analysis), "Number of contacts"))


def test_failed_runs_leave_gaps_in_both(study, failing):
    runs, analysis = study
    broken = failing(runs, {"nodes": 1, "points": 3, "rule": 0, "velocity": 1})
    _, difference = curve(panel(NODES.plot(broken, analysis), "Peak force"), "15 m/s, 17 points")
    assert np.isnan(difference).tolist() == [False, True, False]
    analysis["points_error"].loc[{"response": "peak_force", "points": 5}] = np.nan
    _, error = curve(panel(POINTS.plot(runs, analysis), "Peak force"), "Gauss-Legendre, 15 m/s")
    assert np.isnan(error).tolist() == [False, True, False, True]
    assert "1 of 72 runs is missing" in NODES.caption(broken, analysis)


def test_an_infinite_error_in_points_is_left_out(study):
    runs, analysis = study
    analysis["points_error"].loc[{"response": "peak_force", "points": 3}] = np.inf
    points, error = curve(
        panel(POINTS.plot(runs, analysis), "Peak force"), "uniform layers, 0.99 m/s"
    )
    stored = analysis["points_error"].sel(
        response="peak_force", rule="layers", velocity=0.99, nodes=401, points=5
    )
    assert points.tolist() == [3, 5, 9, 17]
    assert np.isnan(error[0])
    assert error[1] == pytest.approx(float(stored))


def test_a_varied_span_makes_the_spacing_relative(study):
    runs, analysis = study
    figure = NODES.plot(runs.assign_coords(beam_span=("velocity", [0.5, 0.78])), analysis)
    assert figure.get_supxlabel() == "Spacing of the nodes over the span (–)"


def _orders(axes):
    (text,) = (text for text in axes.texts if text.get_text().startswith("p = "))
    return text.get_text()


def test_the_order_is_drawn_through_the_errors_and_written(study):
    runs, analysis = study
    analysis["nodes_observed_order"][:] = 1.5
    axes = panel(NODES.plot(runs, analysis), "Peak force")
    assert _orders(axes) == "p = 1.50"
    analysis["nodes_observed_order"].loc[{"velocity": 15.0}] = 1.75
    axes = panel(NODES.plot(runs, analysis), "Peak force")
    assert _orders(axes) == "p = 1.50 to 1.75"
    x, y = curve(axes, "_order")
    assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(1.5)
    _, errors = curve(axes, "0.99 m/s, 3 points")
    assert errors.min() < y.min() < y.max() < 3 * errors.max()


def test_an_assumed_order_is_in_brackets(study):
    runs, analysis = study
    where = {"response": "peak_force", "velocity": 15.0}
    analysis["nodes_extrapolated"].loc[where] = np.nan
    finest = analysis["nodes_gci"]
    fitted = analysis.assign(
        nodes_fit_order=0 * finest + 2,
        nodes_fit_extrapolated=runs["peak_force"].isel(nodes=-1) * 0.999 + 0 * finest,
        nodes_fit_expansion=0 * finest + 2,
    )
    axes = panel(NODES.plot(runs, fitted), "Peak force")
    assert _orders(axes) == "p = 2.00 [2]"


def test_an_infinite_uncertainty_has_no_bar(study):
    runs, analysis = study
    analysis["nodes_uncertainty"][:] = np.inf
    lines = panel(NODES.plot(runs, analysis), "Peak force").lines
    assert "_bar" not in {line.get_label() for line in lines}
    # The finest value of the strain is its own reference: no cap stands alone.
    analysis["nodes_uncertainty"].loc[{"response": "peak_plastic_strain"}] = 0.1
    lines = panel(NODES.plot(runs, analysis), "Peak plastic strain").lines
    bars = [line for line in lines if line.get_label() == "_bar"]
    assert {line.get_markerfacecolor() for line in bars} == {"white"}
    assert "_" not in {line.get_marker() for line in bars}


def test_time_steps_at_fixed_nodes(time_step_study):
    runs, analysis = time_step_study
    runs = runs[["peak_force", "status"]]
    axes = panel(TIME.plot(runs, analysis), "Peak force")
    courant, errors = curve(axes, "modal, 201 nodes")
    assert courant.tolist() == [0.2, 0.4, 0.8]
    np.testing.assert_allclose(errors, 1e-3 * courant**2)
    assert not NODES.applies(runs, analysis)
    assert not COST.applies(runs, analysis)


def test_cost_against_error(study):
    """Leapfrog's steps shrink with the spacing squared: work grows with the cube of the nodes."""
    runs, analysis = study
    axes = panel(COST.plot(runs, analysis), "Peak force")
    work, errors = curve(axes, "0.99 m/s, 17 points")
    np.testing.assert_allclose(work[1:] / work[:-1], 8.0, rtol=0.05)
    _, same = curve(panel(NODES.plot(runs, analysis), "Peak force"), "0.99 m/s, 17 points")
    np.testing.assert_allclose(errors, same)


def test_what_has_no_limit_by_design_is_drawn_as_it_is(study):
    runs, analysis = study
    flags = {"flag_meanings": "converged not_convergent_by_design not_yet_converged"}
    verdict = 0 * analysis["nodes_observed_order"].fillna(0.0).astype(np.int8)
    verdict.loc[{"response": "peak_plastic_strain"}] = 1
    verdict.loc[{"response": "peak_force", "points": 17, "velocity": 15.0}] = 2
    verdict.loc[{"response": "number_of_contacts", "points": 3}] = 2  # not on the finest grid
    verdict.attrs |= flags | {"flag_values": [0, 1, 2], "sound_flags": "converged"}
    judged = analysis.assign(nodes_verdict=verdict)
    axes = panel(NODES.plot(runs, judged), "Peak plastic strain")
    _, strain = curve(axes, "15 m/s, 17 points")
    stored = runs["peak_plastic_strain"].sel(velocity=15.0, points=17, rule="lobatto")
    np.testing.assert_allclose(strain, 100.0 * stored)
    assert axes.get_ylabel() == "Peak plastic strain (%)"
    caption = NODES.caption(runs, judged)
    warned = "Not converged on the finest grid: peak force (15 m/s); peak plastic strain (every"
    assert warned in caption


def test_several_cases_that_have_not_converged_are_counted_and_the_worst_named(study):
    attrs = study[0]["velocity"].attrs
    runs, analysis = (
        part.sel(velocity=[0.99, 15.0, 15.0]).assign_coords(
            velocity=("velocity", [0.99, 15.0, 20.0], attrs)
        )
        for part in study
    )
    for velocity, uncertainty in ((15.0, 0.1), (20.0, 0.2)):
        case = {"response": "peak_force", "velocity": velocity}
        analysis["nodes_verdict"].loc[case] = analysis["nodes_verdict"].loc[
            {"response": "peak_plastic_strain", "velocity": 15.0}
        ]
        analysis["nodes_uncertainty"].loc[case] = uncertainty
    caption = NODES.caption(runs, analysis)
    assert "peak force (2 of 3 cases, the worst at 20 m/s)" in caption
