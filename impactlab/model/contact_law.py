"""Contact laws from outside the package: the class, and how sessions come to know them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from impactlab.model.own_law import LawNames, OwnLaw
from impactlab.solver.contact import CONTACT_LAWS, LAWS, NUMBERED, LawRecord

GROUP = "impactlab.contact_laws"
"""Group of the entry points of other packages, each a ContactLaw under its name."""


def _hertz_limit(E: float, R: float, S_y: float, nu: float) -> float:
    return R


def _hertz_radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    return float((R * delta) ** 0.5)


@dataclass(frozen=True, kw_only=True)
class ContactLaw(LawRecord, OwnLaw):
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

    kind: ClassVar[str] = "contact law"
    forms: ClassVar[dict[str, tuple[str, ...]]] = {
        "curve": ("delta", "E", "R", "S_y", "nu"),
        "limit": ("E", "R", "S_y", "nu"),
        "radius": ("delta", "E", "R", "S_y", "nu"),
        "damping": ("F", "delta", "rate", "E", "R", "S_y", "nu"),
    }
    defaults: ClassVar[dict[str, Any]] = {"limit": _hertz_limit, "radius": _hertz_radius}
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
        self._seal(LAWS)
        for text in ("short", "title"):
            object.__setattr__(self, text, getattr(self, text) or self.name)


LAW_NAMES = LawNames(
    ContactLaw, LAWS, CONTACT_LAWS, NUMBERED, GROUP, "impactlab.verification.law_record:refusals"
)
"""Choices of the parameter `contact`."""
