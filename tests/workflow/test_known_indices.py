"""Test functions through the whole way of a study, from the file to the page."""

import re
from pathlib import Path

import numpy as np
import pytest
from known_indices import INDICES
from scipy.stats import norm

from impactlab.analysis.analyse import analyse
from impactlab.figures.catalogue import applicable
from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.study import write_report
from impactlab.study.design import design
from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.schema.readers import read_study
from impactlab.variables import FAILURES

ROOT = Path(__file__).parents[2]
G = """
title: Sobol's G function
function: g
sampling:
  method: METHOD
  seed: 0
  parameters:
"""


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Makes runs and analysis of a study file, through files as on the command line."""
    folder = tmp_path_factory.mktemp("known")

    def solve(path):
        study = read_study(path)
        write_netcdf(design(study), folder / "design.nc", "design")
        runs = execute(
            read_netcdf(folder / "design.nc", "design"), folder / "shards", Engine(workers=2)
        )
        write_netcdf(runs, folder / "runs.nc", "runs")
        runs = read_netcdf(folder / "runs.nc", "runs")
        write_netcdf(analyse(runs), folder / "analysis.nc", "analysis")
        return runs, read_netcdf(folder / "analysis.nc", "analysis"), study

    return solve


@pytest.fixture(scope="module")
def ishigami(solved):
    return solved(ROOT / "studies" / "ishigami.yaml")


@pytest.fixture
def g(solved, tmp_path):
    def solve(method, others):
        lines = [f"    x{at}: {{distribution: uniform, low: 0, high: 1}}" for at in range(1, 9)]
        text = G.replace("METHOD", f"{method}\n  {others}") + "\n".join(lines)
        text += "\n" if method == "sobol" else "\nanalysis: {resamples: 20}\n"
        (tmp_path / "g.yaml").write_text(text)
        return solved(tmp_path / "g.yaml")

    return solve


def page_of(runs, analysis, folder):
    """The report without its figures, which take seconds to draw."""
    (folder / "captions.json").write_text("{}")
    write_report(runs, analysis, folder, folder / "report.html")
    return (folder / "report.html").read_text()


def assert_within_three_standard_errors(analysis, name, known):
    half = analysis[f"{name}_interval"].isel(response=0).values
    standard = half / norm.ppf(0.5 + analysis[f"{name}_interval"].attrs["confidence"] / 2)
    off = np.abs(analysis[name].isel(response=0).values - known)
    there = np.isfinite(known)
    assert there.any()
    assert (off[there] <= 3 * standard[there] + 1e-9).all(), (name, off / standard)
    assert (standard[there] < 0.05).all()


def test_sobol_indices_are_those_known(ishigami, g):
    for _, analysis, study in (ishigami, g("sobol", "base_samples: 2048")):
        for name in ("first_order", "total_order", "second_order"):
            known = getattr(INDICES[study.function], name)
            assert_within_three_standard_errors(analysis, name, known)


METHODS = {
    "morris": ("trajectories: 20", {"morris_mu_star"}, {"morris_plane"}),
    "fast": ("samples: 2628", {"first_order", "total_order"}, {"sobol_indices"}),
    "delta": ("samples: 1000", {"delta"}, {"delta_indices"}),
    "pawn": ("samples: 1000", {"pawn"}, {"pawn_indices"}),
    "regression": ("samples: 1000", {"regression", "rank_regression"}, {"regression_indices"}),
    "rbd_fast": ("samples: 1000", {"first_order"}, {"sobol_indices"}),
    "latin": (
        "samples: 1000\n  indices: [pawn, rbd_fast, delta]",
        {"first_order", "delta", "pawn"},
        {"sobol_indices", "delta_indices", "pawn_indices"},
    ),
}


@pytest.mark.parametrize("method", METHODS)
def test_every_method_ranks_the_parameters_of_g_and_reaches_its_page(g, method, tmp_path):
    """They matter the less the larger a is: x1, x2, x3, x4, and the others hardly."""
    others, measures, figures = METHODS[method]
    runs, analysis, _ = g(method, others)
    for name in measures - {"regression", "rank_regression"}:  # these see no even function
        found = analysis[name].isel(response=0).values
        assert found[0] > found[1] > found[2] > found[4:].max(), name
        assert found.argmax() == 0
    assert figures | {"scatter_value"} <= applicable(runs, analysis).keys()
    page = page_of(runs, analysis, tmp_path)
    assert f"{runs.sizes['run']:,} runs (" in page
    assert "(grid)" not in page


def test_the_report_tells_what_is_known(ishigami, tmp_path):
    runs, analysis, _ = ishigami
    page = page_of(runs, analysis, tmp_path)
    assert re.search(
        r"x1 \(5\d.±.\d.%, 3[12].%.alone, exactly 55.8.%\), x2 \(4\d.±.\d.%, exactly 44.2.%\)", page
    )
    assert "NaN" not in page


FAILED, NAN = 40, 5


@pytest.fixture(scope="module")
def broken(ishigami):
    """Ishigami's runs with seeded failures, a constant response and one with a single NaN."""
    runs = ishigami[0]
    rng = np.random.default_rng(3)
    likely = np.flatnonzero(runs["x1"].values > 2)  # failures that have a place in the space
    failed = rng.choice(likely, FAILED, replace=False)
    status, value = runs["status"].values.copy(), runs["value"].values.copy()
    status[failed] |= FAILURES["diverged"][0]
    value[failed] = np.nan
    single = runs["value"].values.copy()
    single[NAN] = np.nan
    broken = runs.assign(
        value=runs["value"].copy(data=value),
        status=runs["status"].copy(data=status),
        constant=("run", np.full(value.size, 4.2), {"long_name": "constant", "units": "1"}),
        single_gap=("run", single, {"long_name": "with one gap", "units": "1"}),
    )
    responses = ["value", "constant", "single_gap"]
    return broken.assign_attrs(responses=responses, analyses="sensitivity"), failed


def test_failures_a_constant_and_a_nan_give_no_index_and_are_told(broken, tmp_path):
    runs, failed = broken
    analysis = analyse(runs)
    assert np.isnan(analysis["first_order"]).all()
    assert {"failure_shares", "failure_map"} <= applicable(runs, analysis).keys()
    page = page_of(runs, analysis, tmp_path)
    assert f"Of {runs.sizes['run']} runs, {FAILED} failed, 1 without an answer." in page
    assert "the run diverged" in page
    assert f"run {failed.min()}" in page
    assert "NaN" not in page


def test_imputed_indices_are_near_the_known_ones_and_marked(broken, ishigami, tmp_path):
    runs, _ = broken
    analysis = analyse(runs.assign_attrs(failed_runs="impute"))
    known = INDICES["ishigami"].total_order
    np.testing.assert_allclose(analysis["total_order"].sel(response="value"), known, atol=0.06)
    whole = ishigami[1]["total_order"].isel(response=0).values
    np.testing.assert_allclose(analysis["total_order"].sel(response="value"), whole, atol=0.01)
    share = analysis["imputed_share"]
    assert share.sel(response="value").item() == pytest.approx(FAILED / runs.sizes["run"])
    assert share.sel(response="single_gap").item() >= 1 / runs.sizes["run"]
    assert np.isnan(analysis["total_order"].sel(response="constant")).all()
    page = page_of(runs, analysis, tmp_path)
    assert "a surrogate supplied the value of" in page
    assert "the response does not vary" in page


def test_the_committed_study_states_what_is_known():
    text = (ROOT / "studies" / "ishigami.yaml").read_text()
    known = INDICES["ishigami"]
    for letter, indices in (("S", known.first_order), ("T", known.total_order)):
        for at, index in enumerate(indices, 1):
            assert f"{letter}{at} = {index:.4f}".replace("0.0000", "0") in text
    assert f"S13 = {known.second_order[0, 2]:.4f}" in text
