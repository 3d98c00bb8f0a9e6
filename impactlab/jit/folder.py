"""Where compiled kernels are kept: one folder for each set of sources and kind of machine."""

from __future__ import annotations

import hashlib
import logging
import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any
from uuid import uuid4

import llvmlite
import numba
import numpy as np
import platformdirs
from llvmlite import binding

log = logging.getLogger(__name__)

_OURS = re.compile(r"kernels-[0-9a-f]{16}(-[0-9a-f]{8})?(\.[0-9a-f]{32})?")
_UNUSED = 30 * 24 * 3600.0
"""Seconds after which the folder of other sources, or of another machine, is taken away."""


def cache_folder(sources_hash: str) -> Path | None:
    """Return the folder for these sources on this machine, or None where it cannot be made."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(given) if given else platformdirs.user_cache_path("impactlab")
    folder = root / f"kernels-{sources_hash[:16]}-{_machine()}"
    try:
        if not folder.exists():
            folder.mkdir(parents=True, exist_ok=True)
            remove_unused(root)
        os.utime(folder)  # in use
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        log.warning(
            "compiled kernels cannot be kept in %s (%s), so each process compiles them anew; "
            "NUMBA_CACHE_DIR may name another folder",
            folder,
            error.strerror,
        )
        return None
    return folder


def remove_unused(root: Path) -> None:
    """Take away the folders of kernels in `root` that no process has looked into for 30 days."""
    for folder in root.iterdir():
        if not _OURS.fullmatch(folder.name) or folder.is_symlink() or not folder.is_dir():
            continue
        aside = folder.with_name(f"{folder.name.partition('.')[0]}.{uuid4().hex}")
        try:
            if time.time() - folder.stat().st_mtime > _UNUSED:
                folder.rename(aside)  # at once: nobody finds half of it
                shutil.rmtree(aside, ignore_errors=True)
        except OSError:  # another process was faster, or it belongs to somebody else
            continue


def _machine() -> str:
    """Return a short hash of the processor as numba sees it, and of what compiles and loads."""
    config: Any = numba.config  # numba's types do not list its settings
    name = config.CPU_NAME or binding.get_host_cpu_name()
    features = config.CPU_FEATURES
    if features is None:
        features = binding.get_host_cpu_features().flatten()
    tools = sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__
    return hashlib.sha256(f"{name} {features} {tools}".encode()).hexdigest()[:8]
