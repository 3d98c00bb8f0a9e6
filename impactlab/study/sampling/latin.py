"""Latin hypercube: the one sample of delta, PAWN and regression."""

from __future__ import annotations

from typing import Annotated, Literal

from impactlab.study.sampling.sections import MOST_RUNS, Draws, Sample, problem
from impactlab.study.schema.section import Whole, between


class Latin(Sample):
    """The section `sampling` with method: delta, pawn or regression. samples: number of runs."""

    method: Literal["delta", "pawn", "regression"]
    samples: Annotated[Whole, between(64, MOST_RUNS)]

    @property
    def runs(self) -> int:
        """Number of runs: that of the samples."""
        return self.samples

    def draws(self) -> Draws:
        """Draw one value in each of equal strata of every parameter.

        They do not depend on the method: changing it needs no new run.
        """
        from SALib.sample import latin  # takes a second, with its pandas

        names = list(self.varied)
        found: Draws = latin.sample(problem(names), self.samples, seed=self.generator())
        return found
