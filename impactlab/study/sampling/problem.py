"""A sample in SALib's terms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from impactlab.study.declaration import Sample


def problem(names: Sequence[str], groups: Sequence[str] = ()) -> dict[str, Any]:
    """SALib's problem of parameters in the unit cube; groups: that of each, in their order."""
    said = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    return said | ({"groups": list(groups)} if groups else {})


def generator(sampling: Sample) -> np.random.Generator:
    """The sample's source of randomness; SALib takes some seeds of 0 for none, but no generator."""
    return np.random.default_rng(sampling.seed)
