"""What an index is called, where its estimator comes from, and how it is stored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from impactlab.analysis.sensitivity.sample import Array, Sample

Stored = dict[str, tuple[tuple[str, ...], Array, dict[str, object]]]

FACTOR = ("parameter",)
PAIR = ("parameter", "other_parameter")
BY_SAMPLES = ("base_samples", "parameter")


@dataclass(frozen=True)
class Index:
    """One index of a response.

    estimator: its source, with the equation; dims: those beside `response`; units: None where it
    has the unit of its response; interval: whether it comes with one; comment: what a reader of
    the number has to know.
    """

    long_name: str
    estimator: str
    dims: tuple[str, ...] = FACTOR
    units: str | None = "1"
    interval: bool = True
    comment: str = ""

    def attributes(self) -> dict[str, object]:
        """Of its variable."""
        attrs: dict[str, object] = {"long_name": self.long_name, "estimator": self.estimator}
        attrs |= {"units": self.units} if self.units else {}
        return attrs | ({"comment": self.comment} if self.comment else {})

    def interval_attributes(self, sample: Sample) -> dict[str, object]:
        """Of the variable of its half-width."""
        words = f"half-width of the {100 * sample.confidence:g} % interval of the {self.long_name}"
        own = {"confidence": sample.confidence, "resamples": sample.resamples}
        return self.attributes() | {"long_name": words} | own


def stored(
    rows: Sequence[Mapping[str, Array]],
    indices: Mapping[str, Index],
    sample: Sample,
    sizes: Mapping[str, int],
) -> Stored:
    """Dataset variables from one mapping of indices a response; an empty one stands for NaN."""
    variables: Stored = {}
    for name, index in indices.items():
        gap = np.full([sizes[dim] for dim in index.dims], np.nan)
        kinds = {name: index.attributes()}
        if index.interval:
            kinds[f"{name}_interval"] = index.interval_attributes(sample)
        for key, attrs in kinds.items():
            stacked = np.array([row[key] if row else gap for row in rows], float)
            variables[key] = (("response", *index.dims), stacked, attrs)
    return variables
