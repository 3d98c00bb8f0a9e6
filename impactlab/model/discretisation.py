"""The discretisation: nodes, fibres and time steps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from impactlab import wings
from impactlab.model.checks import integer, one_of, positive, require
from impactlab.model.quantities import SI
from impactlab.solver import BENDING_MODELS, RULES, SCHEMES


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Nodes along the span, integration points over the whole depth, and the time step.

    The schemes tend to the same answers, but for what does not converge anyway: the peak
    plastic strain of a perfectly plastic beam depends on the time step, too.

    Parameters
    ----------
    nodes : int, default 201
        Number of nodes along the span: odd, so that mid-span is a node, at least 5.
    points : int, default 9
        Number of integration points over the whole depth, at least 2.
    rule : {"lobatto", "legendre", "layers"}, default "lobatto"
        Integration rule: the paper's, Gauss and Legendre's, or the midpoints of equal layers (Zhang
        et al.).
    scheme : {"leapfrog", "modal", "auto"}, default "leapfrog"
        Scheme in time: "leapfrog" (the paper's: explicit, cost growing with nodes^3), "modal" (sine
        modes, the same answers from far fewer nodes; solver/modal.py; for pinned beams struck at
        mid-span), or "auto": modal where every beam model of the runs has it, else leapfrog.
    courant : Quantity, default 0.9
        Time step over the scheme's largest, in (0, 1]: of leapfrog, the critical one; of modal, the
        time in which a bar wave crosses a spacing, unless the contact allows less.
    element_size : Quantity, optional
        Size of the elements about the contact, in m; of the model "solid" alone, which needs this
        or `elements_per_radius` and none of the others.
    elements_per_radius : Quantity, optional
        Number of elements over the expected contact radius (fem3d.solver.estimates), so that their
        size follows the velocity; of the model "solid" alone.

    Raises
    ------
    ValueError
        If a value is not valid; the message names the field.

    Examples
    --------
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
        odd, message = np.equal(nodes % 2, 1), "must be odd, so that mid-span is a node"
        require(odd, "Discretisation", "nodes", nodes, message)
        one_of("Discretisation", "rule", self.rule, RULES)
        schemes = SCHEMES if np.ndim(self.scheme) else (*SCHEMES, "auto")
        one_of("Discretisation", "scheme", self.scheme, schemes)
        sizes = [name for name in wings.sizes() if getattr(self, name) is not None]
        for name in sizes:
            positive("Discretisation", name, getattr(self, name))
            message = f"{sizes[0]} says it already: take one of them out"
            require(name == sizes[0], "Discretisation", name, getattr(self, name), message)
        courant = positive("Discretisation", "courant", self.courant)
        message = "must be in (0, 1]; above 1 the scheme is unstable or inaccurate"
        require(courant <= 1, "Discretisation", "courant", self.courant, message)

    def resolved(self, beam_models: Iterable[str]) -> Discretisation:
        """Return a copy with the scheme that `auto` stands for.

        Parameters
        ----------
        beam_models : iterable of str
            Beam models of the runs.

        Returns
        -------
        Discretisation
            The same one where its scheme is not "auto".
        """
        if np.any(np.not_equal(self.scheme, "auto")):
            return self
        bending = set(beam_models) <= set(BENDING_MODELS)
        return replace(self, scheme="modal" if bending else "leapfrog")
