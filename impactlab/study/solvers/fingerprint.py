"""Fingerprints of Python functions: equal only where they give equal answers.

A fingerprint covers the compiled code with its defaults and constants, the variables of enclosing
scopes and the globals that it uses, and those of the functions that it calls. Installed packages
count by name and version.
"""

import dis
import sys
import sysconfig
from collections.abc import Iterator
from functools import partial
from hashlib import sha256
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis), np.generic)
_INSTALLED = tuple(
    sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")
)


def fingerprint(call: Any) -> str:
    """Return 16 hexadecimal digits. Raises ValueError naming what cannot be identified."""
    digest = sha256(f"{sys.version_info[:2]}".encode())
    for token in _tokens(call, getattr(call, "__qualname__", "it"), set()):
        digest.update(f"{len(token)} {token}".encode())
    return digest.hexdigest()[:16]


def _tokens(value: Any, name: str, seen: set[int]) -> Iterator[str]:
    """Yield texts that differ where the value does; seen: ids of what was met before."""
    yield type(value).__name__
    if isinstance(value, _PLAIN):
        yield repr(value)
    elif package := _package(value):
        yield f"{package} {getattr(value, '__qualname__', '')}"
    elif id(value) not in seen:
        seen.add(id(value))
        compiled = getattr(value, "py_func", None)  # by numba
        yield from _content(value if compiled is None else compiled, name, seen)


def _content(value: Any, name: str, seen: set[int]) -> Iterator[str]:
    match value:
        case tuple() | list():
            for item in value:
                yield from _tokens(item, name, seen)
        case set() | frozenset():
            yield from sorted(" ".join(_tokens(item, name, seen)) for item in value)
        case dict():
            yield from _tokens([*value.items()], name, seen)
        case np.ndarray() if value.dtype.kind == "O":
            yield from _tokens(value.tolist(), name, seen)
        case np.ndarray():
            content = sha256(np.ascontiguousarray(value).data).hexdigest()
            yield f"{value.dtype} {value.shape} {content}"
        case partial():
            yield from _tokens((value.func, value.args, value.keywords), name, seen)
        case _:
            yield from _code(value, name, seen)


def _code(value: Any, name: str, seen: set[int]) -> Iterator[str]:
    match value:
        case CodeType():
            yield f"{value.co_code.hex()} {value.co_names} {value.co_varnames} {value.co_flags}"
            yield from _tokens(value.co_consts, name, seen)
        case FunctionType():
            code = value.__code__
            yield from _tokens(code, name, seen)
            yield from _tokens((value.__defaults__, value.__kwdefaults__), "a default", seen)
            for variable, cell in zip(code.co_freevars, value.__closure__ or (), strict=True):
                yield from _tokens(cell.cell_contents, f"its variable {variable}", seen)
            for variable in sorted(_globals(code) & value.__globals__.keys()):
                yield variable
                yield from _tokens(value.__globals__[variable], f"its global {variable}", seen)
        case ModuleType():
            yield sha256(Path(str(value.__file__)).read_bytes()).hexdigest()
        case type():
            methods = {k: part for k, part in vars(value).items() if isinstance(part, FunctionType)}
            yield from _tokens((value.__bases__, methods), name, seen)
        case _:
            raise ValueError(
                f"{name} is of type {type(value).__name__}, which cannot be identified, so that "
                "answers of another function could be taken for its own: give "
                "il.Function(..., version='1'), and change the version whenever its answers change"
            )


def _globals(code: CodeType) -> set[str]:
    """Return the names of globals that the code uses, that of inner functions included."""
    steps = dis.get_instructions(code)
    names = {str(step.argval) for step in steps if step.opname == "LOAD_GLOBAL"}
    return names.union(*(_globals(part) for part in code.co_consts if isinstance(part, CodeType)))


def _package(value: Any) -> str:
    """Return name and version of the installed package that a value comes from, else ""."""
    module = value if isinstance(value, ModuleType) else None
    if isinstance(value, type | FunctionType | BuiltinFunctionType | np.ufunc):
        module = sys.modules.get(getattr(value, "__module__", None) or "numpy")
    if module is None:
        return ""
    top, file = module.__name__.partition(".")[0], getattr(module, "__file__", None)
    if module.__name__ == "__main__":
        return ""
    if top != "impactlab" and file and not file.startswith(_INSTALLED):
        return ""
    return f"{module.__name__} {getattr(sys.modules[top], '__version__', '')}"
