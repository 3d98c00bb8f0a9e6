"""Functions compiled by numba: free of the GIL, kept in a folder of their sources' own."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def sources_hash(root: Path) -> str:
    """SHA-256 (hex) over paths and bytes of all sources in `root` and here, and numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for folder in (root, Path(__file__).parent):
        for path in sorted(folder.rglob("*.py")):
            name = path.relative_to(folder).as_posix()
            digest.update(name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def compiled_in(
    cache: Path | None,
    function: Function,
    fastmath: Any,
    *,
    kept: bool = True,
    inline: bool = False,
) -> Function:
    """`function` compiled (or as it is under NUMBA_DISABLE_JIT=1).

    cache: the folder to keep it in, unless `kept` is False. inline: into whatever calls it.
    """
    config: Any = numba.config  # numba's types do not list its settings
    before = config.CACHE_DIR
    config.CACHE_DIR = str(cache or "")
    try:
        jit: Any = numba.njit(
            cache=kept and cache is not None,
            nogil=True,
            error_model="numpy",
            fastmath=fastmath,
            forceinline=inline,
        )
        return cast(Function, jit(function))
    finally:
        config.CACHE_DIR = before
