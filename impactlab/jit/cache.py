"""Compiled functions on disk: one folder per set of sources and kind of machine, with checksums.

numba's own cache notices a changed function, but neither a changed callee in another file nor a
damaged file, and looks for code by the path and age of its source. Here a folder belongs to one set
of sources, wherever these lie, it has one file per function and signature, and a damaged file
empties its folder.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from uuid import uuid4

import llvmlite
import numba
import numpy as np
import platformdirs
from llvmlite import binding
from numba.core import serialize
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult

log = logging.getLogger(__name__)

COMPILES = "IMPACTLAB_COMPILES"
"""Environment variable of a process that compiles everything itself, for others to load."""
_SUFFIX = ".kernel"
_DIGEST = hashlib.sha256().digest_size
_FOLDER = re.compile(r"kernels-[0-9a-f]{16}(-[0-9a-f]{8})?(\.[0-9a-f]{32})?")
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
        if not _FOLDER.fullmatch(folder.name) or folder.is_symlink() or not folder.is_dir():
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


class KernelCache(_Cache):
    """The compiled forms of one function, as numba's dispatchers ask for them."""

    def __init__(self, folder: Path, function: Callable[..., Any]) -> None:
        """Cache `function` in `folder`."""
        self._folder = folder
        self._name = f"{function.__module__}.{function.__qualname__}"

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled form for these argument types, or None where there is none."""
        if COMPILES in os.environ:
            return None
        payload = _read(self._path(sig))
        if payload is None:
            return None
        target_context.refresh()
        rebuild: Any = CompileResult._rebuild
        return rebuild(target_context, *pickle.loads(payload))

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled form, unless it holds addresses of this process."""
        if data.library.has_dynamic_globals or data.lifted:
            return
        try:
            dumps: Any = serialize.dumps  # without types, as `_rebuild` above
            _write(self._path(sig), dumps(data._reduce()))
        except OSError as error:
            log.warning("%s: a compiled kernel could not be kept: %s", self._folder, error.strerror)

    def enable(self) -> None:
        """Do nothing: a function without a cache has numba's NullCache."""

    def disable(self) -> None:
        """Do nothing, see `enable`."""

    def flush(self) -> None:
        """Remove every compiled form of this function."""
        for path in self._files():
            path.unlink(missing_ok=True)

    def is_kept(self) -> bool:
        """Return whether there is a sound compiled form of this function."""
        return any(_read(path) is not None for path in self._files())

    def _files(self) -> list[Path]:
        return list(self._folder.glob(f"{self._name}-*{_SUFFIX}"))

    def _path(self, sig: Any) -> Path:
        types = hashlib.sha256(repr(sig).encode()).hexdigest()[:16]
        return self._folder / f"{self._name}-{types}{_SUFFIX}"


def discard(folder: Path) -> None:
    """Remove everything compiled from a folder."""
    for path in folder.glob(f"*{_SUFFIX}*"):
        path.unlink(missing_ok=True)


def _read(path: Path) -> bytes | None:
    """Return what a file holds after its checksum.

    None where there is no file, and where it is damaged: then its folder is emptied, since code
    compiled beside code from the cache may differ in the last bit from code compiled as a whole.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return None
    payload = content[_DIGEST:]
    if hashlib.sha256(payload).digest() == content[:_DIGEST]:
        return payload
    log.warning("damaged compiled kernels in %s are removed and compiled again", path.parent)
    discard(path.parent)
    return None


def _write(path: Path, payload: bytes) -> None:
    """Write checksum and payload into a file, all of it or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{uuid4().hex}")
    try:
        part.write_bytes(hashlib.sha256(payload).digest() + payload)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
