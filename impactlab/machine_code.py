"""How numba makes machine code in a process that compiles kernels for others (jit.py)."""

from typing import Any

import numba

CALLED: set[str] = set()
"""Functions that Python can call in this process, by qualified name."""
LOOPS: set[str] = set()
"""Functions whose sums may be reordered: they keep the order that they have by themselves."""
STAGES = "_optimize_functions", "finalize", "_finalize_final_module"
"""Methods by which numba makes machine code of a function."""


def optimize_once() -> None:
    """Optimise what Python calls with all within it, and within it only loops by themselves.

    numba links, optimises and emits every function with all that it calls, which takes a fifth
    of the time; the kernel has its own copies.
    """
    library: Any = numba.core.codegen.CPUCodeLibrary
    machine: Any = numba.core.codegen.JITCPUCodegen
    tidy, finalize, emit = (getattr(library, name) for name in STAGES)
    set_env = machine.set_env

    def tidy_whole(self: Any, module: Any) -> None:
        if _is_whole(self):
            tidy(self, module)
        else:
            module.data_layout = self._codegen._data_layout

    def finalize_whole(self: Any) -> None:
        if _is_whole(self):
            self._linking_libraries = _callees(self)
            finalize(self)
        self._finalized = True

    def emit_called(self: Any) -> None:
        if self.name in CALLED:
            emit(self)

    def set_env_of_called(self: Any, name: str, env: Any) -> None:
        if self._engine.get_global_value_address(name):
            set_env(self, name, env)

    for name, stage in zip(STAGES, (tidy_whole, finalize_whole, emit_called), strict=True):
        setattr(library, name, stage)
    machine.set_env = set_env_of_called


def _is_whole(library: Any) -> bool:
    """Return whether a library of numba is optimised by itself.

    It has machine code of its own, or its sums, or those of what it calls, may be reordered: they
    keep the order that they have where numba optimises every function.
    """
    names = {library.name, *(callee.name for callee in library._linking_libraries)}
    return library.name in CALLED or not names.isdisjoint(LOOPS)


def _callees(library: Any) -> list[Any]:
    """Return all that a library calls, callers first: LLVM links only what has been called."""
    callees: dict[Any, None] = {}

    def add(caller: Any) -> None:
        for callee in caller._linking_libraries:
            if callee not in callees:
                add(callee)
                callees[callee] = None

    add(library)
    return list(reversed(callees))
