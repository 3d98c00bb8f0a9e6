"""Methods that need no special sample: delta, PAWN and regression, on a Latin hypercube."""

from __future__ import annotations

from typing import Annotated, Literal

from impactlab.study.declaration.form import Whole, between
from impactlab.study.declaration.methods.sample import Sample
from impactlab.study.declaration.methods.sampling import MOST_RUNS


class Latin(Sample):
    """A Latin hypercube of `samples` runs: the same for every one of its methods."""

    method: Literal["delta", "pawn", "regression"]
    samples: Annotated[Whole, between(64, MOST_RUNS)]

    @property
    def runs(self) -> int:
        """As many as samples are asked for."""
        return self.samples
