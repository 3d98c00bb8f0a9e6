"""Types in the signatures of kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
"""An array; the docstring gives shape and unit."""
Record = Any
"""One record of a structured array, its fields read and set by name."""
Index = Any
"""A position in an array, signed or not."""
ONE, TWO = np.uint64(1), np.uint64(2)
"""Offsets for an unsigned index. A loop over one gets vectorised from wherever it begins; a signed
index might be negative, that is, count from the end."""
Curve = Callable[..., tuple[float, float, float, float]]
"""A contact law: see contact/hertz.py."""
