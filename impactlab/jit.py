"""Functions compiled by numba: free of the GIL, kept in a folder of their sources' own.

Kernels are compiled by processes of their own (`precompile`), which leave them in the cache. A
process that compiles one runs other machine code than one that loads it: of the copies of an inner
function it links another one, whose sums may be ordered differently, and answers may differ in the
last bit. So all processes load it. (One that has compiled an inner function itself, as tests do,
still links that.)

numba's own cache notices a changed function, but neither a changed callee in another file nor a
damaged file, and looks for code by the path and age of its source. Here a folder belongs to one set
of sources and kind of machine, wherever the sources lie, it has one file per function and
signature, with a checksum, and a damaged file empties its folder.

This module and machine_code.py alone use numba's private parts (`_PRIVATE`), for the cache and to
compile sooner.
Where one is missing, or under IMPACTLAB_PLAIN_NUMBA=1, every process compiles its kernels with
numba's public options, which takes longer and gives the same bits: what is summed in another order
in a second copy (`summing` in solver/jit.py) is then inlined.
"""

import hashlib
import logging
import os
import pickle
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from operator import attrgetter
from pathlib import Path
from typing import Any, TypeVar, cast
from uuid import uuid4

import numpy as np
import platformdirs
from filelock import FileLock

try:
    import numba
except ValueError as _error:
    _settings = sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
    if not _settings:
        raise
    raise ValueError(
        f"numba refuses a setting of the environment ({', '.join(_settings)}): {_error} "
        "Correct or unset it."
    ) from None
import llvmlite
from llvmlite import binding

from impactlab import machine_code

Function = TypeVar("Function", bound=Callable[..., Any])

log = logging.getLogger(__name__)

_COMPILES = "IMPACTLAB_COMPILES"
"""Environment variable of a process that compiles kernels, for others to load: their names."""
_PRIVATE = (
    *(f"core.codegen.CPUCodeLibrary.{stage}" for stage in machine_code.STAGES),
    "core.codegen.CPUCodeLibrary.has_dynamic_globals",
    "core.codegen.JITCPUCodegen.set_env",
    "core.compiler.CompileResult._rebuild",
    "core.compiler.CompileResult._reduce",
    "core.options.DefaultOptions._nrt",
    "core.options.DefaultOptions.no_cfunc_wrapper",
    "core.options.DefaultOptions.no_cpython_wrapper",
    "core.serialize.dumps",
)
"""Parts of numba that are not documented."""
_SUFFIX = ".kernel"
_DIGEST = hashlib.sha256().digest_size
_FOLDER = re.compile(r"kernels-[0-9a-f]{16}(-[0-9a-f]{8})?(\.[0-9a-f]{32})?")
_QUIET = 600.0
"""Seconds for which further kernels are compiled without a message, by any process."""
_UNUSED = 30 * 24 * 3600.0
"""Seconds after which the folder of other sources, or of another machine, is taken away."""


def _uses_private_parts() -> bool:
    if os.environ.get("IMPACTLAB_PLAIN_NUMBA", "0") != "0":
        return False
    try:
        attrgetter(*_PRIVATE)(numba)
    except AttributeError as missing:
        log.warning(
            "numba %s is not fully supported (%s), so each process compiles its kernels anew",
            numba.__version__,
            missing,
        )
        return False
    return True


_IS_PLAIN = not _uses_private_parts()


def cache_folder(sources_hash: str) -> Path | None:
    """Return the folder for these sources on this machine, or None where none can be used."""
    if _IS_PLAIN:
        return None
    config: Any = numba.config  # numba's types do not list its settings
    name, features = config.CPU_NAME or binding.get_host_cpu_name(), config.CPU_FEATURES
    if features is None:
        features = binding.get_host_cpu_features().flatten()
    tools = sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__
    machine = hashlib.sha256(f"{name} {features} {tools}".encode()).hexdigest()[:8]
    setting = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(setting) if setting else platformdirs.user_cache_path("impactlab")
    folder = root / f"kernels-{sources_hash[:16]}-{machine}"
    try:
        if not folder.exists():
            folder.mkdir(parents=True, exist_ok=True)
            _remove_unused(root)
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


def _remove_unused(root: Path) -> None:
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


class KernelCache:
    """The compiled forms of one function, as numba's dispatchers ask for them."""

    def __init__(self, folder: Path, name: str) -> None:
        """Cache the function of this name in `folder`."""
        self.folder, self.name = folder, name
        self.files = f"{name}-{{}}{_SUFFIX}"

    @property
    def cache_path(self) -> str:
        """The folder, as numba's statistics name it."""
        return str(self.folder)

    def _path(self, sig: Any) -> Path:
        types = hashlib.sha256(repr(sig).encode()).hexdigest()[:16]
        return self.folder / self.files.format(types)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled form for these argument types, or None where there is none."""
        if _COMPILES in os.environ or (payload := _read(self._path(sig))) is None:
            return None
        target_context.refresh()
        rebuild: Any = numba.core.compiler.CompileResult._rebuild
        return rebuild(target_context, *pickle.loads(payload))

    def has_any(self) -> bool:
        """Return whether there is a compiled form, and it is sound."""
        return any(_read(path) for path in self.folder.glob(self.files.format("*")))

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled form that holds no addresses of this process: all of it or nothing."""
        if data.library.has_dynamic_globals or data.lifted:
            return
        path = self._path(sig)
        part = path.with_name(f"{path.name}.{uuid4().hex}")
        dumps: Any = numba.core.serialize.dumps  # without types, as `_rebuild` above
        payload = dumps(data._reduce())
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            part.write_bytes(hashlib.sha256(payload).digest() + payload)
            part.replace(path)
        except OSError as error:
            log.warning("%s: a compiled kernel could not be kept: %s", self.folder, error.strerror)
            discard(self.folder, part.name)

    def enable(self) -> None:
        """Do nothing: a function without a cache has numba's NullCache."""

    disable = enable

    def flush(self) -> None:
        """Remove every compiled form of this function."""
        discard(self.folder, self.files.format("*"))


def discard(folder: Path, files: str = f"*{_SUFFIX}*") -> None:
    """Remove everything compiled, or these files, from a folder."""
    for path in folder.glob(files):
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


class Compiler:
    """Makes the decorators of one package of kernels.

    sources_hash: SHA-256 (hex) of all sources of the package and of this one, and of numba's
    version. folder: where its compiled kernels are kept; None: they cannot be kept.
    """

    def __init__(self, root: Path) -> None:
        """Compile the package in the folder `root`."""
        digest = hashlib.sha256(numba.__version__.encode())
        beside = Path(__file__), Path(machine_code.__file__)
        for path in (*sorted(root.rglob("*.py")), *beside):
            name = path.relative_to(root) if path.is_relative_to(root) else path.name
            digest.update(str(name).encode() + b"\0" + path.read_bytes())
        self.sources_hash = digest.hexdigest()
        self.folder = cache_folder(self.sources_hash)

    def decorator(
        self, *, fastmath: Any = False, inline: bool = False, allocates: bool = False
    ) -> Callable[[Function], Function]:
        """Return a decorator that compiles functions; under NUMBA_DISABLE_JIT=1 it changes nothing.

        fastmath: what may be done to sums and products, as in LLVM. inline: always part of the
        callers, whose loops can then be vectorised. allocates: whether the functions may make or
        own arrays: then they have numba's counting of references (`_nrt`), which costs time at
        each call; others that make an array do not compile.
        """
        jit: Any = numba.njit  # its types do not list `_nrt`

        def compiled(function: Function) -> Function:
            # Functions made by one function share its name. The cache would take them for each
            # other, and so would the linker, which joins symbols of one name across kernels.
            is_made = "<locals>" in function.__qualname__
            if is_made:
                _MADE[function.__qualname__] += 1
                function.__qualname__ += f"_{_MADE[function.__qualname__]}"
            name = f"{function.__module__}.{function.__qualname__}"
            # In a process that compiles kernels, Python can call these alone, which alone are
            # kept: what makes the others ready for Python would take half of the time.
            called = name in os.environ.get(_COMPILES, name).split()
            if called:
                machine_code.CALLED.add(function.__qualname__)
            if fastmath:
                machine_code.LOOPS.add(function.__qualname__)
            private = {
                "_nrt": allocates,
                "no_cfunc_wrapper": True,
                "no_cpython_wrapper": not called,
            }
            dispatcher = jit(
                nogil=True,
                error_model="numpy",
                fastmath=fastmath,
                forceinline=inline,
                **({} if _IS_PLAIN else private),
            )(function)
            if called and not is_made and self.folder is not None and hasattr(dispatcher, "_cache"):
                dispatcher._cache = KernelCache(self.folder, name)
            dispatcher.decorate = compiled  # for copies of it (copies.py)
            return cast(Function, dispatcher)

        return compiled


_MADE: Counter[str] = Counter()
"""How many functions another function has made, by their qualified name."""
if _COMPILES in os.environ and not _IS_PLAIN:
    machine_code.optimize_once()


def _announce(folder: Path) -> None:
    """Say that kernels are compiled, unless a process has just said so."""
    said = folder / f"compiling{_SUFFIX}s"  # removed with them
    with FileLock(folder / "compiling.lock"):
        silent = said.exists() and time.time() - said.stat().st_mtime < _QUIET
        said.touch()
    if not silent:
        print("impactlab: compiling kernels, once, about 15 s each", file=sys.stderr, flush=True)


_SOUGHT: set[Any] = set()
"""Kernels that this process has looked for in the cache."""


def precompile(programs: Mapping[Any, str]) -> None:
    """Compile kernels in other processes, one per processor, unless they are in the cache.

    programs: Python code that calls it, by compiled function. Kernels that one process compiles
    share what they have in common. Where a kernel has no cache, or no other process can be started,
    the calling process will compile. Processes that need one at the same time wait for the first
    one's.
    """
    sought = {kernel: program for kernel, program in programs.items() if kernel not in _SOUGHT}
    if sought and _COMPILES not in os.environ and sys.executable:
        caches = {getattr(kernel, "_cache", None): program for kernel, program in sought.items()}
        missing = [
            (cache, program)
            for cache, program in caches.items()
            if isinstance(cache, KernelCache) and not cache.has_any()
        ]
        count = min(len(missing), os.cpu_count() or 1)
        with ThreadPoolExecutor(max(count, 1)) as pool:
            list(pool.map(_compile_elsewhere, (missing[start::count] for start in range(count))))
    _SOUGHT.update(sought)


def _compile_elsewhere(kernels: Sequence[tuple[KernelCache, str]]) -> None:
    """Compile kernels in one other process, those that nobody else leaves in the cache."""
    root = str(Path(__file__).resolve().parents[1])  # the same package, wherever it was found
    paths = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))
    try:
        with ExitStack() as locks:
            # in one order, so that no two processes wait for each other
            for cache, _ in sorted(kernels, key=lambda kernel: kernel[0].name):
                locks.enter_context(FileLock(cache.folder / f"{cache.name}.lock"))
            missing = {cache: program for cache, program in kernels if not cache.has_any()}
            if not missing:
                return
            _announce(kernels[0][0].folder)
            names = " ".join(cache.name for cache in missing)
            program = "\n".join(["import gc; gc.disable()", *missing.values()])  # 5 % of the time
            done = subprocess.run(
                [sys.executable, "-c", program],
                env=os.environ | {_COMPILES: names, "PYTHONPATH": paths},
                capture_output=True,
                text=True,
                check=False,
            )
        log.debug("%s precompiled, exit code %s: %s", names, done.returncode, done.stderr)
        if done.returncode:
            log.warning(
                "another process that compiled kernels (%s) failed with exit code %s, so this one "
                "compiles them, and may link parts that do not belong together: check the answers "
                "with IMPACTLAB_PLAIN_NUMBA=1",
                names,
                done.returncode,
            )
    except OSError as error:
        log.debug("kernels cannot be precompiled: %s", error)
