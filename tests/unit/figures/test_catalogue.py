"""Every figure of the catalogue, on every kind of study."""

from typing import Any

import numpy as np
import pytest
import samples
import witnesses
import xarray as xr
from drawings import (
    assert_panels_and_legends_are_on_the_page_and_apart,
    assert_text_is_apart,
    assert_texts_are_fit_for_print,
    laid_out,
)
from made_runs import design_of, made_once, with_answers

from impactlab.analysis import distribution
from impactlab.fem3d.figures.witness import FIGURES
from impactlab.figures import data, labels, style
from impactlab.figures.catalogue import CATALOGUE, LEAD, applicable
from impactlab.figures.distributions import exceedance
from impactlab.figures.samples import scatter
from impactlab.methods import INDICES
from impactlab.solver.contact import LAWS
from impactlab.solver.outputs import SERIES
from impactlab.variables import RESPONSES, described

FOLLOWED = {"residual_deflection": "maximum_deflection"}
EXPECTED = {
    "velocity_study": {
        "first_contact",
        "force_history",
        "force_indentation",
        "displacement_history",
        "force_indentation_by_law",
        "contact_duration",
        "plastic_strain",
        "plastic_strain_depth",
        "parameter_effects",
    },
    "laws_study": {
        "contact_laws",
        "force_indentation_by_law",
        "first_contact",
        "force_history",
        "force_indentation",
        "contact_duration",
        "parameter_effects",
    },
    "strikes_study": {"strike_series", "contact_duration", "parameter_effects"},
    "material_study": {"parameter_effects"},
    "shear_study": {"shear", "parameter_effects"},
    "words_study": {"compared_values"},
    "discretisation_study": {"nodes_convergence", "points_convergence", "convergence_cost"},
    "time_step_study": {"time_step_convergence"},
    "witness_study": {
        "witness",
        "contact_duration",
        "parameter_effects",
        "nodes_convergence",
        "element_size_convergence",
    },
    "parts_study": {
        "witness_parts",
        "first_contact",
        "force_history",
        "force_indentation",
        "nodes_convergence",
        "element_size_convergence",
    },
    "sample_study": {
        "response_distributions",
        "cumulative_distributions",
        "exceedance_peak_force",
        *(f"scatter_{name}" for name in samples.ASKED),
        "sobol_indices",
        "sobol_second_order",
        "first_order_convergence",
        "total_order_convergence",
        "indices_over_time",
        "morris_plane",
        "delta_indices",
        "hsic_indices",
        "pawn_indices",
        "shapley_effects",
        "target_hsic_indices",
        "regression_indices",
        "surrogate_indices",
        "failure_shares",
        "failure_map",
    },
    "sobol_study": {
        "response_distributions",
        "sobol_indices",
        "sobol_second_order",
        "surrogate_validation",
        *(f"scatter_{name}" for name in RESPONSES),
    },
}
"""Which figures apply to which study. A figure that is not listed is tried on the first study it
applies to."""
LISTED = set().union(*EXPECTED.values())
FIRST = {name: study for study, names in reversed(EXPECTED.items()) for name in sorted(names)}
"""The first study that each figure applies to."""
NOT_WITHOUT_RUNS = {"failure_shares", "failure_map", "sobol_second_order"}
LIKE_SOBOL_INDICES = {"delta_indices", "pawn_indices", "shapley_effects", "target_hsic_indices"}
"""Drawn by the same function with the same names; hsic, regression and surrogate are tried."""
CASES = [
    (study, name)
    for name, study in FIRST.items()
    if name not in LIKE_SOBOL_INDICES | {"first_order_convergence"}
    if not name.startswith("scatter") or name == "scatter_peak_force"
] + [("", name) for name in CATALOGUE | FIGURES if name not in LISTED]
AGAIN = [
    ("laws_study", "force_indentation_by_law"),
    ("laws_study", "first_contact"),
    ("laws_study", "contact_duration"),
    ("material_study", "parameter_effects"),
    ("shear_study", "parameter_effects"),
    ("parts_study", "first_contact"),
]
"""Figures with other curves or legends in a study that is not their first one."""
WHOLE = {"parameter_effects", "nodes_convergence", "regression_indices", "contact_laws"}
"""Figures that are laid out with a panel for each of up to 17 responses, which takes seconds."""
FEW = ["peak_force", "contact_duration", "peak_plastic_strain", "number_of_contacts"]


@made_once
def sample_study():
    """Nine parameters with long names, eight responses, failures, and every index there is."""
    runs = samples.sample(400, failures=9)
    runs.attrs |= {"limited": "peak_force", "limits": 35e3}
    latin = runs.assign_attrs(method="delta")
    analysis = samples.indices(runs).merge(distribution.analysis(latin))
    for name in ("shapley", "hsic", "target_hsic"):
        for end in ("", "_interval"):
            analysis[f"{name}{end}"] = analysis[f"first_order{end}"]
    return runs, analysis


@made_once
def words_study():
    """Three laws at two velocities and with two ends: no parameter has a curve."""
    varied = {
        "contact": list(LAWS[:3]),
        "velocity": [1.0, 5.0],
        "support_left": ["pinned", "clamped"],
    }
    runs = with_answers(design_of(varied, study="words", method="grid"))
    return described(runs), xr.Dataset(attrs=runs.attrs)


@made_once
def strikes_study():
    """Twelve strikes at three velocities, steady from the ninth on but for the fastest."""
    design = design_of({"velocity": [0.5, 1.0, 5.0]}, study="strikes", method="grid")
    runs, number = with_answers(design), np.arange(1.0, 13.0)
    growth = xr.DataArray(np.minimum(number, 8.0) / 8.0, {"strike": number}, "strike")
    for name in SERIES:
        runs[f"{name}_over_strikes"] = runs[FOLLOWED.get(name, name)] * growth
    runs["steady_strike"] = ("velocity", [9.0, 9.0, np.nan])
    return described(runs), xr.Dataset(attrs=runs.attrs)


@made_once
def witness_study():
    """Beam models beside a 3-D witness at three velocities."""
    return witnesses.against_velocity()


@made_once
def parts_study():
    """The same with and without yielding."""
    return witnesses.taken_apart()


def _study(request, study, name):
    """Return the study of a case, or the first to which a figure without a study applies."""
    for each in [study] if study else EXPECTED:
        datasets: tuple[xr.Dataset, xr.Dataset] = request.getfixturevalue(each)
        if study or _figure(name, datasets[0]).applies(*datasets):
            return datasets
    pytest.fail(f"the figure {name} applies to none of the studies {list(EXPECTED)}")


def _figure(name, runs):
    if name.startswith("scatter_"):
        return scatter(name.removeprefix("scatter_"))
    if name.startswith("exceedance_"):
        return exceedance(name.removeprefix("exceedance_"))
    return (CATALOGUE | FIGURES)[name]


def _few(name, runs, analysis, names=FEW):
    """Return the runs with few responses where those are enough for the figure."""
    few = runs.drop_vars(set(runs) & set(RESPONSES) - set(names))
    return few if _figure(name, runs).applies(few, analysis) else runs


@pytest.mark.parametrize("study", EXPECTED)
def test_figures_apply_to_the_studies_they_are_for(study, request):
    datasets = request.getfixturevalue(study)
    assert set(applicable(*datasets)) & LISTED == EXPECTED[study]


def test_nothing_applies_to_empty_datasets():
    empty = xr.Dataset()
    assert applicable(empty, empty) == {}


@pytest.mark.parametrize(("study", "name"), CASES + AGAIN)
def test_a_figure_is_legible_at_paper_width(study, name, request):
    runs, analysis = _study(request, study, name)
    if study != FIRST.get(name, "") or name not in WHOLE:
        runs = _few(name, runs, analysis)
    drawn = laid_out(_figure(name, runs).plot(runs, analysis))
    width = drawn.get_figwidth() / style.MILLIMETRE
    assert min(abs(width - style.SINGLE), abs(width - style.DOUBLE)) < 1e-6
    _assert_labels_carry_units(drawn)
    assert_texts_are_fit_for_print(drawn)
    assert_text_is_apart(drawn)
    assert_panels_and_legends_are_on_the_page_and_apart(drawn)


def _assert_labels_carry_units(drawn):
    """An axis with ticks has its unit in its label, its title, or a label for all panels."""
    bars = [axes.get_xlabel() for axes in drawn.axes if hasattr(axes, "_colorbar")]
    shared = [drawn.get_supxlabel(), drawn.get_supylabel(), *bars]
    for axes in drawn.axes:
        labels = [axes.get_xlabel(), axes.get_ylabel(), axes.get_title(loc="left"), *shared]
        assert any(label.endswith(")") and "(" in label for label in labels), labels
        for label in labels:
            assert not label or label[0].isupper() or label.startswith("3-D")


def test_the_mean_history_is_data_beside_the_indices(sample_study):
    curves = data.drawn(CATALOGUE["indices_over_time"].plot(*sample_study))
    means = [curve.curve for curve in curves if curve.panel.endswith(", mean")]
    assert means == ["mean"] * sample_study[1].sizes["history"]


@pytest.mark.parametrize(
    ("study", "name"),
    [(study, name) for study, name in CASES if name not in NOT_WITHOUT_RUNS],
    ids=str,
)
def test_all_runs_failed_leaves_no_data_and_says_so(study, name, request, failing):
    runs, analysis = _study(request, study, name)
    everything = {dim: slice(None) for dim in runs["status"].dims}
    record = _figure(name, runs)
    runs = failing(_few(name, runs, analysis, FEW[:1]), everything)
    analysis = _undefined(analysis)
    figure = laid_out(record.plot(runs, analysis))
    lines = [line for axes in figure.axes for line in axes.lines if not _guide(line.get_label())]
    assert [line for line in lines if len(line.get_xdata()) > 2] == []
    total: Any = runs["status"].size
    if name == "element_size_convergence":  # 3-D runs alone, whatever the beam models' nodes
        total = runs["status"].sel(beam_model="solid").isel(nodes=0).size
    assert f"{total} of {total} runs are missing" in record.caption(runs, analysis)


def _undefined(analysis):
    return analysis.map(lambda array: array * np.nan if array.dtype.kind == "f" else array)


def _guide(label):
    return str(label).startswith("_guide")


def test_one_panel_of_the_headlines_response_leads(velocity_study, sample_study):
    runs, analysis = velocity_study
    runs.attrs["title"] = "The contact duration against the velocity"
    lead, *_ = applicable(runs, analysis).values()
    assert lead.name == LEAD
    assert lead.title.endswith(": contact duration")
    (panel,) = lead.plot(runs, analysis).axes
    assert panel.get_title(loc="left") == "Contact duration (ms)"
    few = runs[["peak_force", "contact_duration", "status"]]
    assert LEAD not in applicable(few, analysis), "two panels are legible"
    runs, analysis = sample_study
    runs.attrs["title"] = "The peak plastic strain"  # whose indices are not usable
    analysis["sensitivity_verdict"].loc["peak_plastic_strain"] = 1
    assert applicable(runs, analysis)[LEAD].title == "Sobol indices: peak force"


@pytest.mark.parametrize("names", [["hsic", "shapley"], ["shapley", "hsic"]])
def test_the_figure_of_the_index_that_ranks_leads(sample_study, names):
    runs, analysis = sample_study
    runs.attrs["indices"] = names
    title = INDICES[names[0]].family.title
    assert applicable(runs, analysis)[LEAD].title.startswith(title)


def test_the_leading_panel_ranks_by_its_own_response(sample_study):
    runs, analysis = sample_study
    runs.attrs["title"] = "The peak force"
    index = analysis["total_order"]
    index[:] = 0.1
    index.loc["peak_force", "beam_depth"] = 0.5
    index.loc["contact_duration", "sphere_radius"] = 0.9
    (panel,) = applicable(runs, analysis)[LEAD].plot(runs, analysis).axes
    assert panel.get_yticklabels()[0].get_text() == "depth of the beam"


@pytest.mark.parametrize(
    ("study", "title"),
    [
        ("discretisation_study", "Convergence in nodes: peak force"),
        ("time_step_study", "Convergence in the time step: peak force"),
    ],
)
def test_one_panel_leads_a_convergence_study(study, title, request):
    runs, analysis = request.getfixturevalue(study)
    lead, *_ = applicable(runs, analysis).values()
    assert (lead.name, lead.title) == (LEAD, title)
    (panel,) = lead.plot(runs, analysis).axes
    assert panel.get_title(loc="left") == "Peak force"


@pytest.mark.parametrize("name", [name for study, name in CASES if study == "sample_study"])
def test_a_panel_alone_fits_a_column(name, sample_study):
    runs, analysis = sample_study
    record = _figure(name, runs)
    with style.alone(0, style.SINGLE):
        drawn = laid_out(record.plot(_few(name, runs, analysis), analysis))
    assert drawn.get_figwidth() == pytest.approx(style.SINGLE * style.MILLIMETRE)
    assert_texts_are_fit_for_print(drawn)
    assert_text_is_apart(drawn)
    assert_panels_and_legends_are_on_the_page_and_apart(drawn)


def test_words_are_compared_side_by_side(words_study):
    """Every run is a marker in the row of its law; force that hardly differs looks alike."""
    runs, analysis = words_study
    runs = runs.assign(peak_force=31e3 + 1e-3 * runs["peak_force"])
    ax = CATALOGUE["compared_values"].plot(runs, analysis).axes[0]
    force = {tuple(np.round(line.get_xdata(), 9)) for line in ax.lines}
    expected = (1e-3 * runs["peak_force"]).stack(curve=["velocity", "support_left"])
    assert force == set(map(tuple, np.round(expected.values.T, 9)))
    rows = [text.get_text() for text in ax.get_yticklabels()]
    assert rows == [labels.brief(runs["contact"], row) for row in range(3)]
    assert np.ptp(ax.get_xlim()) > 0.09 * 31
