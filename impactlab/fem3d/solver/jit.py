"""The decorators of this solver's loops (see impactlab.jit), and their sources' hash.

Products may be fused with sums, but no sum is reordered: the same bits for any number of threads.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from impactlab.jit import Compiler

Array: TypeAlias = np.ndarray[Any, Any]
"""An array as an argument of compiled functions."""

_COMPILER = Compiler(Path(__file__).parent)
SOURCES_HASH = _COMPILER.sources_hash
"""Hash of the sources that this process runs."""

FOLDER = _COMPILER.folder
"""Where the compiled loops are kept; None where they cannot be."""

compiled = _COMPILER.decorator(fastmath={"contract"})
inlined = _COMPILER.decorator(fastmath={"contract"}, inline=True)
