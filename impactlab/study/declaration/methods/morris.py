"""Elementary effects: Morris' trajectories."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, ValidationInfo, model_validator

from impactlab.study.declaration.distributions import Distribution
from impactlab.study.declaration.form import Reader, Whole, at_key, between
from impactlab.study.declaration.methods.grouped import Grouped
from impactlab.study.declaration.methods.sample import Sample
from impactlab.study.declaration.values import Factor

_SEARCH = 500_000
"""Trajectories times chosen ones squared, at most: the search takes about a minute then."""


def _even(value: int) -> int:
    if value % 2:
        raise ValueError("must be even: the steps would favour some levels otherwise")
    return value


class Morris(Grouped):
    """Trajectories on a grid of levels; along each, every parameter (or group) steps once.

    trajectories: how many are drawn. levels: of the grid, evenly spaced in probability, ends
    included. optimal_trajectories: how many of them, far apart, are kept (Campolongo et al. 2007;
    chosen as by Ruano et al. 2012); 0: all.

    Raises ValueError for a distribution without ends, and unless fewer trajectories are chosen
    than drawn.
    """

    method: Literal["morris"]
    trajectories: Annotated[Whole, between(2, 1_000_000)]
    levels: Annotated[Whole, between(2, 100), AfterValidator(_even)] = 4
    optimal_trajectories: Annotated[Whole, between(0, 1000)] = 0

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """A distribution with two ends, or a fixed value."""
        read_any = Sample.entry(factor)

        def read(data: Any, info: ValidationInfo) -> Any:
            given = read_any(data, info)
            if isinstance(given, Distribution) and not given.bounds():
                reason = (
                    "has no ends, and the outer levels of method morris lie there: "
                    "use truncated_normal, or another with low and high"
                )
                raise at_key("distribution", reason)
            return given

        return read

    @property
    def runs(self) -> int:
        """A start and a step of each parameter or group, a trajectory."""
        return (self.optimal_trajectories or self.trajectories) * (self.group_count + 1)

    @model_validator(mode="after")
    def _choice(self) -> Self:
        """Refuse what SALib cannot choose, or not in bearable time."""
        if self.optimal_trajectories == 0:
            return self
        if not 2 <= self.optimal_trajectories < self.trajectories:
            reason = f"must lie from 2 to {self.trajectories - 1} (below trajectories), or be 0"
            raise at_key("optimal_trajectories", reason)
        if self.trajectories * self.optimal_trajectories**2 > _SEARCH:
            reason = (
                "takes too long to choose: trajectories × optimal_trajectories² may be "
                f"at most {_SEARCH:,}"
            )
            raise at_key("optimal_trajectories", reason)
        return self
