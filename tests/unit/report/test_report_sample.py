"""The report of a sample: its sections, sentences, tables and files."""

import html5lib
import numpy as np
import pytest
import samples
import xarray as xr
from scipy.stats import spearmanr

from impactlab.analysis import distribution
from impactlab.analysis.analyse import NumericalFrom
from impactlab.figures.catalogue import applicable
from impactlab.figures.draw import draw_all
from impactlab.report import sensitivity
from impactlab.report.answer import answers
from impactlab.report.sensitivity import with_margin
from impactlab.report.study import write_report
from impactlab.variables import attributes
from impactlab.verdicts import flagged

PEAK = {"response": "peak_force"}

OUTSIDE = ("indices.csv", "../index.html")


@pytest.fixture
def study():
    """Two responses, four parameters, all indices; no number is in doubt for numerical error."""
    runs = samples.sample(64, 4)[["peak_force", "remote_plastic_strain", "status"]]
    analysis = samples.indices(runs)
    analysis["first_order_numerical"][:] = analysis["total_order_numerical"][:] = 0.0
    return runs, analysis


def _titles(page):
    return [attrs["id"] for attrs in page.named("section")]


def _table(page, start):
    return next(rows for caption, rows in page.tables.items() if caption.startswith(start))


def test_sections_stand_in_the_order_of_sensobol(report, study):
    assert _titles(report(*study)) == [
        "answer",
        "ranking",
        "sensitivity",
        "second-order",
        "index-convergence",
        "over-time",
        "morris",
        "delta",
        "pawn",
        "regression",
        "surrogate",
        "numerical",
        "results",
        "outcome",
        "runs",
        "scatter",
        "figures",
        "notes",
        "provenance",
    ]
    # the verdict stands beside every number
    page = report(*study)
    starts = ("Sobol", "Ranks", "Delta", "PAWN", "Regression", "Elementary", "The surrogate on")
    tables = [rows for caption, rows in page.tables.items() if caption.startswith(starts)]
    assert len(tables) == 11
    for rows in tables:
        assert rows[2][0] == "Remote plastic strainmostly constant"
    # a design that is no sample of the distribution says so
    runs, analysis = study
    page = report(runs.assign_attrs(method="morris"), analysis)
    assert "There are no moments and percentiles: trajectories step" in page.text
    assert "Median" not in _table(page, "Range of each response")[0]


def test_indices_over_time_are_told_with_what_was_left_out(report, study):
    page = report(*study)
    assert "A base sample is left out where one of its runs failed" in page.text
    rows = _table(page, "Generalised Sobol indices, first order")
    assert rows[1][:2] == ["Contact force", "0.71 ± 0.03"]
    gaps = [row[-2:] for row in rows]
    assert gaps[0] == ["Base samples left out", "Times without an index"]
    assert gaps[1:] == [["0 of 32", "23 of 60"], ["3 of 32", "23 of 60"]]
    told = "over time: impact velocity 78 % (± 3) and yield stress of the beam 13 % (± 3)"
    force, deflection = (f"{history} {told}" for history in ("Contact force", "Midspan deflection"))
    assert answers(*study)[-1] == f"{force} of the variance; {deflection}; runs failed."
    runs, analysis = study
    none = {name: np.nan * analysis[name] for name in analysis if name.startswith("generalised")}
    last = answers(runs, analysis.assign(none))[-1]
    assert last.endswith("; Midspan deflection over time: runs failed.")
    assert rows[2][0].startswith("Midspan deflection")
    assert "runs left out" in rows[2][0]


def test_words_have_means_and_no_surrogate(report, study):
    runs, analysis = study
    words = ["mjg", "brake", "thornton"]  # the last is never drawn
    choice = {"distribution": "choice", "values": words, "weights": [0.75, 0.25, 1e-9]}
    choice |= attributes("contact")
    law = ("run", np.where(np.arange(64) % 4, "mjg", "brake"), choice)
    runs = runs.drop_vars("contact").assign_coords(contact=law)
    runs.attrs["varied"] = [*runs.attrs["varied"], "contact"]
    kept = ["first_order", "total_order", "sensitivity_verdict"]
    page = report(runs, analysis[kept])
    ((head), *rows) = _table(page, "Mean of each response by contact law")
    assert head == ["Response", "MJG", "Brake", "Thornton"]
    force = 1e-3 * runs["peak_force"].groupby("contact").mean()
    for cell, word in zip(rows[0][1:], words[:2], strict=False):
        assert cell.startswith(f"{force.sel(contact=word):.1f} ± ")
    assert rows[0][3] == "missing"
    assert "No run draws “thornton” for the contact law" in page.text
    varied = _table(page, "Varied parameters")
    assert varied[-1][0] == "Contact law"
    assert varied[-1][1].startswith("choice: MJG 75 %, Brake 25 %, Thornton")
    assert "no polynomial follows words (contact law)" in page.text


def test_correlated_inputs_are_stated(report, study):
    runs, analysis = study
    first, second = runs.attrs["varied"][:2]
    runs = runs.assign_attrs(method="delta", rank_correlations=0.5, correlated=f"{first} {second}")
    found = spearmanr(runs[first], runs[second]).statistic
    page = report(runs, analysis[["delta", "delta_interval", "sensitivity_verdict"]])
    (_, row) = _table(page, "Rank correlations, by a Gaussian copula")
    assert row[1:] == ["0.50", f"{found:.2f}"]
    meaning = "the index of each includes what it shares with the others"
    assert page.text.count("The inputs are correlated (") == page.text.count(meaning) == 2
    assert meaning in answers(runs, analysis[["delta", "delta_interval"]])[0]
    assert "its terms assume independent parameters" in page.text


def test_figures_are_numbered_as_they_stand(study, tmp_path, page):
    runs, analysis = study
    kept = ["first_order", "total_order", "sensitivity_verdict", "numerical_uncertainty"]
    draw_all(runs, analysis[kept], tmp_path / "figures")
    write_report(runs, analysis[kept], tmp_path / "figures", tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text("utf-8")
    assert text.index("<summary>Figure 1. Sobol") < text.index('id="ranking"')
    places = [text.index(f"<strong>Figure {number}.") for number in range(2, 5)]
    assert places == sorted(places)
    assert "<strong>Figure 5." not in text
    found = page(text)
    for attrs in found.named("a"):
        # the analysis and the index make these
        if not attrs["href"].startswith("#") and attrs["href"] not in OUTSIDE:
            assert (tmp_path / attrs["href"]).exists()
    html5lib.HTMLParser(strict=True).parse(text)


def test_shares_that_only_the_numerical_error_hides_are_not_called_insignificant(report, study):
    runs, analysis = study
    for order in ("first_order", "total_order"):
        analysis[f"{order}_numerical"].loc[PEAK] = 0.9
    assert answers(runs, analysis)[0] == (
        "Not usable: the numerical error exceeds an index of the peak force (the impact velocity "
        "(79 ± 4 %, numerically ± 90 %) and the yield stress of the beam (14 ± 4 %, numerically ± "
        "90 %))."
    )
    rows = _table(report(runs, analysis), "Ranks of the parameters by Sobol indices, total order")
    assert rows[1] == ["Peak force", "numerical", "numerical", "noise", "noise"]
    analysis["total_order_numerical"].loc[PEAK] = 1e-6
    assert answers(runs, analysis)[0].endswith("; numerical error is negligible (below 0.1 %).")


@pytest.mark.parametrize(
    ("code", "told", "missing"),
    [(0, "measured where the first runs", "only a bound"), (1, "only a bound", "measured where")],
)
def test_what_the_numerical_error_rests_on_is_told(report, study, code, told, missing):
    runs, analysis = study
    codes = xr.full_like(analysis["response"], code, dtype=np.int8)
    analysis["numerical_from"] = flagged(codes, NumericalFrom, "what it rests on")
    page = report(runs, analysis.drop_vars(["numerical_uncertainty", "numerical_share"]))
    row = _table(page, "Numerical uncertainty")[1]
    assert row == ["Peak force", "–", "–", "0", "0", ("measured", "bound")[code]]
    assert told in page.text
    assert missing not in page.text


def test_numerical_warnings_and_ranks_as_far_as_known_stand_in_the_tables(report, study):
    runs, analysis = study
    analysis["total_order_numerical"].loc["peak_force", "beam_yield_stress"] = 0.5
    analysis["total_order"].loc["remote_plastic_strain"] = [0.5, 0.46, 0.2, 0.01]
    page = report(runs, analysis)
    row = next(r for r in _table(page, "Sobol indices, total order") if r[0] == "Peak force")
    assert row[1] == "0.79 ± 0.04"
    assert row[2].endswith("below numerical error")
    assert _table(page, "Numerical uncertainty")[1] == ["Peak force", "0.5 %", "0.2 %", "0", "0.5"]
    row = _table(page, "Ranks of the parameters by Sobol indices, total order")[2]
    assert row[1:] == ["1–2", "1–2", "3", "noise"]


def test_other_families_answer_in_their_own_measure(study):
    runs, analysis = study
    sobol = [name for name in analysis if "_order" in name and "delta" not in name]
    morris = analysis.drop_vars(sobol)
    morris["morris_mu_star"].loc[PEAK] = [12e3, 3e3, 10.0, 0.0]
    morris["morris_mu_star_interval"].loc[PEAK] = 600.0
    first, *_ = answers(runs, morris)
    assert first == (
        "The impact velocity (12 kN ± 0.6) and the yield stress of the beam (3 kN ± 0.6) matter "
        "most for the peak force."
    )
    others = morris.drop_vars([name for name in morris if name.startswith("morris")])
    others["delta"].loc[PEAK] = [0.4, 0.2, 0.01, 0.01]
    assert answers(runs, others)[0].startswith(
        "The impact velocity (0.40 ± 0.02) and the yield stress of the beam (0.20 ± 0.02) matter"
    )
    fits = others.drop_vars([name for name in others if name.startswith(("delta", "pawn"))])
    fits["regression_r_squared"].loc[PEAK] = 0.45
    assert "; R² of the fit 0.45 " in answers(runs, fits)[0]


def test_first_orders_alone_make_a_whole_report(report, study):
    """Some methods give no total order."""
    runs, analysis = study
    own = ["first_order", "first_order_interval", "first_order_numerical", "sensitivity_verdict"]
    analysis = analysis[own]
    analysis["first_order"].loc[PEAK] = [0.6, 0.3, 0.0, 0.0]
    first, *_ = answers(runs, analysis)
    assert first.startswith("The impact velocity (60 ± 3 %) and the yield stress of the beam (30")
    page = report(runs, analysis)
    assert "alone" not in page.text.split("cause most")[0]
    assert _titles(page)[:3] == ["answer", "ranking", "sensitivity"]
    assert _table(page, "Ranks of the parameters by Sobol indices, first order")[1][1:3] == [
        "1",
        "2",
    ]
    assert "surrogate" not in _titles(page)
    applicable(runs, analysis)["sobol_indices"].plot(runs, analysis)


def test_a_surrogate_that_disagrees_or_is_poor_is_named(study):
    runs, analysis = study
    analysis["surrogate_total_order"].loc[PEAK] = [0.5, 0.13, 0.0, 0.0]
    analysis["surrogate_q2"].loc[PEAK] = 0.93
    analysis["surrogate_q2_low"].loc[PEAK] = 0.81
    found = sensitivity.surrogate(runs, analysis)
    assert found.sentences == [
        "Peak force: the total-order indices of the runs and of the surrogate differ by more than "
        "their intervals for impact velocity."
    ]
    cell = found.tables[0].rows[0][1]
    assert (cell.text, cell.detail) == ("0.93", "poor: at least 0.81")


def test_imputed_values_are_told(report, study):
    runs, analysis = study
    analysis["imputed_share"].loc[PEAK] = 0.004
    page = report(runs, analysis)
    told = "For the indices of the peak force, a surrogate supplied the value of 0.4 % of the runs."
    assert told in page.text


def test_groups_take_the_place_of_parameters(report):
    runs = samples.sample(64, 4)[["peak_force", "status"]]
    runs.attrs["groups"] = ["speed", "beam_material", "beam_material", "beam_material"]
    page = report(runs, samples.indices(runs, ["speed", "beam_material"]))
    assert _table(page, "Varied parameters")[2][3] == "beam material"
    assert _table(page, "Sobol indices, first order")[0][1:3] == ["Speed", "Beam material"]


def test_responses_and_parameters_of_another_solver(report):
    """A test function has neither impacts nor units."""
    random = np.random.default_rng(0)
    x = random.uniform(-np.pi, np.pi, 64)
    given = {"distribution": "uniform", "low": -np.pi, "high": np.pi}
    attrs = {"study": "ishigami", "method": "sobol", "varied": "x1", "responses": "value"}
    runs = xr.Dataset(
        {"value": ("run", np.sin(x)), "status": ("run", np.zeros(64, int))},
        {"run": np.arange(64), "x1": ("run", x, given)},
        attrs,
    )
    analysis = xr.Dataset(
        {
            "first_order": (("response", "parameter"), [[0.31]]),
            "total_order": (("response", "parameter"), [[0.56]]),
        },
        {"response": ["value"], "parameter": ["x1"]},
        attrs,
    )
    page = report(runs, analysis)
    assert _table(page, "Sobol indices, first order")[1] == ["Value", "0.31"]
    assert "uniform: low −3.142, high 3.142" in page.text


@pytest.mark.parametrize(
    ("value", "margin", "text"),
    [
        (0.7123, 0.03, "0.71 ± 0.03"),
        (0.0213, 0.0021, "0.021 ± 0.002"),
        (-0.004, 0.02, "0.00 ± 0.02"),
        (-0.034, 0.02, "−0.03 ± 0.02"),
        (0.0002, 0.0004, "below 0.001"),
        (0.0002, 0.01, "0.00 ± 0.01"),
        (0.5, np.inf, "0.50"),
        (np.nan, 0.1, "undefined"),
    ],
)
def test_digits_follow_the_interval(value, margin, text):
    assert with_margin(value, margin) == text


def test_limits_open_the_answer_and_the_report(report):
    """The 40 failed runs of 400 may all exceed it, or none."""
    runs = samples.sample(400, 4, failures=40)[["peak_force", "status"]]
    limit = {"limited": "peak_force", "limits": 35e3}
    runs = runs.assign_attrs(method="delta", responses="peak_force", **limit)
    analysis = samples.indices(runs).merge(distribution.analysis(runs))
    above = int((runs["peak_force"] > 35e3).sum())
    told = f"{100 * above / 360:.0f} % ("
    shares = f"40 of 400 draws are missing: {above / 4:.0f} % if none of them is above, "
    shares += f"{(above + 40) / 4:.0f} % if all are)"
    first = answers(runs, analysis)[0]
    assert first.startswith(f"Peak force above 35 kN: {told}")
    assert shares in first
    assert "runs above it have larger impact velocity (distance 0." in first
    page = report(runs, analysis)
    assert _titles(page)[:3] == ["answer", "limits", "ranking"]
    row = _table(page, "Probability that a response exceeds")[1]
    assert row[:5] == ["Peak force", "35 kN", "400", "40", str(above)]
    assert row[5].startswith(told)
    assert _table(page, "Parameters in runs above")[1][1].endswith("larger")
    head, row = _table(page, "Range of each response")
    at = head.index("95th percentile")
    found = analysis["quantile"].sel(response="peak_force", probability=0.95).item() / 1e3
    assert row[at].startswith(f"{found:.4g}")
    assert head[-1] == "Runs missing"
    assert row[at].endswith("no bound") or "above" in row[at]


@pytest.mark.parametrize(("above", "told"), [(0, "at most 0.92 %"), (400, "at least 99.08 %")])
def test_none_or_all_above_the_limit_is_told_as_a_bound(above, told):
    """1 - 0.025 ** (1 / 400) = 0.918 %."""
    runs = samples.sample(400, 4)[["peak_force", "status"]]
    limit = {"limited": "peak_force", "limits": 0.0 if above else 1e9}
    runs = runs.assign_attrs(method="pawn", responses="peak_force", **limit)
    words = "all" if above else "none"
    expected = f"Peak force above {'0' if above else '10⁶'} kN: {told} ({words} of 400 draws)."
    assert answers(runs, distribution.analysis(runs))[0] == expected
