"""Functions compiled by numba: free of the GIL, kept in a folder of their sources' own.

A kernel is compiled by a process of its own (`precompile`), which leaves it in the cache. A process
that compiles it runs other machine code than one that loads it: of the copies of an inner function
it links another one, whose sums may be ordered differently, and answers differ in the last bit. So
all processes load it. (One that has compiled an inner function itself, as tests do, still links
that.)
"""

from __future__ import annotations

import functools
import hashlib
import logging
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from filelock import FileLock

from impactlab.jit.cache import COMPILES, KernelCache, cache_folder, discard

Function = TypeVar("Function", bound=Callable[..., Any])

log = logging.getLogger(__name__)


class Compiler:
    """The decorators of one package of kernels; under NUMBA_DISABLE_JIT=1 they change nothing.

    sources_hash: SHA-256 (hex) of all sources of the package and of this one, and of numba's
    version. folder: where its compiled kernels are kept; None: they cannot be kept.
    """

    def __init__(self, root: Path) -> None:
        """Compile the package in the folder `root`."""
        self.sources_hash = _sources_hash(root)
        self.folder = cache_folder(self.sources_hash)

    def compiled(self, function: Function) -> Function:
        """Return `function` as a compiled kernel.

        It can neither make arrays nor free any: what it works on belongs to its caller. One that
        makes an array does not compile.
        """
        return self._compile(function)

    def allocating(self, function: Function) -> Function:
        """Return what `compiled` does, of a function that makes or owns arrays.

        It has numba's counting of references (`_nrt`), which costs time at each call. A record of
        an array does not keep it alive here, so arrays of records come from Python.
        """
        return self._compile(function, allocates=True)

    def vectorised(self, function: Function) -> Function:
        """Return what `compiled` does, free to reorder sums and blind to NaN: for array loops."""
        return self._compile(function, fastmath=True)

    def ordered(self, function: Function) -> Function:
        """Return what `compiled` does, free to fuse a product with a sum; sums keep their order."""
        return self._compile(function, fastmath={"contract"})

    def inlined(self, function: Function) -> Function:
        """Return what `ordered` does, always part of its callers: their loops can be vectorised."""
        return self._compile(function, fastmath={"contract"}, inline=True)

    def linked(self, function: Function, number: int) -> Function:
        """Return what `compiled` does, of a function made within another.

        `number` tells functions made in the same place apart: numba knows functions by their names,
        in its cache and where it links code from there, and would take one for another. For the
        same reason the function is kept in its callers' code alone.
        """
        function.__qualname__ = function.__name__ = f"{function.__name__}_{number}"
        return self._compile(function, kept=False)

    def _compile(
        self,
        function: Function,
        *,
        fastmath: Any = False,
        kept: bool = True,
        inline: bool = False,
        allocates: bool = False,
    ) -> Function:
        jit: Any = numba.njit  # its types do not list `_nrt`
        dispatcher = jit(
            nogil=True, error_model="numpy", fastmath=fastmath, forceinline=inline, _nrt=allocates
        )(function)
        if kept and self.folder is not None and dispatcher is not function:
            dispatcher._cache = KernelCache(self.folder, function)
        return cast(Function, dispatcher)


def _sources_hash(root: Path) -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for folder in (root, Path(__file__).parent):
        for path in sorted(folder.rglob("*.py")):
            name = path.relative_to(folder).as_posix()
            digest.update(name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


@functools.cache
def precompile(kernel: Any, program: str) -> None:
    """Compile `kernel` in another process, unless it is in the cache.

    kernel: a compiled function. program: Python code that calls it. Where the kernel has no cache,
    or no other process can be started, the calling process will compile. Processes that need it at
    the same time wait for the first one's.
    """
    cache = getattr(kernel, "_cache", None)
    if not isinstance(cache, KernelCache) or COMPILES in os.environ or not sys.executable:
        return
    folder = Path(cache.cache_path)
    here = str(Path(__file__).resolve().parents[2])  # the same package, wherever it was found
    paths = os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))
    try:
        with FileLock(folder / "lock"):
            if cache.is_kept():
                return
            discard(folder)
            done = subprocess.run(
                [sys.executable, "-c", program],
                env=os.environ | {COMPILES: "1", "PYTHONPATH": paths},
                capture_output=True,
                text=True,
                check=False,
            )
        log.debug("kernels precompiled, exit code %s: %s", done.returncode, done.stderr)
    except OSError as error:
        log.debug("kernels cannot be precompiled: %s", error)
