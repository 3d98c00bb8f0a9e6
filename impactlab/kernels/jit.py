"""The one way in which kernels are compiled: cached on disk (cache.py), free of the GIL."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from impactlab.kernels.cache import cache_folder

Function = TypeVar("Function", bound=Callable[..., Any])


def sources_hash() -> str:
    """SHA-256 (hex) over the paths and bytes of all kernel sources, and numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


SOURCES_HASH = sources_hash()
"""Hash of the kernels that this process runs: the same hash, the same numbers."""


CACHE = cache_folder(SOURCES_HASH)
"""The folder of this process's compiled kernels; None: they cannot be kept."""


def _jit(function: Function, fastmath: Any, kept: bool = True) -> Function:
    config: Any = numba.config  # numba's types do not list its settings
    before = config.CACHE_DIR
    config.CACHE_DIR = str(CACHE or "")
    try:
        jit: Any = numba.njit(
            cache=kept and CACHE is not None,
            nogil=True,
            error_model="numpy",
            fastmath=fastmath,
        )
        return cast(Function, jit(function))
    finally:
        config.CACHE_DIR = before


def compiled(function: Function) -> Function:
    """`function` as a compiled kernel (or as it is under NUMBA_DISABLE_JIT=1)."""
    return _jit(function, False)


def vectorised(function: Function) -> Function:
    """Like `compiled`, for loops over arrays: free to reorder sums, blind to NaN."""
    return _jit(function, True)


def ordered(function: Function) -> Function:
    """Like `compiled`, free to fuse a product with a sum, but not to reorder sums."""
    return _jit(function, fastmath={"contract"})


def linked(function: Function, number: int) -> Function:
    """Like `compiled`, for a function made within another; `number` sets it apart from its like.

    It is kept in its callers' code alone: numba tells functions apart by their names, both in its
    cache and where it links code from there, and would take one for another.
    """
    function.__qualname__ = function.__name__ = f"{function.__name__}_{number}"
    return _jit(function, False, kept=False)
