"""Flow laws of the beam's fibres from outside the package: hardening and rate of one's own."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from impactlab.model.own_law import LawNames, OwnLaw
from impactlab.solver import FLOW_LAWS, FLOW_LAWS_OUTSIDE

GROUP = "impactlab.flow_laws"
"""Group of the entry points of other packages, each a FlowLaw under its name."""


@dataclass(frozen=True, kw_only=True)
class FlowLaw(OwnLaw):
    """A flow law of one's own for the beam's metal, from a Python function that numba compiles.

    It replaces the isotropic hardening of the beam's fibres and the laws of the strain rate;
    kinematic hardening stays. The contact knows the yield stress alone. The function is copied when
    the law is made, with all that it calls and the constants that it uses.

    Parameters
    ----------
    name : str
        Name in studies: small letters, digits and underscores; not "linear".
    title : str, optional
        Name in words; by default `name`.
    source : str, default "a user's own law"
        Author and equations.
    holds_for : str, optional
        Range of plastic strains, rates and metals, in words.
    flow_stress : callable
        `flow_stress(p, rate, E, S_y)` returns the stress (Pa) at which a fibre flows that has the
        equivalent plastic strain `p` and flows at `rate` (1/s), of a metal of Young's modulus `E`
        and yield stress `S_y` (Pa): `S_y` at first, and not less with more strain or rate.

    Raises
    ------
    ValueError
        If the name cannot be used, the function has other parameters, or uses what cannot be
        copied.

    Examples
    --------
    >>> def voce(p, rate, E, S_y):
    ...     return S_y + 100e6 * (1.0 - 2.718281828 ** (-p / 0.05))
    >>> il.FlowLaw(name="voce", flow_stress=voce).title
    'voce'
    """

    kind: ClassVar[str] = "flow law"
    forms: ClassVar[dict[str, tuple[str, ...]]] = {"flow_stress": ("p", "rate", "E", "S_y")}
    name: str
    title: str = ""
    source: str = "a user's own law"
    holds_for: str = ""
    flow_stress: Callable[..., float]
    source_hash: str = field(init=False)
    provenance: str = field(init=False)

    def __post_init__(self) -> None:
        self._seal(FLOW_LAWS)
        object.__setattr__(self, "title", self.title or self.name)


_NAMED: dict[str, Any] = dict.fromkeys(FLOW_LAWS)
FLOW_LAW_NAMES = LawNames(
    FlowLaw,
    FLOW_LAWS,
    _NAMED,
    FLOW_LAWS_OUTSIDE,
    GROUP,
    "impactlab.verification.law_record:flow_refusals",
)
"""Choices of the parameter `beam_flow_law`."""
