"""Extended Fourier amplitude sensitivity test: search curves."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import model_validator

from impactlab.study.declaration.form import Whole, at_key, between
from impactlab.study.declaration.methods.sample import Sample
from impactlab.study.declaration.methods.sampling import MOST_RUNS


class Fast(Sample):
    """A search curve for each parameter, and one more for a dummy, whose indices are the noise.

    samples: runs a curve, N. harmonics: M, how many of a parameter's frequency count as its own
    effect. Raises ValueError unless N > 4 M^2 (Saltelli, Tarantola and Chan 1999).
    """

    method: Literal["fast"]
    samples: Annotated[Whole, between(5, MOST_RUNS)]
    harmonics: Annotated[Whole, between(1, 100)] = 4

    @property
    def runs(self) -> int:
        """A curve for each parameter and for the dummy."""
        return self.samples * (len(self.varied) + 1)

    @model_validator(mode="after")
    def _resolved(self) -> Self:
        if self.samples <= 4 * self.harmonics**2:
            least = 4 * self.harmonics**2 + 1
            raise at_key("samples", f"must be at least {least:,} (above 4 harmonics²)")
        return self
