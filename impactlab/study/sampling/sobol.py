"""Sobol: Saltelli's sample."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, StrictBool, model_validator

from impactlab.study.sampling.sections import MOST_RUNS, Draws, Grouped, problem
from impactlab.study.schema.section import Names, Number, Section, Whole, at_key, between

_FEWEST_TO_GROW = 64
"""Base samples from which on bootstrap intervals are good enough to decide on growth."""


class Until(Section):
    """The key `until`: the sample is doubled until its intervals are narrow enough.

    interval: largest half-width of the interval of a first or total-order index. runs: largest
    number of runs. responses: those whose indices count; None: all.
    """

    interval: Annotated[Number, between(0.001, 0.5)]
    runs: Annotated[Whole, between(1, MOST_RUNS)]
    responses: Names | None = None


def _power_of_two(value: int) -> int:
    if value & (value - 1):
        below = 1 << (value.bit_length() - 1)
        raise ValueError(f"must be a power of two, such as {below} or {2 * below}")
    return value


class Sobol(Grouped):
    """The section `sampling` with method: sobol.

    base_samples: N, a power of two. second_order: whether second-order indices are wanted; they
    take N (2 G + 2) runs of G parameters or groups instead of N (G + 2). until: how far the
    sample is doubled; None: it is not.

    Raises ValueError when `until` allows fewer runs than the first sample has, or when that
    sample is too small for its intervals to be trusted.
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
    def _check_until(self) -> Self:
        if self.until and self.base_samples < _FEWEST_TO_GROW:
            reason = (
                f"must be at least {_FEWEST_TO_GROW} with until: the intervals of fewer cannot be "
                "trusted"
            )
            raise at_key("base_samples", reason)
        if self.until and self.until.runs < self.runs:
            raise at_key("until.runs", f"must be at least the first sample's {self.runs:,} runs")
        return self

    def draws(self) -> Draws:
        """Draw base samples one after the other: A, A with B's columns, B with A's columns, B.

        The parameters of a group take their columns together. The first runs of a larger sample
        are the smaller sample.
        """
        from SALib.sample import sobol  # takes a second, with its pandas

        found: Draws = sobol.sample(
            problem(list(self.varied), list(self.group_of.values())),
            self.base_samples,
            calc_second_order=self.second_order,
            seed=self.generator(),
        )
        return found
