"""How the runs of a study are chosen: one method a file, and one line in METHODS."""

from __future__ import annotations

from collections.abc import Mapping

from impactlab.study.declaration.form import Reader, chosen
from impactlab.study.declaration.methods.fast import Fast
from impactlab.study.declaration.methods.grid import Grid
from impactlab.study.declaration.methods.grouped import Grouped
from impactlab.study.declaration.methods.latin import Latin
from impactlab.study.declaration.methods.morris import Morris
from impactlab.study.declaration.methods.sample import Sample
from impactlab.study.declaration.methods.sampling import Sampling
from impactlab.study.declaration.methods.sobol import Sobol
from impactlab.study.declaration.values import Factor

__all__ = ["Fast", "Grid", "Grouped", "Latin", "Morris", "Sample", "Sampling", "Sobol"]

METHODS: dict[str, type[Sampling]] = {
    "grid": Grid,
    "sobol": Sobol,
    "morris": Morris,
    "fast": Fast,
    "delta": Latin,
    "pawn": Latin,
    "regression": Latin,
}
"""By their name in study files."""


def sampling_reader(factors: Mapping[str, Factor]) -> Reader:
    """Reads the section `sampling`, of studies that can vary these, by the method it names."""
    return chosen("method", {name: method.of(factors) for name, method in METHODS.items()})
