"""How the beam is cut into nodes, fibres and time steps."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.kernels import RULES
from impactlab.model.checks import integer, one_of, positive
from impactlab.model.columns import anywhere


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Nodes along the span, integration points over the whole depth, and the time step.

    nodes: odd, at least 5, so that mid-span is a node. points: at least 2, counted over the
    whole depth. rule: "lobatto" (the paper), "legendre" or "layers" (midpoints of equal layers,
    Zhang et al.). courant: time step over the critical one, in (0, 1].

    Raises ValueError naming the field otherwise.
    """

    nodes: int = 201
    points: int = 9
    rule: str = "lobatto"
    courant: float = 0.9

    def __post_init__(self) -> None:
        for field, least in (("nodes", 5), ("points", 2)):  # 21.0, as YAML may give it, is 21
            value = integer("Discretisation", field, getattr(self, field), least)
            object.__setattr__(self, field, value)
        if anywhere(self.nodes % 2 == 0):
            raise ValueError(
                f"Discretisation.nodes = {self.nodes!r}: must be odd, so that mid-span is a node"
            )
        one_of("Discretisation", "rule", self.rule, RULES)
        if anywhere(positive("Discretisation", "courant", self.courant) > 1):
            raise ValueError(
                f"Discretisation.courant = {self.courant!r}: must be in (0, 1]; above 1 the "
                "explicit scheme is unstable"
            )
