"""Test functions through the whole way of a study, from the file to the page."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from impactlab.analysis.analyse import analyse
from impactlab.figures.draw import draw_all
from impactlab.reference.functions import FUNCTIONS
from impactlab.report.report import write_report
from impactlab.study.declaration import read_study
from impactlab.study.engine import Engine
from impactlab.study.execution import execute
from impactlab.study.netcdf import read_netcdf, write_netcdf
from impactlab.study.sampling import design

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
        write_netcdf(design(study), folder / "design.nc")
        runs = execute(read_netcdf(folder / "design.nc"), folder / "shards", Engine(workers=2))
        write_netcdf(runs, folder / "runs.nc")
        runs = read_netcdf(folder / "runs.nc")
        write_netcdf(analyse(runs), folder / "analysis.nc")
        return runs, read_netcdf(folder / "analysis.nc"), study

    return solve


@pytest.fixture(scope="module")
def ishigami(solved):
    return solved(ROOT / "studies" / "ishigami.yaml")


@pytest.fixture
def g(solved, tmp_path):
    def solve(method, others):
        lines = [f"    x{at}: {{distribution: uniform, low: 0, high: 1}}" for at in range(1, 9)]
        text = G.replace("METHOD", f"{method}\n  {others}") + "\n".join(lines)
        (tmp_path / "g.yaml").write_text(text)
        return solved(tmp_path / "g.yaml")

    return solve


def assert_within_three_standard_errors(analysis, name, known):
    half = analysis[f"{name}_interval"].isel(response=0).values
    standard = half / norm.ppf(0.5 + analysis[f"{name}_interval"].attrs["confidence"] / 2)
    off = np.abs(analysis[name].isel(response=0).values - known)
    there = np.isfinite(known)
    assert there.any()
    assert (off[there] <= 3 * standard[there] + 1e-9).all(), (name, off / standard)
    assert (standard[there] < 0.05).all()


@pytest.mark.parametrize("name", ["first_order", "total_order", "second_order"])
def test_sobol_indices_of_ishigami(ishigami, name):
    _, analysis, study = ishigami
    known = getattr(FUNCTIONS[study.function], name)()
    assert_within_three_standard_errors(analysis, name, known)


@pytest.mark.parametrize("name", ["first_order", "total_order", "second_order"])
def test_sobol_indices_of_g(g, name):
    _, analysis, study = g("sobol", "base_samples: 4096")
    assert_within_three_standard_errors(analysis, name, getattr(FUNCTIONS[study.function], name)())


def test_the_report_tells_what_is_known(ishigami, tmp_path):
    runs, analysis, _ = ishigami
    draw_all(runs, analysis, tmp_path / "figures")
    write_report(runs, analysis, tmp_path / "figures", tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "44 % (± " in page
    assert "of the variance of the value comes from the x2 alone" in page
    assert "NaN" not in re.sub(r"base64,[^\"]*", "", page)


def test_the_committed_study_states_what_is_known():
    text = (ROOT / "studies" / "ishigami.yaml").read_text()
    function = FUNCTIONS["ishigami"]
    for letter, indices in (("S", function.first_order()), ("T", function.total_order())):
        for at, index in enumerate(indices, 1):
            assert f"{letter}{at} = {index:.4f}".replace("0.0000", "0") in text
    assert f"S13 = {function.second_order()[0, 2]:.4f}" in text


def test_the_command_recommend_refuses_a_function():
    from impactlab.study.declaration import read_impacts
    from impactlab.study.errors import StudyError

    with pytest.raises(StudyError, match="has no discretisation"):
        read_impacts(ROOT / "studies" / "ishigami.yaml")
