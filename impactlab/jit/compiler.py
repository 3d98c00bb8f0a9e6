"""Functions compiled by numba: free of the GIL, kept in a folder of their sources' own."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from impactlab.jit.kernel_cache import KernelCache

Function = TypeVar("Function", bound=Callable[..., Any])


def sources_hash(root: Path) -> str:
    """Return the SHA-256 (hex) of all sources in `root` and here, and of numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for folder in (root, Path(__file__).parent):
        for path in sorted(folder.rglob("*.py")):
            name = path.relative_to(folder).as_posix()
            digest.update(name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def compiled_in(
    folder: Path | None,
    function: Function,
    fastmath: Any,
    *,
    kept: bool = True,
    inline: bool = False,
    allocates: bool = False,
) -> Function:
    """Return `function` compiled (or as it is under NUMBA_DISABLE_JIT=1).

    folder: where it is kept, unless `kept` is False. inline: into whatever calls it. allocates:
    with numba's counting of references (`_nrt`), which costs time at each call; without it a
    function that makes an array does not compile, and none can be freed too early.
    """
    jit: Any = numba.njit  # its types do not list `_nrt`
    dispatcher = jit(
        nogil=True, error_model="numpy", fastmath=fastmath, forceinline=inline, _nrt=allocates
    )(function)
    if kept and folder is not None and dispatcher is not function:
        dispatcher._cache = KernelCache(folder, function)
    return cast(Function, dispatcher)
