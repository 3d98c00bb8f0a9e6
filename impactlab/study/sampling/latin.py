"""Latin hypercube: the one sample of delta, PAWN and regression."""

from __future__ import annotations

from typing import Annotated, Literal

from impactlab.study.sampling.sections import MOST_RUNS, Draws, Sample, SamplingMethod, problem
from impactlab.study.schema.section import Whole, between


class Latin(Sample):
    """The section `sampling` with method: delta, pawn or regression. samples: number of runs."""

    method: Literal["delta", "pawn", "regression"]
    samples: Annotated[Whole, between(64, MOST_RUNS)]

    @property
    def runs(self) -> int:
        """Number of runs: that of the samples."""
        return self.samples


def draws(sampling: Latin) -> Draws:
    """Draw one value in each of equal strata of every parameter.

    Returns unit draws on (run, varied parameter). They do not depend on the method: changing it
    needs no new run.
    """
    from SALib.sample import latin  # takes a second, with its pandas

    found: Draws = latin.sample(
        problem(list(sampling.varied)), sampling.samples, seed=sampling.generator()
    )
    return found


def _method(name: str, summary: str) -> SamplingMethod:
    return SamplingMethod(
        name, Latin, summary, draws, f"impactlab.analysis.sensitivity.{name}.METHOD"
    )


METHODS = (
    _method("delta", "shift of the whole distribution, whatever its shape"),
    _method("pawn", "the same, by the distance of cumulative distributions"),
    _method("regression", "standardised slopes of the response or its ranks"),
)
