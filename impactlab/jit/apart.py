"""A kernel is compiled by a process of its own, which leaves it in the cache.

A process that compiles it runs other machine code than one that loads it: of the copies of an inner
function it links another one, whose sums may be ordered differently, and answers differ in the last
bit. So all processes load it. (One that has compiled an inner function itself, as tests do, still
links that.)
"""

from __future__ import annotations

import functools
import logging
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from filelock import FileLock

from impactlab.jit.kernel_cache import COMPILES, KernelCache, discard

log = logging.getLogger(__name__)


@functools.cache
def compile_apart(kernel: Any, program: str) -> None:
    """Have `program`, Python code that calls `kernel`, compile it, unless that has been done.

    kernel: a compiled function. Where it has no cache, or no other process can be started, the
    calling process will compile. Processes that need it at once wait for the first one's.
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
        log.debug("kernels compiled apart, exit code %s: %s", done.returncode, done.stderr)
    except OSError as error:
        log.debug("kernels cannot be compiled apart: %s", error)
