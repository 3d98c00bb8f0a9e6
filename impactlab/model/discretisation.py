"""The discretisation: nodes, fibres and time steps, and the integration rules of the fibres.

The rules on [-1, 1], with weights that sum to 2, are computed for any number of points by Newton's
method on the Legendre polynomials; Gauss's rule is there for any discrete measure, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from impactlab import wings
from impactlab.model.checks import integer, one_of, positive, require
from impactlab.model.quantities import SI
from impactlab.solver import BENDING_MODELS, RULES, SCHEMES
from impactlab.types import Floats


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


_NEWTON_STEPS = 100


@cache
def integration_rule(rule: str, points: int) -> tuple[Floats, Floats]:
    """Return positions in ascending order and weights of a rule on [-1, 1], both (points,).

    Legendre: the roots of P_n, n = P, with the weights 2 (1 - x^2)/(n P_{n-1})^2. Lobatto: those of
    (1 - x^2) P'_n, n = P - 1, with 2/(n (n + 1) P_n^2). Layers: the midpoints of equal layers.
    """
    place = {"lobatto": _lobatto, "legendre": _gauss, "layers": _layer}[rule]
    pairs = [place(j, points) for j in range((points + 1) // 2)]  # outermost first
    x, weights = np.array(pairs).T
    if points % 2:
        x[-1] = 0.0
    below = slice(None, points // 2)
    positions = np.concatenate([-x[below], x[::-1]])
    return positions, np.concatenate([weights[below], weights[::-1]])


def _layer(j: int, points: int) -> tuple[float, float]:
    return 1.0 - (2 * j + 1) / points, 2.0 / points


def _gauss(j: int, points: int) -> tuple[float, float]:
    x = math.cos(math.pi * (j + 0.75) / (points + 0.5))
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(points, x)
        step = value * (x * x - 1.0) / (points * (x * value - lower))
        x -= step
        if abs(step) < 1e-15:
            break
    _, lower = legendre_pair(points, x)
    return x, 2.0 * (1.0 - x * x) / ((points * lower) * (points * lower))


def _lobatto(j: int, points: int) -> tuple[float, float]:
    n, x = points - 1, math.cos(math.pi * j / (points - 1))
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(n, x)
        step = (x * value - lower) / (points * value)
        x -= step
        if abs(step) < 1e-15:
            break
    value, _ = legendre_pair(n, x)
    return x, 2.0 / (n * points * value * value)


def legendre_pair(degree: int, x: float) -> tuple[float, float]:
    """Return (P_n(x), P_{n-1}(x)), n = degree >= 1, by the three-term recurrence."""
    previous, current = 1.0, x
    for k in range(2, degree + 1):
        previous, current = current, ((2 * k - 1) * x * current - (k - 1) * previous) / k
    return current, previous


def gauss(z: Floats, weights: Floats, n: int, last: float | None) -> tuple[Floats, Floats]:
    """Return the n nodes, ascending, and weights of Gauss's rule on a discrete measure.

    last: with it, Radau's rule, of which this is the last node, beyond all z. Golub and Welsch,
    Math. Comput. 23 (1969) 221, and Golub, SIAM Rev. 15 (1973) 318, with Lanczos' recurrence.
    """
    scale, mass = z.max(), weights.sum()
    z, q = z / scale, np.sqrt(weights / mass)
    vectors, diagonal, beside = np.zeros((n, z.size)), np.zeros(n), np.zeros(n)
    for j in range(n):
        vectors[j] = q
        diagonal[j] = (z * q * q).sum()
        q = z * q
        for _ in range(2):  # twice is enough for orthogonality to rounding
            q = q - ((vectors[: j + 1] * q).sum(axis=1)[:, np.newaxis] * vectors[: j + 1]).sum(
                axis=0
            )
        beside[j] = math.sqrt((q * q).sum())
        q = q / beside[j] if beside[j] > 0.0 else q
    matrix = np.diag(diagonal) + np.diag(beside[:-1], 1) + np.diag(beside[:-1], -1)
    if last is not None:
        ratio = 0.0  # of the last two orthogonal polynomials at the node
        for j in range(n - 1):
            ratio = 1.0 / (last / scale - diagonal[j] - (beside[j - 1] ** 2 * ratio if j else 0.0))
        matrix[-1, -1] = last / scale - (beside[n - 2] ** 2 * ratio if n > 1 else 0.0)
    nodes, modes = np.linalg.eigh(matrix)
    return scale * nodes, mass * modes[0] ** 2
