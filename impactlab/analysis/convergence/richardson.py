"""Richardson extrapolation and the grid convergence index (GCI) on three grids.

Sources: Celik et al. (2008), J. Fluids Eng. 130, 078001 (order on unequal ratios, GCI);
Stern et al. (2001), J. Fluids Eng. 123, 793 (classes of behaviour); Oberkampf and Roy (2010),
Verification and Validation in Scientific Computing, ch. 8 (factor 3 without a credible order);
Eca and Hoekstra (2014), J. Comput. Phys. 262, 104 (bounds of a credible order).

Symbols: h1 < h2 < h3 grid spacings, f1, f2, f3 the values there, r21 = h2/h1, r32 = h3/h2,
e21 = f2 - f1, e32 = f3 - f2, p the observed order, s = sign(e32/e21).
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from impactlab.verdicts import ROUND_OFF, Verdict

FORMAL_ORDER = 2.0  # order in dx of the central differences
ASYMPTOTIC_BAND = 0.5
"""How far an observed order may lie from the formal one in the asymptotic range."""
CREDIBLE_ORDERS = (0.5, 3.0)
"""Orders to build an error estimate on: below, the limit is out of reach; above, p is chance."""
HIGHEST_RELIABLE = 2.1
"""Order from which on convergence is too fast to be more than chance (Eca and Hoekstra)."""
SAFETY_CREDIBLE, SAFETY_DOUBTFUL = 1.25, 3.0
SAME_ORDER = 0.1
"""Difference of two orders up to which one confirms the other."""


class Behaviour(Verdict):
    """The change of three values as the grid is refined."""

    MONOTONE = True, "the differences shrink and keep their sign: a positive order"
    OSCILLATORY = True, "the differences shrink and change their sign"
    AT_ROUND_OFF = True, "the three finest grids agree to 1e-9"
    STALLED = False, "the two finest grids agree to 1e-9, the third does not: no order shows"
    MONOTONE_DIVERGENT = False, "the differences keep their sign and do not shrink"
    OSCILLATORY_DIVERGENT = False, "the differences change their sign and do not shrink"
    NOT_CONVERGENT_BY_DESIGN = False, "the model has no limit here: see the reason"
    UNDETERMINED = False, "a run on the three finest grids is missing"


@dataclass(frozen=True)
class ThreeGrids:
    """The evidence of three grids, in the unit of the values; NaN where undefined.

    values: f1, f2, f3; ratios: r21, r32. order: p, negative when divergent. extrapolated:
    Richardson's value at h = 0, monotone convergence only: the limit of an alternating sequence
    lies elsewhere.
    """

    behaviour: Behaviour
    values: tuple[float, float, float]
    ratios: tuple[float, float]
    order: float = math.nan
    extrapolated: float = math.nan

    @property
    def credible(self) -> bool:
        """True if convergence is monotone, with an order to build an error estimate on."""
        least, most = CREDIBLE_ORDERS
        return self.behaviour is Behaviour.MONOTONE and least <= self.order <= most

    @property
    def asymptotic(self) -> bool:
        """True if the credible order is that of the scheme within ASYMPTOTIC_BAND."""
        return self.credible and abs(self.order - FORMAL_ORDER) <= ASYMPTOTIC_BAND

    @property
    def asymptotic_ratio(self) -> float:
        """GCI of f2 on f3 over r21^p times that of f1 on f2; credible orders only.

        Near 1 in the asymptotic range. Up to the formal order it can differ from 1 by f1/f2 alone,
        for p solves the same equation: look at the orders of other triples, too.
        """
        if not self.credible:
            return math.nan
        (f1, f2, f3), (r21, r32), p = self.values, self.ratios, min(self.order, FORMAL_ORDER)
        fine = grid_convergence_index(f1, f2, r21, p)
        coarse = grid_convergence_index(f2, f3, r32, p)
        return coarse / (r21**p * fine) if 0 < fine < math.inf else math.nan

    @property
    def error(self) -> float:
        """Richardson's estimate of the error of f1; NaN unless the sequence converges.

        An order above the formal one does not narrow it.
        """
        if self.behaviour not in (Behaviour.MONOTONE, Behaviour.OSCILLATORY):
            return math.nan
        return _error(*self.values[:2], self.ratios[0], min(self.order, FORMAL_ORDER))

    @property
    def largest_error(self) -> float:
        """The larger of `error` and, for an order between 1 and 2, that of a h + b h^2.

        Such an order may be that of two terms. Their error on three grids of ratio 2 is up to a
        third above that of a single term of the observed order.
        """
        if not (self.behaviour is Behaviour.MONOTONE and 1.0 < self.order < FORMAL_ORDER):
            return self.error
        (f1, f2, f3), (r21, r32) = self.values, self.ratios
        slopes = (f2 - f1) / (r21 - 1.0), (f3 - f2) / (r21 * (r32 - 1.0))  # over h/h1
        curvature = (slopes[1] - slopes[0]) / (r21 * r32 - 1.0)
        return max(self.error, abs(slopes[0] - r21 * curvature))

    @property
    def first_order_error(self) -> float:
        """The error of f1 at first order, by its difference to f2 or to f3, the larger."""
        (f1, f2, f3), (r21, r32) = self.values, self.ratios
        return max(abs(f2 - f1) / (r21 - 1.0), abs(f3 - f1) / (r21 * r32 - 1.0))

    def gci(self, safety: float) -> float:
        """Return the relative GCI of the finest grid; infinite where the finest value is zero."""
        return relative(safety * self.error, self.values[0])


def relative(amount: float, value: float) -> float:
    """Return amount/|value|, infinite where only the value is zero."""
    return float(amount / abs(value)) if value else float(math.inf * amount if amount else 0.0)


def _error(fine: float, coarse: float, ratio: float, order: float) -> float:
    """Return Richardson's estimate of the error of the fine value, in its unit."""
    return abs(fine - coarse) / math.expm1(order * math.log(ratio))


def grid_convergence_index(fine: float, coarse: float, ratio: float, order: float) -> float:
    """Return 1.25 |fine - coarse|/(|fine| (ratio^order - 1)), no unit (Celik et al., step 5)."""
    return relative(SAFETY_CREDIBLE * _error(fine, coarse, ratio, order), fine)


def estimate(values: npt.ArrayLike, spacings: npt.ArrayLike) -> ThreeGrids:
    """Return the behaviour, order and Richardson value of three grids, finest first.

    values: f1, f2, f3 in any unit; spacings: h1 < h2 < h3 in any unit, for only ratios count.
    Raises ValueError unless there are three of each and the spacings rise.
    """
    f, h = np.asarray(values, float).tolist(), np.asarray(spacings, float).tolist()
    if len(f) != 3 or len(h) != 3:
        raise ValueError(f"an observed order needs three grids, not {len(f)}")
    (f1, f2, f3), (h1, h2, h3) = f, h
    if not 0 < h1 < h2 < h3 < math.inf:
        raise ValueError(f"grid spacings must rise from the finest on: {h1}, {h2}, {h3}")
    evidence = partial(ThreeGrids, values=(f1, f2, f3), ratios=(h2 / h1, h3 / h2))
    if not np.isfinite(f).all():
        return evidence(Behaviour.UNDETERMINED)
    smallest = ROUND_OFF * max(abs(f1), abs(f2), abs(f3))
    fine_still, coarse_still = abs(f2 - f1) <= smallest, abs(f3 - f2) <= smallest
    if fine_still:
        return evidence(Behaviour.AT_ROUND_OFF if coarse_still else Behaviour.STALLED)
    if coarse_still:
        return evidence(Behaviour.MONOTONE_DIVERGENT)
    change = (f3 - f2) / (f2 - f1)
    order = observed_order(change, h2 / h1, h3 / h2)
    if change < 0:
        converging = order > ROUND_OFF
        behaviour = Behaviour.OSCILLATORY if converging else Behaviour.OSCILLATORY_DIVERGENT
        return evidence(behaviour, order=order)
    if order <= ROUND_OFF:
        return evidence(Behaviour.MONOTONE_DIVERGENT, order=order)
    limit = f1 - (f2 - f1) / math.expm1(order * math.log(h2 / h1))
    return evidence(Behaviour.MONOTONE, order=order, extrapolated=limit)


def safety(triples: list[ThreeGrids]) -> float:
    """Return 1.25 where every three successive grids show a credible order, and 3 otherwise.

    It is 3, too, where the order of the finest three (the first) is too high to be reliable.
    """
    credible = all(triple.credible for triple in triples)
    reliable = credible and triples[0].order < HIGHEST_RELIABLE
    return SAFETY_CREDIBLE if reliable else SAFETY_DOUBTFUL


def confirmed(triples: list[ThreeGrids]) -> bool:
    """Return True if more than chance supports the order of the three finest grids (the first).

    The next three grids show the same order, or, on three grids in all, it is the formal one.
    """
    finest, *coarser = triples
    if not coarser:
        return finest.credible and abs(finest.order - FORMAL_ORDER) <= SAME_ORDER
    following = coarser[0]
    credible = finest.credible and following.credible
    return credible and abs(finest.order - following.order) <= SAME_ORDER


def observed_order(change: float, r21: float, r32: float) -> float:
    """Return the fixed point p of Celik et al., step 3: p ln r21 = ln|e32/e21| + q(p).

    change: e32/e21, not zero; r21, r32 > 1. q(p) = ln((r21^p - s)/(r32^p - s)).
    Two departures: Celik's absolute value is left out, since it gives a divergent sequence the
    positive order of a convergent one; and the root is bracketed, since the iteration runs away
    where r32 > r21^2. The equation is strictly monotone in p, so that there is one root.
    """
    sign = math.copysign(1.0, change)
    target, a, b = math.log(abs(change)), math.log(r21), math.log(r32)

    def residual(p: float) -> float:
        # |e32/e21| = (r32^p - s)/(1 - s r21^-p): Celik's equation in a form that does not overflow,
        # which tends to b/a at p = 0, s = 1
        if sign < 0:
            size = (1.0 + math.exp(b * p)) / (1.0 + math.exp(-a * p))
        else:
            size = -math.expm1(b * p) / math.expm1(-a * p) if p else b / a
        return math.log(size) - target

    lowest = -math.log1p(2.0 / abs(change)) / a
    highest = math.log1p(2.0 * abs(change)) / b
    return float(brentq(residual, lowest, highest, xtol=1e-14, rtol=1e-14))
