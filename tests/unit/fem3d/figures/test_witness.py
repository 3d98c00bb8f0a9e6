"""Beam models beside a planted witness: figures, and what the effects come to."""

import numpy as np
import pytest
import witnesses
import xarray as xr

from impactlab.fem3d.figures import witness
from impactlab.fem3d.figures.witness import FIGURES
from impactlab.fem3d.report import _cell, sections
from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.data import drawn
from impactlab.figures.labels import display

SPEEDS = np.array(witnesses.SPEEDS)


@pytest.fixture(scope="module")
def study():
    return witnesses.against_velocity()


def test_each_side_is_the_finest_with_its_own_uncertainty(study):
    beam = witness.side(*study, "peak_force", "euler_bernoulli")
    solid = witness.side(*study, "peak_force", "solid")
    assert beam.value == pytest.approx(1.05e4 * 1.01 * SPEEDS)
    assert solid.value == pytest.approx(1e4 * 1.01 * SPEEDS)
    assert solid.uncertainty == pytest.approx(1.25 * 0.01e4 * SPEEDS, rel=1e-3)
    gap = witness.difference([beam], [solid])
    assert gap.value == pytest.approx(0.05)
    assert gap.uncertainty == pytest.approx(1.05 * 2 * 1.25 * 0.01 / 1.01, rel=1e-3)
    # the table says value uncertainty and difference
    (section,) = sections(*study)
    table = section.tables[0]
    assert table.head == ["Impact velocity", "3-D FE model", "Euler-Bernoulli", "Timoshenko"]
    assert table.rows[1][1].text == "10.1 ± 1.2 %"
    assert table.rows[1][2].detail == "+5 % against the 3-D FE model"
    assert table.rows[1][3].detail == "−2 % against the 3-D FE model"
    # it needs the solid beside others at three velocities
    runs, analysis = study
    assert witness.differ(runs)
    assert not witness.differ(runs.isel(velocity=slice(2)))
    assert not witness.differ(runs.sel(beam_model=["solid"]))
    assert not witness.differ(runs.sel(beam_model=witnesses.MODELS[:2]))
    assert not FIGURES["witness"].applies(runs.sel(beam_model=witnesses.MODELS[:2]), analysis)


def test_the_figure_has_values_above_and_differences_below(study):
    figure = FIGURES["witness"].plot(*study)
    force, _, below, _ = figure.axes
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["3-D FE model", "Euler-Bernoulli", "Timoshenko"]
    assert np.asarray(force.lines[0].get_ydata()) == pytest.approx(10.1 * SPEEDS)
    shown = [np.asarray(marks.lines[0].get_ydata()) for marks in below.containers]
    assert shown == [pytest.approx([5.0] * 3), pytest.approx([-2.0] * 3)]
    assert FIGURES["element_size_convergence"].applies(*study)
    assert not CATALOGUE["convergence_cost"].applies(*study)
    # Differences in % with their bars, at the velocities themselves.
    below = [one for one in drawn(FIGURES["witness"].plot(*study)) if "Δ" in one.panel]
    assert [one.panel for one in below[::2]] == ["Δ peak force", "Δ contact duration"]
    assert {one.y_label for one in below} == {"Difference from the 3-D FE model (%)"}
    for one in below:
        assert one.x == pytest.approx(SPEEDS)
    width = 100.0 * 1.05 * 2 * 1.25 * 0.01 / 1.01
    assert below[0].low == pytest.approx(5.0 - width, rel=1e-3)
    assert below[0].high == pytest.approx(5.0 + width, rel=1e-3)
    # no curve is of a refinement that its model does not know
    figure = CATALOGUE["contact_duration"].plot(*study)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["Euler-Bernoulli", "Timoshenko", "3-D FE model", "slope −1/5"]


def test_differences_are_told_in_sentences_that_the_caption_has(study, taken_apart):
    runs, analysis = study[0].copy(deep=True), study[1]
    runs["peak_force"].loc[{"beam_model": "timoshenko", "velocity": 5.0}] *= 1.1
    force, _ = witness.findings(runs, analysis)
    between = "Difference of the peak force from the 3-D FE model between 0.5 and 5 m/s: "
    models = "5 % with Euler-Bernoulli and −2 to 7.8 % with Timoshenko"
    assert force == f"{between}{models} (numerically ± 2.7 % or less)."
    analysis = analysis.copy(deep=True)
    analysis["nodes_uncertainty"].loc[{"velocity": 1.0}] = np.inf
    force, _ = witness.findings(runs, analysis)
    assert force == f"{between}{models} (numerically without a bound in part)."
    assert force in FIGURES["witness"].caption(runs, analysis)
    assert len(witness.findings(*taken_apart)) == 2
    assert witness.findings(runs.isel(velocity=slice(2)), analysis) == []


def test_points_without_a_bound_have_no_bar(study):
    runs, analysis = study[0], study[1].copy(deep=True)
    analysis["nodes_uncertainty"].loc[{"velocity": 1.0}] = np.inf
    below = [one for one in drawn(FIGURES["witness"].plot(runs, analysis)) if "Δ" in one.panel]
    assert np.isnan(below[0].low).tolist() == [False, True, False]


def test_elements_may_be_counted_over_the_radius(study):
    """The same numbers, and the sizes that they stand for on the axis."""
    counted = witnesses.counted(study[0])
    for model in witnesses.MODELS:
        for name in ("peak_force", "contact_duration"):
            one, other = (witness.side(*each, name, model) for each in (study, counted))
            assert one.value == pytest.approx(other.value)
            assert one.uncertainty == pytest.approx(other.uncertainty, rel=1e-6)
    assert FIGURES["element_size_convergence"].applies(*counted)
    figure = FIGURES["element_size_convergence"].plot(*counted)
    assert "contact radius (%)" in figure.get_supxlabel()
    sizes = np.asarray(figure.axes[0].lines[0].get_xdata())
    assert sorted(sizes) == pytest.approx([12.5, 25.0, 50.0])


def test_a_missing_run_leaves_a_gap_and_is_counted(study):
    runs = study[0].copy(deep=True)
    runs["status"].loc[{"velocity": 5.0, "beam_model": "solid", "element_size": 2.5e-4}] = 256
    analysis = witnesses.analysed(runs)
    assert np.isnan(witness.side(runs, analysis, "peak_force", "solid").value[-1])
    assert "3-D model stopped" in FIGURES["witness"].caption(runs, analysis)
    FIGURES["witness"].plot(runs, analysis)
    (section,) = sections(runs, analysis)
    assert section.tables[0].rows[-1][1].text == "missing"


def test_what_is_not_the_same_quantity_is_not_compared(study):
    runs = study[0].rename(peak_force="plastic_dissipation")
    runs.attrs["responses"] = ["plastic_dissipation", "contact_duration"]
    (section,) = sections(runs, witnesses.analysed(runs))
    alike, unlike = section.tables
    assert "not compared" in unlike.caption
    assert {cell.detail for row in unlike.rows for cell in row} == {""}
    assert "not compared" not in alike.caption


def test_a_width_is_told_unless_it_is_that_of_round_off():
    widths, unit = (
        np.array([1e-9, 0.02, np.inf]),
        display(xr.DataArray(2.0, name="number", attrs={"units": "1"})),
    )
    side = witness.Side(np.full(3, 2.0), widths)
    assert [_cell(unit, side, side, at, True).text for at in range(3)] == ["2", "2 ± 1 %", "2 ± ?"]


@pytest.fixture(scope="module")
def taken_apart():
    return witnesses.taken_apart()


def test_the_effects_multiply_to_the_whole(taken_apart):
    found = witness.effects(*taken_apart, "peak_force")
    shares = {key: float(each.value) for key, each in found.items()}
    assert shares["shear"] == pytest.approx(0.98 / 1.05 - 1.0)
    assert shares["flexibility"] == pytest.approx(1.0 / 0.98 - 1.0)
    assert shares["law"] == pytest.approx(0.8 / 0.9 - 1.0)
    assert shares["all"] == pytest.approx(0.8 / (1.05 * 0.9) - 1.0)
    product = np.prod([1.0 + shares[key] for key in ("shear", "flexibility", "law")])
    assert product == pytest.approx(1.0 + shares["all"])
    assert float(found["law"].uncertainty) > float(found["shear"].uncertainty) > 0.01
    # their figure and table
    figure = FIGURES["witness_parts"].plot(*taken_apart)
    left, right = figure.axes
    assert len(left.lines) == 4
    shares = np.asarray(right.containers[0].lines[0].get_xdata())
    found = [one for one in drawn(figure) if one.curve == "peak force"]
    assert (found[0].category, found[0].y_label) == (list(witness.EFFECTS.values()), "")
    assert shares[2] == pytest.approx(100.0 * (0.8 / 0.9 - 1.0))
    assert "−11 % by the contact law in yielding" in FIGURES["witness_parts"].caption(*taken_apart)
    (section,) = sections(*taken_apart)
    # planted: each answer is uncertain by 1.25 % / 1.01; an effect by the sum of its answers
    force = [row[1].text for row in section.tables[0].rows]
    assert force == ["−6.7 % ± 2.3 %", "+2 % ± 2.5 %", "−11 % ± 4.4 %", "−15 % ± 2.1 %"]
