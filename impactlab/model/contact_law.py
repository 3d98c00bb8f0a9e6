"""Contact laws from outside the package: the class, and how sessions come to know them."""

from __future__ import annotations

import base64
import inspect
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pkgutil import resolve_name
from types import FunctionType
from typing import Any

import cloudpickle

from impactlab.copies import Copies, plain, source_hash
from impactlab.solver.contact import CONTACT_LAWS, LAWS, NUMBERED, OUTSIDE, LawRecord

GROUP = "impactlab.contact_laws"
"""Group of the entry points of other packages, each a ContactLaw under its name."""
_FORMS = {
    "curve": ("delta", "E", "R", "S_y", "nu"),
    "limit": ("E", "R", "S_y", "nu"),
    "radius": ("delta", "E", "R", "S_y", "nu"),
    "damping": ("F", "delta", "rate", "E", "R", "S_y", "nu"),
}
"""Parameters of each function of a law."""


@dataclass(frozen=True, kw_only=True)
class ContactLaw(LawRecord):
    """A contact law of one's own, from Python functions that numba compiles.

    Its functions are copied when it is made, with all that they call and the constants that they
    use; what is changed afterwards makes another law. They get the indentation `delta` (m) of the
    loading curve, the effective modulus `E` (Pa) and radius `R` (m) of the two bodies, and of the
    softer one the yield stress `S_y` (Pa) and Poisson's ratio `nu`.

    Parameters
    ----------
    name : str
        Name in studies: small letters, digits and underscores; not that of a built-in law.
    short : str, optional
        Name in figures; by default `name`.
    title : str, optional
        Name in words; by default `name`.
    source : str, default "a user's own law"
        Author and equations.
    holds_for : str, default "indentations up to its limit"
        Range, in words; `limit` is the same as a number.
    unconfirmed : str, optional
        Parts of the law that nothing confirms.
    flaws : str, optional
        Jumps, energy that it creates and dents below zero, in words.
    yield_pressure : float, optional
        Largest Hertz pressure at first yield over `S_y`, for steel; it is the unit of `jumps` and
        `creates`, as an indentation.
    jumps : tuple of (float, float), optional
        Jumps of the loading force, for steel: indentation over that of first yield, and relative
        height.
    unloading_start : float, default 1
        Force at the start of unloading over the loading force, at the worst.
    restitution : float, default 1
        Largest coefficient of restitution.
    creates : (float, float), optional
        Range of largest indentations, over that of first yield, in which it creates energy.
    dent : float, default 0
        Lowest residual indentation over the largest one.
    curve : callable
        `curve(delta, E, R, S_y, nu)` returns (F, K, delta_r, n): the force (N) of loading, and the
        curve K (d - delta_r)^n on which the contact unloads from there.
    limit : callable, optional
        `limit(E, R, S_y, nu)` returns the indentation (m) up to which the law holds; by default R.
    radius : callable, optional
        `radius(delta, E, R, S_y, nu)` returns the radius (m) of the contact circle; by default
        sqrt(R delta).
    damping : callable, optional
        `damping(F, delta, rate, E, R, S_y, nu)` returns the force (N) to add to F, that of the
        curves, where the approach `delta` grows at `rate` (m/s).
    hertzian_start : bool, default True
        Whether the curve begins as Hertz's.

    Raises
    ------
    ValueError
        If the name cannot be used, a function has other parameters, or uses what cannot be copied.

    Examples
    --------
    >>> def curve(delta, E, R, S_y, nu):
    ...     K = 4.0 / 3.0 * E * R**0.5
    ...     return K * delta**1.5, K, 0.0, 1.5
    >>> il.ContactLaw(name="elastic", curve=curve).title
    'elastic'
    """

    source: str = "a user's own law"
    holds_for: str = "indentations up to its limit"
    curve: Callable[..., Any]
    limit: Callable[..., float] | None = None
    radius: Callable[..., float] | None = None
    damping: Callable[..., float] | None = None
    hertzian_start: bool = True
    source_hash: str = field(init=False)
    provenance: str = field(init=False)

    def __post_init__(self) -> None:
        name = self.name
        if not (isinstance(name, str) and name.isidentifier() and name == name.lower()):
            raise ValueError(
                f"ContactLaw.name = {name!r}: must be small letters, digits and underscores, and "
                "begin with a letter"
            )
        if name in LAWS:
            raise ValueError(f"ContactLaw.name = {name!r}: is that of a built-in law: change it")
        functions = {part: getattr(self, part) or _DEFAULTS.get(part) for part in _FORMS}
        functions = {part: function for part, function in functions.items() if function}
        for part, function in functions.items():
            _check_form(part, function)
        object.__setattr__(self, "provenance", _provenance(self.curve))
        copies = _canonical()
        functions = {part: copies.of(function) for part, function in functions.items()}
        try:
            digest = source_hash({"functions": functions, "name": name})
        except ValueError as error:
            raise ValueError(f"contact law {name!r}: {error}") from None
        for part, function in functions.items():
            object.__setattr__(self, part, function)
        object.__setattr__(self, "source_hash", digest)
        for text in ("short", "title"):
            object.__setattr__(self, text, getattr(self, text) or name)

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
        stated = {entry.name: getattr(self, entry.name) for entry in fields(self) if entry.init}
        packed = zlib.compress(cloudpickle.dumps(stated))
        return _rebuilt, (base64.b85encode(packed), self.source_hash, self.provenance)


def _hertz_limit(E: float, R: float, S_y: float, nu: float) -> float:
    return R


def _hertz_radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    return float((R * delta) ** 0.5)


_DEFAULTS: dict[str, Callable[..., Any]] = {"limit": _hertz_limit, "radius": _hertz_radius}


def _check_form(part: str, function: Any) -> None:
    """Raise ValueError unless a function of a law has the parameters that it is called with."""
    python, expected = plain(function), _FORMS[part]
    if not isinstance(python, FunctionType):
        raise ValueError(
            f"ContactLaw.{part} is of type {type(function).__name__}: expected a Python function, "
            "compiled by numba or not"
        )
    parameters = inspect.signature(python).parameters.values()
    positional = [entry for entry in parameters if entry.kind in (entry.POSITIONAL_OR_KEYWORD,)]
    required = [entry for entry in positional if entry.default is entry.empty]
    if len(positional) != len(parameters) or not (
        len(required) <= len(expected) <= len(positional)
    ):
        raise ValueError(
            f"ContactLaw.{part}: has the parameters {inspect.signature(python)}: expected "
            f"({', '.join(expected)})"
        )


def _provenance(function: Any) -> str:
    code = plain(function).__code__
    return f"{plain(function).__module__} ({code.co_filename}, line {code.co_firstlineno})"


def _canonical() -> Copies:
    """Return the copies of a law's functions: Python's, by names that depend on their order."""
    count = iter(range(10**9))

    def finish(original: Any, copy: FunctionType) -> FunctionType:
        name = plain(original).__name__.replace("<lambda>", "function")
        copy.__qualname__ = copy.__name__ = f"{name.rstrip('0123456789')}{next(count)}"
        copy.__module__ = copy.__globals__["__name__"] = __name__  # which any process can import
        return copy

    return Copies(finish)


def _rebuilt(packed: bytes, digest: str, provenance: str) -> ContactLaw:
    """Return a law from another process. Raises RuntimeError where its code is not the same here.

    The code of functions depends on the version of Python.
    """
    law = ContactLaw(**cloudpickle.loads(zlib.decompress(base64.b85decode(packed))))
    if law.source_hash != digest:
        raise RuntimeError(
            f"the contact law {law.name!r} arrived with another source (hash {law.source_hash}, "
            f"not {digest}): install the same versions of Python, NumPy and numba on all workers"
        )
    object.__setattr__(law, "provenance", provenance)
    return law


def adopt(law: Any) -> None:
    """Let this process know a law that was checked before."""
    NUMBERED[law.number] = CONTACT_LAWS[law.name] = law


@cache
def _entry_points() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}


def known(name: object) -> bool:
    """Return whether a law has this name; one of another package's entry points is registered.

    Raises ValueError where the entry point is no law, or its law does not pass the checks.
    """
    if not isinstance(name, str) or name in CONTACT_LAWS or name not in _entry_points():
        return isinstance(name, str) and name in CONTACT_LAWS
    entry = _entry_points()[name]
    package = f"{entry.dist.name} {entry.dist.version}" if entry.dist else "another package"
    stated = f"contact law {name!r} of the entry point {entry.value} ({package})"
    try:
        law = entry.load()
    except Exception as error:  # whatever the package raises
        raise ValueError(f"{stated}: cannot be loaded: {error}") from error
    if not isinstance(law, ContactLaw) or law.name != name:
        raise ValueError(f"{stated}: is no il.ContactLaw of this name")
    if reasons := resolve_name("impactlab.verification.law_record:refusals")(law):
        raise ValueError(f"{stated}: {'; '.join(reasons)}")
    object.__setattr__(law, "provenance", f"{package}, entry point {entry.value}")
    adopt(law)
    return True


class LawNames(Sequence[str]):
    """The names of all laws that this process knows; a law's index is its number."""

    def __contains__(self, name: object) -> bool:
        return known(name)

    def __iter__(self) -> Iterator[str]:
        return iter(tuple(CONTACT_LAWS))

    def __len__(self) -> int:
        return len(CONTACT_LAWS)

    def __getitem__(self, number: Any) -> Any:
        if isinstance(number, slice):
            return tuple(CONTACT_LAWS)[number]
        return NUMBERED[int(number)].name if number >= OUTSIDE else LAWS[number]

    def index(self, name: str, *_: int) -> int:
        """Return the number of the law."""
        return LAWS.index(name) if name in LAWS else int(CONTACT_LAWS[name].number)  # type: ignore[attr-defined]


LAW_NAMES = LawNames()
"""Choices of the parameter `contact`."""


def registered(law: ContactLaw) -> str:
    """Return the name of a law. Raises ValueError unless it is registered with this source."""
    if getattr(CONTACT_LAWS.get(law.name), "source_hash", "") != law.source_hash:
        raise ValueError(
            f"contact law {law.name!r} (source hash {law.source_hash}) is not registered: call "
            "il.register with it first"
        )
    return law.name


def outside(names: Any) -> list[Any]:
    """Return the laws from outside the package among these names."""
    laws = (CONTACT_LAWS.get(str(name)) for name in dict.fromkeys(names))
    return [law for law in laws if isinstance(law, ContactLaw)]
