"""The decorators of this solver's kernels (see impactlab.jit), and their sources' hash."""

from __future__ import annotations

from pathlib import Path

from impactlab.jit import Compiler

_COMPILER = Compiler(Path(__file__).parent)
SOURCES_HASH = _COMPILER.sources_hash
"""Hash of the kernels that this process runs: the same hash, the same numbers."""

compiled = _COMPILER.compiled
allocating = _COMPILER.allocating
vectorised = _COMPILER.vectorised
ordered = _COMPILER.ordered
linked = _COMPILER.linked
