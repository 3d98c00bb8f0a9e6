"""The discretisation: nodes, fibres and time steps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from impactlab.model.checks import integer, one_of, positive, require
from impactlab.model.quantities import SI
from impactlab.solver import BENDING_MODELS, RULES, SCHEMES


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Nodes along the span, integration points over the whole depth, and the time step.

    nodes: odd, at least 5, so that mid-span is a node. points: at least 2, counted over the
    whole depth. rule: "lobatto" (the paper), "legendre" or "layers" (midpoints of equal layers,
    Zhang et al.). scheme: "leapfrog" (the paper: explicit, cost growing with nodes^3), "modal"
    (sine modes, the same answers from far fewer nodes; see solver/modal.py), or "auto": modal where
    every beam model in question has it, else leapfrog. courant: time step over the scheme's
    largest, in (0, 1]: over the critical one of leapfrog; over the time in which a bar wave crosses
    a spacing, unless the contact allows less, of modal.
    element_size, elements_per_radius: of the "solid" model alone, which needs one of them and
    nothing else of these: the size of its elements about the contact, in m; or how many lie over
    the contact radius to expect (fem3d.solver.estimates), so that it follows the velocity.

    The schemes tend to the same answers, but for what does not converge anyway: the peak
    plastic strain of a perfectly plastic beam depends on the time step, too.

    Raises ValueError naming the field otherwise.

    >>> il.Discretisation(nodes=601, points=9).rule
    'lobatto'
    """

    nodes: int = 201
    points: int = 9
    rule: str = "lobatto"
    scheme: str = "leapfrog"
    courant: SI[float] = SI("1", 0.9)
    element_size: SI[float | None] = SI("m", None)
    elements_per_radius: SI[float | None] = SI("1", None)

    def __post_init__(self) -> None:
        for field, least in (("nodes", 5), ("points", 2)):  # 21.0, as YAML may give it, is 21
            value = integer("Discretisation", field, getattr(self, field), least)
            object.__setattr__(self, field, value)
        nodes = self.nodes
        odd, words = np.equal(nodes % 2, 1), "must be odd, so that mid-span is a node"
        require(odd, "Discretisation", "nodes", nodes, words)
        one_of("Discretisation", "rule", self.rule, RULES)
        schemes = SCHEMES if np.ndim(self.scheme) else (*SCHEMES, "auto")
        one_of("Discretisation", "scheme", self.scheme, schemes)
        for field in ("element_size", "elements_per_radius"):
            if getattr(self, field) is not None:
                positive("Discretisation", field, getattr(self, field))
        twice = self.element_size is not None and self.elements_per_radius is not None
        words = "element_size says it already: take one of them out"
        size = self.elements_per_radius
        require(not twice, "Discretisation", "elements_per_radius", size, words)
        courant = positive("Discretisation", "courant", self.courant)
        words = "must be in (0, 1]; above 1 the scheme is unstable or inaccurate"
        require(courant <= 1, "Discretisation", "courant", self.courant, words)

    def resolved(self, beam_models: Iterable[str]) -> Discretisation:
        """Return a copy with the scheme that `auto` stands for, for runs of these beam models."""
        if np.any(np.not_equal(self.scheme, "auto")):
            return self
        bending = set(beam_models) <= set(BENDING_MODELS)
        return replace(self, scheme="modal" if bending else "leapfrog")
