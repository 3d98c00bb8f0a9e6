"""Elementary effects: Morris' trajectories."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, ValidationInfo, model_validator

from impactlab.study.sampling.sections import Draws, Grouped, Sample, problem
from impactlab.study.schema.parameters import Distribution, Factor
from impactlab.study.schema.section import Reader, Whole, at_key, between

_SEARCH = 500_000
"""Limit on trajectories times chosen ones squared: the search then takes about a minute."""


def _even(value: int) -> int:
    if value % 2:
        raise ValueError("must be even: the steps would favour some levels otherwise")
    return value


class Morris(Grouped):
    """The section `sampling` with method: morris.

    Trajectories on a grid of levels; along each, every parameter (or group) steps once.
    trajectories: how many are drawn. levels: number of grid levels, evenly spaced in probability,
    ends included. optimal_trajectories: how many of them, far apart, are kept (Campolongo et al.
    2007; chosen as by Ruano et al. 2012); 0: all.

    Raises ValueError for a distribution without ends, and unless fewer trajectories are chosen
    than drawn.
    """

    method: Literal["morris"]
    trajectories: Annotated[Whole, between(2, 1_000_000)]
    levels: Annotated[Whole, between(2, 100), AfterValidator(_even)] = 4
    optimal_trajectories: Annotated[Whole, between(0, 1000)] = 0

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """Return the reader of a distribution with two ends, or of a fixed value."""
        read_any = Sample.entry(factor)

        def read(data: Any, info: ValidationInfo) -> Any:
            entry = read_any(data, info)
            if isinstance(entry, Distribution) and not entry.bounds():
                reason = (
                    "has no ends, where method morris has its outer levels: "
                    "use truncated_normal, or another with low and high"
                )
                raise at_key("distribution", reason)
            return entry

        return read

    @property
    def runs(self) -> int:
        """Number of runs: per trajectory a start, and one step per parameter or group."""
        return (self.optimal_trajectories or self.trajectories) * (self.group_count + 1)

    @model_validator(mode="after")
    def _check_choice(self) -> Self:
        """Refuse a choice that SALib cannot make, or that takes it too long."""
        most, chosen = self.trajectories - 1, self.optimal_trajectories
        if chosen and not 2 <= chosen <= most:
            reason = f"must lie from 2 to {most} (below trajectories), or be 0"
            raise at_key("optimal_trajectories", reason)
        if self.trajectories * chosen**2 > _SEARCH:
            reason = (
                "takes too long to choose: trajectories × optimal_trajectories² may be "
                f"at most {_SEARCH:,}"
            )
            raise at_key("optimal_trajectories", reason)
        return self

    def draws(self) -> Draws:
        """Draw the trajectories one after the other: a start, and one step per parameter or group.

        They are levels, 0 and 1 included.
        """
        from SALib.sample import morris  # takes a second, with its pandas

        found: Draws = morris.sample(
            problem(list(self.varied), list(self.group_of.values())),
            self.trajectories,
            num_levels=self.levels,
            optimal_trajectories=self.optimal_trajectories or None,
            seed=self.generator(),
        )
        return found
