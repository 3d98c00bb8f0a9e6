"""The one way in which kernels are compiled: cached on disk, free of the GIL."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from impactlab.jit.compiler import compiled_in, sources_hash
from impactlab.jit.folder import cache_folder

Function = TypeVar("Function", bound=Callable[..., Any])

SOURCES_HASH = sources_hash(Path(__file__).parent)
"""Hash of the kernels that this process runs: the same hash, the same numbers."""


CACHE = cache_folder(SOURCES_HASH)
"""The folder of this process's compiled kernels; None: they cannot be kept."""


def compiled(function: Function) -> Function:
    """`function` as a compiled kernel (or as it is under NUMBA_DISABLE_JIT=1).

    It can make no arrays, nor free any: what it works on belongs to whoever called it. One that
    makes an array does not compile.
    """
    return compiled_in(CACHE, function, False)


def allocating(function: Function) -> Function:
    """Like `compiled`, for a function that makes arrays, or owns them while others work on them.

    A record of an array does not keep it alive here, so arrays of records come from Python.
    """
    return compiled_in(CACHE, function, False, allocates=True)


def vectorised(function: Function) -> Function:
    """Like `compiled`, for loops over arrays: free to reorder sums, blind to NaN."""
    return compiled_in(CACHE, function, True)


def ordered(function: Function) -> Function:
    """Like `compiled`, free to fuse a product with a sum, but not to reorder sums."""
    return compiled_in(CACHE, function, fastmath={"contract"})


def linked(function: Function, number: int) -> Function:
    """Like `compiled`, for a function made within another; `number` sets it apart from its like.

    It is kept in its callers' code alone: numba tells functions apart by their names, both in its
    cache and where it links code from there, and would take one for another.
    """
    function.__qualname__ = function.__name__ = f"{function.__name__}_{number}"
    return compiled_in(CACHE, function, False, kept=False)
