"""Every method of sensitivity analysis, by its name in study files."""

from __future__ import annotations

from typing import Protocol

from impactlab.analysis.sensitivity import delta, fast, morris, pawn, regression, sobol
from impactlab.analysis.sensitivity.index import Index
from impactlab.analysis.sensitivity.sample import Array, Sample


class Method(Protocol):
    """What a module of this folder offers to be in the table."""

    def indices(self, sample: Sample) -> dict[str, Index]:
        """What is estimated, by variable name."""

    def check(self, sample: Sample) -> None:
        """Raises ValueError where the runs are not the sample that their attributes tell of."""

    def varying(self, outputs: Array, sample: Sample) -> list[Array]:
        """The parts of a response's outputs (runs,) that have to vary, each of them."""

    def estimate(self, outputs: Array, sample: Sample, response: str) -> dict[str, Array]:
        """Indices and half-widths of one response, from finite and varying outputs (runs,)."""


METHODS: dict[str, Method] = {
    "sobol": sobol,
    "morris": morris,
    "fast": fast,
    "delta": delta,
    "pawn": pawn,
    "regression": regression,
}
"""A new one is a module and a line here."""
