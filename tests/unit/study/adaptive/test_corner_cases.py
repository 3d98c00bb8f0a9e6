"""Corner cases meet in all combinations that they promise."""

from itertools import combinations, product

import numpy as np
import pytest

from impactlab.study.adaptive.recommendation import corner_cases, corners
from impactlab.study.schema.readers import read_study

STUDY = """
title: Corners
impact: {base: paper}
duration: 1 ms
sampling:
"""
GRID = """
  method: grid
  parameters:
    velocity: [2, 1, 5]
    contact: [hertz, stronge]
    nodes: [11, 21, 41]
"""
SAMPLE = """
  method: sobol
  base_samples: 4
  parameters:
    velocity: {distribution: uniform, low: 1, high: 2}
    beam_depth: {distribution: normal, mean: 27.8 mm, standard_deviation: 0.1 mm}
    beam_width: {distribution: fixed, value: 50 mm}
"""


@pytest.fixture
def study(tmp_path):
    def read(sampling):
        (tmp_path / "some.yaml").write_text(STUDY + sampling)
        return read_study(tmp_path / "some.yaml")

    return read


@pytest.mark.parametrize("count", [1, 2, 4])
def test_few_numbers_meet_at_all_corners(count):
    signs = corners(count)
    assert len(signs) == 2**count + 1
    assert {tuple(row) for row in signs[:-1]} == set(product((-1, 1), repeat=count))
    assert not signs[-1].any()


@pytest.mark.parametrize("count", [5, 8, 9, 15])
def test_any_three_of_many_meet_in_all_eight_combinations(count):
    signs = corners(count)[:-1]
    assert len(signs) <= 4 * count
    for three in combinations(range(count), 3):
        assert {tuple(row) for row in signs[:, three]} == set(product((-1, 1), repeat=3))


def test_a_grids_extremes_with_every_word_and_without_the_discretisation(study):
    cases = corner_cases(study(GRID))
    assert set(cases) == {"contact", "velocity"}
    found = set(zip(cases["contact"], cases["velocity"], strict=True))
    assert found == set(product(("hertz", "stronge"), (1.0, 2.0, 5.0)))
    # only the discretisation varied
    cases = corner_cases(study("  {method: grid, parameters: {nodes: [11, 21, 41]}}"))
    assert cases == {"velocity": [0.99]}
    # a samples bounds and far quantiles without the fixed
    cases = corner_cases(study(SAMPLE))
    assert set(cases) == {"velocity", "beam_depth"}
    assert sorted(set(cases["velocity"])) == pytest.approx([1.0, 1.5, 2.0])
    least, middle, most = sorted(set(cases["beam_depth"]))
    # 99 % of a Gaussian lie within 2.5758 standard deviations
    assert [least, middle, most] == pytest.approx(0.0278 + 1e-4 * 2.5758 * np.array([-1, 0, 1]))
