"""Records of the case table for kernels that are called by themselves."""

import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values


@pytest.fixture
def make_case():
    """A function that makes one record: the paper's case, some parameters replaced."""

    def make(duration=1e-3, **values):
        impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
        return case_table(impact, grid, duration=duration)[0]

    return make
