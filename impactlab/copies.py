"""Copies of functions with all that they call, and the hash of such a copy's source.

Compiled code is joined by the names of functions, so code of one name and two sources must never
meet in a process. A copy has names of its own, and calls copies alone, wherever the functions find
them: in globals, in modules and in scopes around them. Those of Python, NumPy, SciPy and numba
stay. Constants have the values that they had when the copy was made.
"""

import dis
import sys
from collections.abc import Callable, Iterator
from hashlib import sha256
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_LIBRARIES = {*sys.stdlib_module_names, "numpy", "numba", "scipy", "llvmlite"} - {"builtins"}
_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis), np.generic)


def plain(function: Any) -> Any:
    """Return the Python function of a compiled one; others as they are."""
    return getattr(function, "py_func", function)


class Copies:
    """The copies of functions, one of each.

    finish(original, copy) makes of each copy what takes the original's place; it may name it.
    """

    def __init__(self, finish: Callable[[Any, FunctionType], Any]) -> None:
        """Copy by `finish`."""
        self._finish = finish
        self._copies: dict[int, tuple[Any, Any]] = {}  # originals, so that no id is used again

    def put(self, original: Any, substitute: Any) -> None:
        """Let another function take the place of one."""
        self._copies[id(original)] = original, substitute

    def of(self, value: Any, names: frozenset[str] = frozenset()) -> Any:
        """Return the copy of a function, or of a module with its parts `names`; else `value`."""
        if id(value) in self._copies:
            return self._copies[id(value)][1]
        function = plain(value)
        if isinstance(function, FunctionType) and not _is_of_library(function.__module__):
            return self._function(value, function)
        if isinstance(value, ModuleType) and not _is_of_library(value.__name__):
            return self._module(value, names, {})
        return value

    def _function(self, original: Any, function: FunctionType) -> Any:
        namespace: dict[str, Any] = {"__name__": function.__module__}
        cells = tuple(CellType() for _ in function.__closure__ or ())
        code = function.__code__
        copy = FunctionType(code, namespace, function.__name__, function.__defaults__, cells)
        copy.__kwdefaults__, copy.__qualname__ = function.__kwdefaults__, function.__qualname__
        result = self._finish(original, copy)
        self.put(original, result)  # before what it calls, which may call it
        names = frozenset(_names(code))
        for name in sorted(_globals(code) & function.__globals__.keys()):
            namespace[name] = self.of(function.__globals__[name], names)
        for cell, before in zip(cells, function.__closure__ or (), strict=True):
            cell.cell_contents = self.of(before.cell_contents, names)
        return result

    def _module(
        self, module: ModuleType, names: frozenset[str], modules: dict[int, ModuleType]
    ) -> ModuleType:
        if id(module) in modules:
            return modules[id(module)]
        copy = modules[id(module)] = ModuleType(f"copy of {module.__name__}")
        for name in sorted(names):
            if (value := getattr(module, name, None)) is not None:
                inner = isinstance(value, ModuleType) and not _is_of_library(value.__name__)
                part = self._module(value, names, modules) if inner else self.of(value)
                setattr(copy, name, part)
        return copy


def source_hash(functions: dict[str, Any]) -> str:
    """Return 16 hexadecimal digits that differ where functions do, or what they use.

    Functions of libraries count by name and version. Raises ValueError naming what cannot be told
    from its like.
    """
    digest = sha256(f"{sys.version_info[:2]}".encode())
    for token in _tokens(functions, "a function", {}):
        digest.update(f"{len(token)} {token}".encode())
    return digest.hexdigest()[:16]


def _is_of_library(module: str | None) -> bool:
    return (module or "").partition(".")[0] in _LIBRARIES


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for part in code.co_consts:
        if isinstance(part, CodeType):
            yield from _names(part)


def _globals(code: CodeType) -> set[str]:
    """Return the names of globals that the code uses, that of inner functions included."""
    names = {str(step.argval) for step in dis.get_instructions(code) if "_GLOBAL" in step.opname}
    return names.union(*(_globals(part) for part in code.co_consts if isinstance(part, CodeType)))


def _tokens(  # noqa: C901
    value: Any, name: str, seen: dict[int, int]
) -> Iterator[str]:
    """Yield texts that differ where the value does; seen: number of each function, by its id."""
    value = plain(value)
    yield type(value).__name__
    match value:
        case _ if isinstance(value, _PLAIN):
            yield repr(value)
        case tuple() | list():
            yield str(len(value))
            for item in value:
                yield from _tokens(item, name, seen)
        case frozenset():
            yield from sorted(" ".join(_tokens(item, name, seen)) for item in value)
        case dict():
            for key in sorted(value):
                yield str(key)
                yield from _tokens(value[key], str(key), seen)
        case np.ndarray() if value.dtype.kind in "biufc":
            yield f"{value.dtype} {value.shape} {sha256(value.tobytes()).hexdigest()}"
        case CodeType():
            yield f"{value.co_code.hex()} {value.co_names} {value.co_varnames} {value.co_flags}"
            yield f"{value.co_freevars} {value.co_cellvars}"
            yield from _tokens(value.co_consts, name, seen)
        case FunctionType() if not _is_of_library(value.__module__):
            yield from _function_tokens(value, seen)
        case ModuleType() if not _is_of_library(value.__name__):
            yield from _tokens(dict(sorted(_public(value).items())), name, seen)
        case FunctionType() | ModuleType() | BuiltinFunctionType() | type() | np.ufunc():
            module = str(getattr(value, "__module__", None) or getattr(value, "__name__", ""))
            version = getattr(sys.modules.get(module.partition(".")[0]), "__version__", "")
            yield f"{module} {version} {getattr(value, '__qualname__', value.__name__)}"
        case _:
            raise ValueError(
                f"uses {name}, which is of type {type(value).__name__} and cannot be identified: "
                "use numbers, tuples of them, arrays and functions"
            )


def _public(module: ModuleType) -> dict[str, Any]:
    return {name: part for name, part in vars(module).items() if not name.startswith("__")}


def _function_tokens(function: FunctionType, seen: dict[int, int]) -> Iterator[str]:
    if id(function) in seen:
        yield str(seen[id(function)])
        return
    seen[id(function)] = len(seen)
    code = function.__code__
    yield from _tokens(code, function.__name__, seen)
    yield from _tokens((function.__defaults__, function.__kwdefaults__ or {}), "a default", seen)
    for variable, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        yield from _tokens(cell.cell_contents, f"the variable {variable}", seen)
    for variable in sorted(_globals(code) & function.__globals__.keys()):
        yield variable
        yield from _tokens(function.__globals__[variable], f"the global {variable}", seen)
