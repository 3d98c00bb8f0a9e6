import numpy as np
import pytest
import samples

from impactlab.figures import measures
from impactlab.figures.measures import SURROGATE, Index


def _index(values, margins, floor=0.0):
    none = np.zeros(len(values))
    return Index(np.array(values), np.array(margins), none, floor)


def test_an_index_stands_out_of_zero_and_of_the_dummy_with_its_whole_interval():
    found = _index([0.5, 0.05, 0.02, -0.3], [0.1, 0.02, 0.03, 0.1], floor=0.04)
    assert found.significant.tolist() == [True, False, False, True]
    assert _index([0.5], [np.inf]).significant.tolist() == [False]
    assert _index([np.nan], [0.1]).significant.tolist() == [False]


def test_noise_is_told_from_numerical_error():
    values, margins = np.array([0.1, 0.1, 0.5, 0.02]), np.array([0.01, 0.01, 0.1, 0.03])
    found = Index(values, margins, np.array([0.2, 0.0, 0.6, 0.6]), 0.0)
    assert found.above_noise.tolist() == [True, True, True, False]
    assert found.significant.tolist() == [False, True, False, False]
    assert found.numerically_lost.tolist() == [True, False, True, False]


def test_ranks_are_open_where_intervals_overlap():
    found = _index([0.5, 0.3, 0.29, -0.7], [0.05, 0.05, 0.05, 0.05])
    assert found.ranks == [(2, 2), (3, 4), (3, 4), (1, 1)]
    assert _index([0.5, 0.1], [np.inf, 0.01]).ranks == [(1, 2), (1, 2)]
    # numerical error opens ranks too
    values, margins = np.array([0.5, 0.3, 0.1]), np.full(3, 0.05)
    assert Index(values, margins, np.zeros(3), 0.0).ranks == [(1, 1), (2, 2), (3, 3)]
    found = Index(values, margins, np.array([0.1, 0.05, 0.0]), 0.0)
    assert found.ranks == [(1, 2), (1, 2), (3, 3)]


def test_an_index_is_read_with_its_floor_from_the_dummy():
    runs = samples.sample(64)
    found = measures.index(samples.indices(runs), "first_order", "peak_force")
    assert found.floor == pytest.approx(0.01 + 0.02)
    assert found.margins.tolist() == [0.03] * 9
    assert found.numerical.tolist() == [0.02] * 9
    # what is not given is not made up
    analysis = samples.indices(samples.sample(64))[["first_order"]]
    found = measures.index(analysis, "first_order", "peak_force")
    assert np.isinf(found.margins).all()
    assert found.floor == 0.0
    assert not SURROGATE.given(analysis)


def test_a_surrogate_stands_alone_beside_other_methods():
    analysis = samples.indices(samples.sample(64)).drop_vars(["first_order", "total_order"])
    assert SURROGATE.given(analysis)
    names = [measure.name for measure in SURROGATE.measures_in(analysis)]
    assert names == ["surrogate_first_order", "surrogate_total_order"]
