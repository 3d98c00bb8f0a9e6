"""Records of the case table for kernels that are called by themselves."""

from collections.abc import Callable
from typing import Any

import pytest

import impactlab as il
from impactlab.model.parameters import with_values
from impactlab.simulate import case_table
from impactlab.solver.types import Record


@pytest.fixture
def make_case() -> Callable[..., Record]:
    """A function that makes one record: the paper's case, some parameters replaced."""

    def make(duration: float = 1e-3, **values: Any) -> Record:
        impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
        return case_table(impact, grid, duration=duration)[0]

    return make
