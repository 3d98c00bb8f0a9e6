"""Kernels are compiled by a process of their own, which leaves them in the cache.

A process that compiles them itself runs other machine code than one that finds them there: of the
copies of an inner function it links another one, whose sums may be ordered differently, and answers
differ in the last bit. So all processes load them. (One that has compiled an inner function itself,
as tests do, still links that.)
"""

from __future__ import annotations

import functools
import logging
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numba

from impactlab.kernels.jit import CACHE

log = logging.getLogger(__name__)

_CHILD = "IMPACTLAB_COMPILES"
"""In the environment of the process that compiles."""


@functools.cache
def compile_apart(kernel: str, program: str) -> None:
    """Have `program`, Python code that calls the kernel, compile it, unless that has been done.

    kernel: its module's last name and its own, "leapfrog.run_all". Where there is no cache, or no
    other process can be had, the calling process will compile.
    """
    config: Any = numba.config  # numba's types do not list its settings
    if CACHE is None or config.DISABLE_JIT or _CHILD in os.environ or not sys.executable:
        return
    if any(CACHE.rglob(f"{kernel}-*.nbc")):
        return
    here = str(Path(__file__).resolve().parents[2])  # the same package, wherever it was found
    paths = os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))
    try:
        done = subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {_CHILD: "1", "PYTHONPATH": paths},
            capture_output=True,
            text=True,
            check=False,
        )
        log.debug("kernels compiled apart, exit code %s: %s", done.returncode, done.stderr)
    except OSError as error:
        log.debug("kernels cannot be compiled apart: %s", error)
