"""Scatters, bars of other methods, convergence of indices and failures of a sample."""

import numpy as np
import pytest
import samples
import scipy.stats
import xarray as xr
from drawings import panel
from matplotlib.container import BarContainer

from impactlab import plot
from impactlab.figures import data, draw
from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.data import alt
from impactlab.figures.samples import conditional_mean, scatter
from impactlab.variables import attributes


@pytest.fixture
def study():
    """Two responses, four parameters, the fastest 40 of 400 runs failed."""
    runs = samples.sample(400, 4, failures=40)[["peak_force", "remote_plastic_strain", "status"]]
    return runs, samples.indices(runs)


def test_the_conditional_mean_of_a_known_law():
    random = np.random.default_rng(0)
    x = random.uniform(0.0, 1.0, 40_000)
    y = x**2 + random.normal(0.0, 0.1, x.size)
    middle, mean = conditional_mean(x, y)
    assert middle.size == 20
    # the mean of x² over a bin of width 1/20 is its middle squared, plus a twelfth of 1/20²
    np.testing.assert_allclose(mean, middle**2 + 0.05**2 / 12, atol=4 * 0.1 / np.sqrt(2000))
    # runs of one value share a bin
    x = np.repeat([0.0, 1 / 3, 2 / 3, 1.0], 100)  # the levels of Morris
    middle, mean = conditional_mean(x, 2 * x)
    np.testing.assert_allclose(middle, [0.0, 1 / 3, 2 / 3, 1.0])
    np.testing.assert_allclose(mean, 2 * middle)


def test_points_are_a_picture_and_the_file_stays_small(tmp_path):
    runs = samples.sample(20_000, 3)[["peak_force", "status"]]
    figure = scatter("peak_force").plot(runs, xr.Dataset())
    points = [line for ax in figure.axes for line in ax.lines if line.get_label() == "_runs"]
    assert len(points) == 3
    assert {len(np.asarray(line.get_xdata())) for line in points} == {2000}
    svg, _ = draw.save(figure, tmp_path, "scatter")
    assert svg.stat().st_size < 270_000
    assert {curve.curve for curve in data.drawn(figure)} == {"conditional mean"}
    assert "2000 of the 20000 runs" in scatter("peak_force").caption(runs, xr.Dataset())


def test_noise_is_pale_and_the_dummy_a_line(study):
    axes = panel(CATALOGUE["sobol_indices"].plot(*study), "Peak force")
    for bars in (entry for entry in axes.containers if isinstance(entry, BarContainer)):
        assert [bar.get_alpha() for bar in bars.patches] == [None, None, 0.45, 0.45]
    floors = [line.get_segments()[0][0][0] for line in axes.collections if line.get_linestyle()]
    assert 0.03 in np.round(floors, 6)
    # bars are told by the name of their parameter
    first = next(data.drawn(CATALOGUE["delta_indices"].plot(*study)))
    assert first.category[:2] == ["impact velocity", "yield stress of the beam"]
    delta = study[1]["delta"]
    largest_first = np.argsort(-delta.max("response").values)  # in any panel
    assert first.x.tolist() == delta.sel(response="peak_force").values[largest_first].tolist()
    # signed coefficients have the dummy on both sides
    axes = panel(CATALOGUE["regression_indices"].plot(*study), "Peak force")
    ends = {round(float(s[0][0]), 6) for line in axes.collections for s in line.get_segments()}
    assert {-0.03, 0.03} <= ends


def test_morris_in_the_unit_of_the_response(study):
    _, analysis = study
    figure = CATALOGUE["morris_plane"].plot(*study)
    axes = panel(figure, "Peak force")
    assert axes.get_xlabel() == "Mean µ* (kN)"
    points = [curve for curve in data.drawn(figure) if curve.panel == "Peak force"]
    stored = analysis.sel(response="peak_force")
    expected = 1e-3 * np.array([stored["morris_mu_star"], stored["morris_sigma"]]).T
    np.testing.assert_allclose([[p.x[0], p.y[0]] for p in points], expected)
    # a group alone has no place among morris spreads
    runs, analysis = study
    spread = analysis["morris_sigma"]
    figure = CATALOGUE["morris_plane"].plot(runs, analysis.assign(morris_sigma=np.nan * spread))
    assert "no finite values" in {text.get_text() for text in panel(figure, "Peak force").texts}


def test_convergence_of_the_indices_is_the_stored_one(study):
    _, analysis = study
    axes = panel(CATALOGUE["total_order_convergence"].plot(*study), "Peak force")
    stored = analysis["total_order_by_samples"].sel(response="peak_force")
    for at, line in enumerate(axes.lines):
        np.testing.assert_allclose(np.asarray(line.get_ydata()), stored.isel(parameter=at))
    assert "up to all 32 base samples" in CATALOGUE["total_order_convergence"].caption(*study)
    # the bands reach one interval to either side
    axes = panel(CATALOGUE["total_order_convergence"].plot(*study), "Peak force")
    stored = analysis.sel(response="peak_force")
    for at, band in enumerate(axes.collections):
        y, margin = (
            stored[name].isel(parameter=at).values
            for name in ("total_order_by_samples", "total_order_by_samples_interval")
        )
        corners = band.get_paths()[0].vertices[:, 1]
        assert set(np.round(corners, 9)) == set(np.round([*(y - margin), *(y + margin)], 9))


def test_the_share_of_failures_rises_where_they_are(study):
    figure = CATALOGUE["failure_shares"].plot(*study)
    velocity, stress, *_ = data.drawn(figure)
    np.testing.assert_allclose(velocity.y, 9 * [0.0] + [100.0])
    assert stress.y.max() < 30.0
    assert "40 of 400 runs failed" in CATALOGUE["failure_shares"].caption(*study)
    # without failures there is no map
    runs = samples.sample(64)
    assert not CATALOGUE["failure_map"].applies(runs, xr.Dataset())
    assert not CATALOGUE["failure_shares"].applies(runs, xr.Dataset())


def test_the_map_is_over_the_parameter_that_tells_failures(study):
    runs, _ = study
    caption = CATALOGUE["failure_map"].caption(*study)
    assert "impact velocity 1.00" in caption
    failed = np.isnan(runs["peak_force"].values)
    found = scipy.stats.ks_2samp(
        runs["beam_yield_stress"].values[failed], runs["beam_yield_stress"].values[~failed]
    )
    if "yield stress of the beam" in caption:
        assert f"yield stress of the beam {found.statistic:.2f}" in caption
    points = next(
        c for c in data.drawn(CATALOGUE["failure_map"].plot(*study)) if c.curve == "failed"
    )
    np.testing.assert_allclose(np.sort(points.x), np.sort(runs["velocity"].values[failed]))


@pytest.fixture
def of_words(study):
    """The runs, a parameter more: two contact laws, of which one fails three times as often."""
    runs, _ = study
    failed = np.isnan(runs["peak_force"].values)
    one = np.where(failed, np.cumsum(failed) % 4 != 0, np.arange(failed.size) % 4 == 0)
    choice = {"distribution": "choice", "values": ["mjg", "kogut_etsion"], "weights": [0.5, 0.5]}
    choice |= attributes("contact")
    law = ("run", np.where(one, "mjg", "kogut_etsion"), choice)
    runs = runs.drop_vars("contact").assign_coords(contact=law)
    return runs.assign_attrs(varied=[*runs.attrs["varied"], "contact"])


def test_words_are_categories_with_names(of_words):
    figure = scatter("peak_force").plot(of_words, xr.Dataset())
    ax = figure.axes[4]
    assert [text.get_text() for text in ax.get_xticklabels()] == ["MJG", "Kogut-Etsion"]
    assert ax.get_xlabel() == "Contact law"
    means = next(each for each in data.drawn(figure) if each.curve == "mean by word")
    assert means.category == ["MJG", "Kogut-Etsion"]
    force = 1e-3 * of_words["peak_force"].groupby("contact").mean()
    np.testing.assert_allclose(means.y, force.sel(contact=["mjg", "kogut_etsion"]))
    assert "mean by word: largest for" in alt(figure)
    ax = plot.response(of_words, "peak_force", x="contact")
    assert ax.get_xlabel() == "Contact law"


def test_failures_are_shared_out_among_words(of_words):
    *_, law = data.drawn(CATALOGUE["failure_shares"].plot(of_words, xr.Dataset()))
    failed = np.isnan(of_words["peak_force"])
    share = 100 * failed.groupby("contact").mean().sel(contact=["mjg", "kogut_etsion"])
    np.testing.assert_allclose(law.y, share)
    caption = CATALOGUE["failure_map"].caption(of_words, xr.Dataset())
    one = of_words["contact"].values == "mjg"
    apart = one[failed.values].mean() - one[~failed.values].mean()
    assert f"contact law {apart:.2f}" in caption
    CATALOGUE["failure_map"].plot(of_words, xr.Dataset())


def test_alternative_texts_tell_what_is_largest(study):
    bars = alt(CATALOGUE["sobol_indices"].plot(*study))
    assert bars.startswith("Peak force: first order: largest for impact velocity (0.711); total")
    cells = alt(CATALOGUE["sobol_second_order"].plot(*study))
    assert cells.startswith("Peak force: largest in row 1, column 1 (0.07).")
    lines = alt(CATALOGUE["total_order_convergence"].plot(*study))
    assert lines.startswith("Peak force: highest of 4: impact velocity: ")


def test_each_order_cites_its_own_estimator(study):
    runs, analysis = study
    for name in ("first_order", "total_order"):
        analysis[name].attrs["estimator"] = f"source of {name}"
    caption = CATALOGUE["sobol_indices"].caption(runs, analysis)
    assert "first order: source of first_order; total order: source of total_order." in caption
    # an empty panel is told
    for name in ("first_order", "total_order"):
        analysis[name].loc[{"response": "peak_force"}] = np.nan
    assert "Peak force: undefined: usable." in alt(CATALOGUE["sobol_indices"].plot(runs, analysis))
