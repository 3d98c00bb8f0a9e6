"""The answer that opens a report."""

import numpy as np
import pytest
import samples
import xarray as xr

import impactlab as il
from impactlab.analysis import sensitivity
from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.axes import NODES
from impactlab.figures.convergence import _NODES as NODES_FIGURE
from impactlab.figures.measures import SOBOL
from impactlab.report.answer import LINES, answers, entries
from impactlab.report.convergence import convergence
from impactlab.report.ranking import without_effect
from impactlab.variables import described


def test_of_a_sample_names_what_matters_with_share_and_interval():
    runs = samples.sample(64, 4)[["peak_force", "contact_duration", "status"]]
    analysis = samples.indices(runs).drop_dims("history")
    analysis["total_order_numerical"][:] = 0.0
    analysis["total_order"][:] = [0.71, 0.12, 0.001, 0.0]
    analysis["total_order_interval"][:] = [0.03, 0.02, 0.0001, 0.0001]
    analysis["sensitivity_verdict"].loc["contact_duration"] = 0
    headline, second, third = answers(runs, analysis)
    assert headline == (
        "The impact velocity (71 ± 3 %) and the yield stress of the beam (12 ± 2 %) cause most of "
        "the scatter of the peak force."
    ), "what holds less than a tenth of the largest is not in the headline"
    assert second == (
        "Contact duration: impact velocity (71 ± 3 %), yield stress of the beam (12 ± 2 %)."
    )
    assert third == (
        "No effect on any response: isotropic hardening modulus of the beam and kinematic "
        "hardening modulus of the beam (below 1 % each)."
    )
    analysis["total_order_interval"].loc["contact_duration"][2:] = 0.02
    assert "No effect" not in " ".join(answers(runs, analysis)), "the interval leaves room for one"
    runs["peak_force"][:2] = np.nan
    assert answers(runs, analysis)[-1] == "Missing runs: peak force (2 of 64)."


def test_of_a_sample_leads_with_a_response_that_is_usable():
    runs = samples.sample(64, 4)[["peak_force", "contact_duration", "status"]]
    analysis = samples.indices(runs).drop_dims("history")
    analysis["sensitivity_verdict"].loc["contact_duration"] = 0
    runs.attrs["title"] = "The contact duration of hard impacts"
    assert "the scatter of the contact duration" in answers(runs, analysis)[0]
    analysis["sensitivity_verdict"].loc["contact_duration"] = 1
    lines = answers(runs, analysis)
    assert "the scatter of the peak force" in lines[0]
    assert lines[-1] == "Do not rely on the indices of: contact duration (mostly constant)."
    analysis["sensitivity_verdict"][:] = 1
    assert answers(runs, analysis)[0] == "No sensitivity index of this study is usable."


def test_shares_whose_intervals_reach_below_half_do_not_cause_most():
    runs = samples.sample(64, 4)[["peak_force", "status"]]
    analysis = samples.indices(runs).drop_dims("history")
    analysis["total_order"][:] = [0.55, 0.04, 0.03, 0.02]
    analysis["total_order_interval"][:] = [0.03, 0.01, 0.01, 0.01]
    assert " causes most of the scatter" in answers(runs, analysis)[0]
    analysis["total_order_interval"][:] = [0.08, 0.01, 0.01, 0.01]
    assert " causes the largest part of the scatter" in answers(runs, analysis)[0]


@pytest.mark.long
def test_a_parameter_of_one_per_cent_is_rarely_called_without_effect(tmp_path):
    """x4 of Sobol's G function has a total order of 1.05 %, x8 one of 0.01 %."""
    without = {"x4": 0, "x8": 0}
    parameters = {f"x{i}": il.Uniform(0, 1) for i in range(1, 9)}
    for seed in range(200):
        sampling = il.Sobol(base_samples=64, seed=seed, parameters=parameters)
        study = il.Study(title="G", function="g", sampling=sampling, results=tmp_path / str(seed))
        analysis = sensitivity.analysis(study.run(workers=1))
        named = str(without_effect(analysis, SOBOL, ["value"]))
        for name in without:
            without[name] += name in named
    assert without["x4"] <= 10
    assert without["x8"] == 200


SPEEDS = np.geomspace(0.5, 16.0, 6)


def _grid(values, **levels):
    """Return runs of a grid with one response; levels: values by parameter."""
    array = np.broadcast_to(np.asarray(values, float), [len(level) for level in levels.values()])
    attrs = {"varied": list(levels), "responses": ["peak_force"], "title": "A study"}
    runs = xr.Dataset({"peak_force": ([*levels], array, {"units": "N"})}, levels, attrs)
    status = xr.zeros_like(runs["peak_force"], dtype=np.int32).rename("status")
    return described(runs.assign(status=status))


OVER = "From 0.5 to 16 m/s of impact velocity the peak force "
COURSES = {
    "monotone": (lambda v: 1e3 * v, OVER + "rises from 0.5 to 16 kN."),
    "flat": (lambda v: 5e3 + 0 * v, "The peak force is the same in every run, 5 kN."),
    "levels": (
        lambda v: 9e3 - 8e3 * (SPEEDS.size * [0.0] + np.array([1, 0.1, 0.01, 0, 0, 0])),
        OVER + "rises from 1 kN and levels off at 9 kN.",
    ),
    "jump": (
        lambda v: np.where(v > 5, 30e3, 10e3) + 10 * v,
        OVER + "rises from 10 to 10 kN, then jumps to 30.1 kN between 4 and 8 m/s.",
    ),
    "turn": (
        lambda v: np.array([1e3, 2e3, 4e3, 5e3, 3e3, 2e3]),
        OVER + "rises from 1 to 5 kN at 4 m/s, then falls to 2 kN.",
    ),
    "noise": (
        lambda v: np.array([3e3, 1e3, 4e3, 1.5e3, 5e3, 2e3]),
        OVER + "varies between 1 and 5 kN without a clear trend.",
    ),
    "missing": (lambda v: np.nan * v, "The peak force is missing in every run."),
}


@pytest.mark.parametrize("name", COURSES)
def test_of_a_grid_says_how_a_response_goes_along_a_parameter(name):
    values, headline = COURSES[name]
    assert answers(_grid(values(SPEEDS), velocity=SPEEDS))[0] == headline


def test_two_regimes_are_told_apart_by_what_separates_them():
    rising, jumping = 1e3 * SPEEDS, np.where(SPEEDS > 5, 30e3, 10e3) + 10 * SPEEDS
    runs = _grid([rising, jumping], contact=["hertz", "stronge"], velocity=SPEEDS)
    first, *others = answers(runs)
    assert first == (
        OVER + "rises from 0.5 to 16 kN with Hertz; with Stronge it rises from 10 to 10 kN, then "
        "jumps to 30.1 kN between 4 and 8 m/s."
    )
    assert others == [
        "Contact law, Stronge instead of Hertz: peak force 10–30.2 kN instead of 0.5–16 kN."
    ]


def test_each_factor_has_its_sentence_without_effect_too():
    depths, moduli = np.array([0.01, 0.02, 0.03, 0.04]), np.array([1e9, 2e9])
    values = 1e3 * SPEEDS[:, None, None] * (1 + 5 * depths[:, None]) + 0 * moduli
    runs = _grid(
        values, velocity=SPEEDS, beam_depth=depths, beam_isotropic_hardening_modulus=moduli
    )
    first, second, third = answers(runs)
    assert first == OVER + "rises in every case, from 0.525–0.6 kN to 16.8–19.2 kN."
    assert second == "Depth of the beam, 10 to 40 mm: peak force +14 %."
    assert third == (
        "Isotropic hardening modulus of the beam: no effect on any response (below 0.1 %)."
    )


def test_an_effect_on_small_values_alone_is_one():
    """A share of the largest value would call it none."""
    values = 1e6 * SPEEDS**3 * [[1.0], [1.0]]
    values[1, 0] *= 1.5
    first, second = answers(_grid(values, contact=["hertz", "stronge"], velocity=SPEEDS))
    assert "with Stronge it rises from 188 to 4" in first
    assert second == "Contact law, Stronge instead of Hertz: peak force 0 to +50 %."


def test_a_trend_is_that_of_complete_curves():
    """The mean of the other curves falls where large answers fail at the high end."""
    depths = np.array([0.01, 0.02, 0.03, 0.04])
    values = 1e3 * SPEEDS[:, None] ** 0.2 * np.array([1.0, 1.0, 1.0, 20.0])
    values[3:, 3] = np.nan
    first, *_, last = answers(_grid(values, velocity=SPEEDS, beam_depth=depths))
    assert " the peak force rises " in first
    assert last == "Doubtful: peak force (missing in 3 runs)."


def test_an_interaction_alone_is_given_no_direction():
    depths = np.array([0.01, 0.02, 0.03, 0.04])
    values = 9e3 + 100 * (SPEEDS[:, None] - SPEEDS.mean()) * np.array([-1.5, -0.5, 0.5, 1.5])
    first, *_ = answers(_grid(values, velocity=SPEEDS, beam_depth=depths))
    assert first == (
        "The peak force, 7.39 to 10.6 kN, depends on impact velocity and depth of the beam "
        "together: none of them alone sets its trend."
    )


def test_words_alone_are_ranked_by_their_mean():
    laws = ["hertz", "stronge", "thornton"]
    first, *_ = answers(_grid([3e3, 1e3, 2e3], contact=laws))
    assert first == "The peak force is least with Stronge (1 kN), largest with Hertz (3 kN)."


def test_of_a_grid_the_other_responses_follow(velocity_study):
    runs, analysis = velocity_study
    lines = answers(runs, analysis)
    assert 2 <= len(lines) <= LINES
    assert lines[0].startswith("From 0.25 to 20 m/s of impact velocity the peak force rises from")
    assert any("Fall with impact velocity: contact duration (0.212 to 0.528" in x for x in lines)
    assert answers(runs) == lines, "runs alone are analysed"
    unknown = "The numerical uncertainty is not known"
    assert unknown in entries(runs, analysis)[2]
    names = list(runs.attrs["responses"])
    shares = xr.DataArray(np.full(len(names), 0.01), {"response": names}, "response")
    assert unknown not in entries(runs, analysis.assign(numerical_uncertainty=shares))[2]


def test_of_a_convergence_study_gives_the_least_grid_however_bad_others_are():
    nodes, counts = np.array([51, 101, 201, 401, 801]), np.array([2, 5, 9])
    smooth = 1.0 + 50.0 / (nodes - 1.0) ** 2
    wild = 1.0 + 0.1 * (-1.0) ** np.arange(5)
    force = np.array([wild, smooth + 0.001, smooth])
    strain = np.array([wild, wild, wild])
    runs = xr.Dataset(
        {
            "peak_force": (("points", "nodes"), 1e4 * force, {"units": "N"}),
            "remote_plastic_strain": (("points", "nodes"), strain, {"units": "1"}),
            "status": (("points", "nodes"), np.zeros((3, 5), np.int32)),
        },
        {"points": counts, "nodes": nodes},
        {"varied": ["points", "nodes"], "responses": ["peak_force", "remote_plastic_strain"]},
    )
    analysis = NODES.analysis(runs).assign(points.analysis(runs))
    first, second = answers(runs, analysis)
    assert first.startswith(
        "With 101 nodes and 5 points, and on finer grids, the peak force is within 1 % (± 0."
    )
    assert first.endswith("observed order 2 in the nodes).")
    assert second == "On no grid of this study: remote plastic strain (divergent in nodes)."
    # the caption of the figure and the table of the report name the same grids
    caption = NODES_FIGURE.sentences(runs, analysis)[0]
    assert caption.endswith(
        ": peak force from 101 nodes and 5 points; remote plastic strain on no grid of this study."
    )
    rows = convergence(runs, analysis)[0].tables[0].rows
    assert rows[0][1] == "101 nodes and 5 points"
    assert "none of this study" in str(rows[1][1])


def test_a_grid_of_the_impact_gives_effects_first_and_then_its_convergence():
    nodes = np.array([51, 101, 201, 401])
    values = 1e3 * SPEEDS[:, None] * (1.0 + 50.0 / (nodes - 1.0) ** 2)
    runs = _grid(values, velocity=SPEEDS, nodes=nodes)
    first, *_, last = answers(runs, NODES.analysis(runs))
    assert first == OVER + "rises from 0.5 to 16 kN."
    assert last.startswith("Convergence: With 101 nodes, and on finer grids, the peak force is")
