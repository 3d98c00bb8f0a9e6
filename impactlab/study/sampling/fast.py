"""Extended Fourier amplitude sensitivity test (FAST): search curves."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import model_validator

from impactlab.study.sampling.sections import MOST_RUNS, Draws, Sample, SamplingMethod, problem
from impactlab.study.schema.section import Whole, at_key, between

_DUMMY = "dummy"


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
        if self.samples <= 4 * self.harmonics**2:
            least = 4 * self.harmonics**2 + 1
            raise at_key("samples", f"must be at least {least:,} (above 4 harmonics²)")
        return self


def draws(sampling: Fast) -> Draws:
    """Draw the curves one after the other, that of the dummy last.

    Returns unit draws on (run, varied parameter): the dummy has a curve, on which the others have
    their low frequencies, but no column.
    """
    from SALib.sample import fast_sampler  # takes a second, with its pandas

    found: Draws = fast_sampler.sample(
        problem([*sampling.varied, _DUMMY]),
        sampling.samples,
        M=sampling.harmonics,
        seed=sampling.generator(),
    )
    return found[:, :-1]


METHOD = SamplingMethod(
    name="fast",
    section=Fast,
    summary="first and total order, for smooth responses",
    draws=draws,
    indices="impactlab.analysis.sensitivity.fast.METHOD",
)
