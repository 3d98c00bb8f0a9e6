"""Sobol indices: Saltelli's sample."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, StrictBool, model_validator

from impactlab.study.declaration.form import Whole, at_key, between
from impactlab.study.declaration.methods.grouped import Grouped
from impactlab.study.declaration.methods.sampling import MOST_RUNS
from impactlab.study.declaration.methods.until import Until

_BASIS = 64
"""Base samples from which on the bootstrap's intervals may decide something."""


def _power_of_two(value: int) -> int:
    if value & (value - 1):
        below = 1 << (value.bit_length() - 1)
        raise ValueError(f"must be a power of two, such as {below} or {2 * below}")
    return value


class Sobol(Grouped):
    """Saltelli's sample for Sobol indices.

    base_samples: N, a power of two. second_order: whether second-order indices are wanted; they
    take N (2 G + 2) runs of G parameters or groups instead of N (G + 2). until: how far the
    sample is doubled; none: it is not.

    Raises ValueError when `until` allows fewer runs than the first sample has, or is to be
    decided by the intervals of a very small one.
    """

    method: Literal["sobol"]
    base_samples: Annotated[Whole, between(2, MOST_RUNS), AfterValidator(_power_of_two)]
    second_order: StrictBool = True
    until: Until | None = None

    @property
    def runs(self) -> int:
        """Saltelli's number of runs."""
        return self.base_samples * ((2 if self.second_order else 1) * self.group_count + 2)

    @model_validator(mode="after")
    def _room_to_grow(self) -> Self:
        if self.until and self.base_samples < _BASIS:
            raise at_key(
                "base_samples",
                f"must be at least {_BASIS} with until: the intervals of fewer cannot be trusted",
            )
        if self.until and self.until.runs < self.runs:
            raise at_key("until.runs", f"must be at least the first sample's {self.runs:,} runs")
        return self
