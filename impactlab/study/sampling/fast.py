"""Extended Fourier amplitude sensitivity test (FAST): search curves."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import model_validator

from impactlab.study.sampling.sections import MOST_RUNS, Draws, Sample, problem
from impactlab.study.schema.section import Whole, at_key, between


class Fast(Sample):
    """The section `sampling` with method: fast.

    One search curve per parameter, and one for a dummy parameter, whose indices are noise.
    samples: N, runs per curve. harmonics: M, the multiples of a parameter's frequency that count
    as its own effect. Raises ValueError unless N > 4 M^2 (Saltelli, Tarantola and Chan 1999).
    """

    method: Literal["fast"]
    samples: Annotated[Whole, between(5, MOST_RUNS)]
    harmonics: Annotated[Whole, between(1, 100)] = 4

    @property
    def runs(self) -> int:
        """Number of runs: one curve per parameter, and one for the dummy."""
        return self.samples * (len(self.varied) + 1)

    @model_validator(mode="after")
    def _check_resolution(self) -> Self:
        least = 4 * self.harmonics**2 + 1
        if self.samples < least:
            raise at_key("samples", f"must be at least {least:,} (above 4 harmonics²)")
        return self

    def draws(self) -> Draws:
        """Draw the curves one after the other, that of the dummy last.

        The dummy has a curve, on which the others have their low frequencies, but no column.
        """
        from SALib.sample import fast_sampler  # takes a second, with its pandas

        names, seed = [*self.varied, "dummy"], self.generator()
        found: Draws = fast_sampler.sample(
            problem(names), self.samples, M=self.harmonics, seed=seed
        )
        return found[:, :-1]
