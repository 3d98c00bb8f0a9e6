"""Common parts of laws from outside the package: compiled functions, a hash, a register."""

import base64
import inspect
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from pkgutil import resolve_name
from types import FunctionType
from typing import Any, ClassVar

import cloudpickle
import numpy as np

from impactlab.copies import Copies, plain, source_hash
from impactlab.solver import OUTSIDE


class OwnLaw:
    """A law from Python functions, with a hash of all that they use.

    Subclasses are frozen dataclasses with a field for each function, `name`, and as fields that are
    not arguments `source_hash` and `provenance`; they call `_seal` last.
    """

    kind: ClassVar[str]
    """Kind of law, in words."""
    forms: ClassVar[Mapping[str, tuple[str, ...]]]
    """Parameters of each function; the first one is that which tells where the law is from."""
    defaults: ClassVar[Mapping[str, Callable[..., Any]]] = {}
    """Functions that take the place of those that are not stated."""
    name: str
    source_hash: str
    provenance: str

    def _seal(self, built_in: Sequence[str]) -> None:
        """Check the name, and replace the functions by copies; built_in: names that are taken."""
        title, name = type(self).__name__, self.name
        if not (isinstance(name, str) and name.isidentifier() and name == name.lower()):
            raise ValueError(
                f"{title}.name = {name!r}: must be small letters, digits and underscores, and "
                "begin with a letter"
            )
        if name in built_in:
            raise ValueError(f"{title}.name = {name!r}: is that of a built-in law: change it")
        functions = {part: getattr(self, part) or self.defaults.get(part) for part in self.forms}
        functions = {part: function for part, function in functions.items() if function}
        for part, function in functions.items():
            self._check_form(part, function)
        first = next(iter(self.forms))
        object.__setattr__(self, "provenance", _provenance(getattr(self, first)))
        copies = _canonical(type(self).__module__)
        functions = {part: copies.of(function) for part, function in functions.items()}
        try:
            digest = source_hash({"functions": functions, "name": name})
        except ValueError as error:
            raise ValueError(f"{self.kind} {name!r}: {error}") from None
        for part, function in functions.items():
            object.__setattr__(self, part, function)
        object.__setattr__(self, "source_hash", digest)

    @property
    def number(self) -> int:
        """Number of the law in case tables.

        Returns
        -------
        int
            Number that follows from the hash of the law's source.
        """
        return OUTSIDE + int(self.source_hash[:13], 16)

    @property
    def origin(self) -> str:
        """Origin of the law, in words.

        Returns
        -------
        str
            Part of a sentence, with the hash of the law's source.
        """
        return f"not of impactlab: from {self.provenance}, source hash {self.source_hash}"

    def __reduce__(self) -> Any:
        """Return the law by value, so that no process needs its module."""
        entries: Any = fields(self)  # type: ignore[arg-type]
        stated = {entry.name: getattr(self, entry.name) for entry in entries if entry.init}
        packed = base64.b85encode(zlib.compress(cloudpickle.dumps(stated)))
        return _rebuilt, (type(self), packed, self.source_hash, self.provenance)

    def _check_form(self, part: str, function: Any) -> None:
        """Raise ValueError unless a function has the parameters that it is called with."""
        python, expected, title = plain(function), self.forms[part], type(self).__name__
        if not isinstance(python, FunctionType):
            raise ValueError(
                f"{title}.{part} is of type {type(function).__name__}: expected a Python function, "
                "compiled by numba or not"
            )
        parameters = inspect.signature(python).parameters.values()
        positional = [entry for entry in parameters if entry.kind is entry.POSITIONAL_OR_KEYWORD]
        required = [entry for entry in positional if entry.default is entry.empty]
        if len(positional) != len(parameters) or not (
            len(required) <= len(expected) <= len(positional)
        ):
            raise ValueError(
                f"{title}.{part}: has the parameters {inspect.signature(python)}: expected "
                f"({', '.join(expected)})"
            )


def _provenance(function: Any) -> str:
    code = plain(function).__code__
    return f"{plain(function).__module__} ({code.co_filename}, line {code.co_firstlineno})"


def _canonical(module: str) -> Copies:
    """Return the copies of a law's functions: Python's, by names that depend on their order.

    module: one that any process can import.
    """
    count = iter(range(10**9))

    def finish(original: Any, copy: FunctionType) -> FunctionType:
        name = plain(original).__name__.replace("<lambda>", "function")
        copy.__qualname__ = copy.__name__ = f"{name.rstrip('0123456789')}{next(count)}"
        copy.__module__ = copy.__globals__["__name__"] = module
        return copy

    return Copies(finish)


def _rebuilt(kind: type[Any], packed: bytes, digest: str, provenance: str) -> OwnLaw:
    """Return a law from another process. Raises RuntimeError where its code is not the same here.

    The code of functions depends on the version of Python.
    """
    law: OwnLaw = kind(**cloudpickle.loads(zlib.decompress(base64.b85decode(packed))))
    if law.source_hash != digest:
        raise RuntimeError(
            f"the {law.kind} {law.name!r} arrived with another source (hash {law.source_hash}, "
            f"not {digest}): install the same versions of Python, NumPy and numba on all workers"
        )
    object.__setattr__(law, "provenance", provenance)
    return law


class LawNames(Sequence[str]):
    """The names of all laws of a kind that this process knows; a law's index is its number.

    A name of another package's entry point is registered when it is asked for.
    """

    def __init__(
        self,
        law_class: type[OwnLaw],
        built_in: Sequence[str],
        named: dict[str, Any],
        numbered: dict[int, Any],
        group: str,
        refusals: str,
    ) -> None:
        """Keep laws from outside in `named` and `numbered`, those of the kernels.

        named: the built-in ones, too. group: of the entry points. refusals: path of the function
        that returns what speaks against a law.
        """
        self.law_class, self.built_in, self.group = law_class, built_in, group
        self._named, self._numbered, self._refusals = named, numbered, refusals
        REGISTERS[law_class] = self

    @cached_property
    def _entry_points(self) -> dict[str, EntryPoint]:
        return {entry.name: entry for entry in entry_points(group=self.group)}

    def __contains__(self, name: object) -> bool:
        """Return whether a law has this name.

        Raises ValueError where an entry point is no law, or its law does not pass the checks.
        """
        if not isinstance(name, str) or name in self._named or name not in self._entry_points:
            return isinstance(name, str) and name in self._named
        entry, kind = self._entry_points[name], self.law_class
        package = f"{entry.dist.name} {entry.dist.version}" if entry.dist else "another package"
        stated = f"{kind.kind} {name!r} of the entry point {entry.value} ({package})"
        try:
            law = entry.load()
        except Exception as error:  # whatever the package raises
            raise ValueError(f"{stated}: cannot be loaded: {error}") from error
        if not isinstance(law, kind) or law.name != name:
            raise ValueError(f"{stated}: is no il.{kind.__name__} of this name")
        if reasons := resolve_name(self._refusals)(law):
            raise ValueError(f"{stated}: {'; '.join(reasons)}")
        object.__setattr__(law, "provenance", f"{package}, entry point {entry.value}")
        self.adopt(law)
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(tuple(self._named))

    def __len__(self) -> int:
        return len(self._named)

    def __getitem__(self, number: Any) -> Any:
        if isinstance(number, slice):
            return tuple(self._named)[number]
        return self._numbered[int(number)].name if number >= OUTSIDE else self.built_in[number]

    def index(self, name: str, *_: int) -> int:
        """Return the number of the law."""
        built_in = self.built_in
        return built_in.index(name) if name in built_in else int(self._named[name].number)

    def adopt(self, law: Any) -> None:
        """Let this process know a law that was checked before."""
        self._numbered[law.number] = self._named[law.name] = law

    def registered(self, law: OwnLaw) -> str:
        """Return the name of a law. Raises ValueError unless it is registered with this source."""
        if getattr(self._named.get(law.name), "source_hash", "") != law.source_hash:
            raise ValueError(
                f"{law.kind} {law.name!r} (source hash {law.source_hash}) is not registered: call "
                "il.register with it first"
            )
        return law.name

    def outside(self, names: Any) -> list[Any]:
        """Return the laws from outside the package among these names."""
        laws = (self._named.get(str(name)) for name in dict.fromkeys(np.ravel(names).tolist()))
        return [law for law in laws if isinstance(law, self.law_class)]


REGISTERS: dict[type[OwnLaw], LawNames] = {}
"""The names of each kind of law."""


def adopt(law: OwnLaw) -> None:
    """Let this process know a law that was checked before."""
    REGISTERS[type(law)].adopt(law)
