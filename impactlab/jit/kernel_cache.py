"""Compiled functions on disk: one file per function and signature, with a checksum.

numba's own cache notices a changed function, but neither a changed callee in another file nor a
damaged file, and looks for code by the path and age of its source. Here a folder belongs to one set
of sources (see folder.py), wherever these lie, and a damaged file means an empty folder.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any
from uuid import uuid4

from numba.core import serialize
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult

log = logging.getLogger(__name__)

COMPILES = "IMPACTLAB_COMPILES"
"""In the environment of a process that compiles everything itself, for others to load."""
_SUFFIX = ".kernel"
_DIGEST = hashlib.sha256().digest_size


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
    """Put checksum and payload into a file, all of it or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{uuid4().hex}")
    try:
        part.write_bytes(hashlib.sha256(payload).digest() + payload)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
