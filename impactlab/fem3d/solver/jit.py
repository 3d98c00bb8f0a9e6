"""How this solver's inner loops are compiled: as impactlab.jit does, in a folder of their own.

Products may be fused with sums, but no sum is reordered: the same bits for any number of threads.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from impactlab.jit.compiler import compiled_in, sources_hash
from impactlab.jit.folder import cache_folder

Function = TypeVar("Function", bound=Callable[..., Any])

SOURCES_HASH = sources_hash(Path(__file__).parent)
"""Hash of the sources that this process runs."""

_CACHE = cache_folder(SOURCES_HASH)


def compiled(function: Function) -> Function:
    """`function` compiled (or as it is under NUMBA_DISABLE_JIT=1)."""
    return compiled_in(_CACHE, function, {"contract"})


def inlined(function: Function) -> Function:
    """Like `compiled`, and always part of its callers, so that their loops can be vectorised."""
    return compiled_in(_CACHE, function, {"contract"}, inline=True)
