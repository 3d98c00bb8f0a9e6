"""Extrapolation to the limit: Richardson's on three grids, and a fit of least squares on more.

The three grids have the grid convergence index (GCI); the fit is for data that scatter.

Sources: Celik et al. (2008), J. Fluids Eng. 130, 078001 (order on unequal ratios, GCI);
Stern et al. (2001), J. Fluids Eng. 123, 793 (classes of behaviour); Oberkampf and Roy (2010),
Verification and Validation in Scientific Computing, ch. 8 (factor 3 without a credible order);
Eca and Hoekstra (2014), J. Comput. Phys. 262, 104 (bounds of a credible order; sections 3 and 4:
the fit).

Symbols: h1 < h2 < h3 grid spacings, f1, f2, f3 the values there, r21 = h2/h1, r32 = h3/h2,
e21 = f2 - f1, e32 = f3 - f2, p the observed order, s = sign(e32/e21). Of the fit to n grids: f0 the
limit, eps = |f - f0| of the fitted curve, sigma the standard deviation, delta the data range over
n - 1.
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize_scalar

from impactlab.types import Floats
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


FEWEST = 4  # grids that a fit of three coefficients needs
ORDERS = (0.5, 2.0)
"""Fitted orders that are kept; outside, the powers are assumed to be 1, 2, or both."""
_SEARCHED = np.linspace(-4.0, 8.0, 97)
"""Orders between which the free one is looked for: far beyond any that is kept."""


class Expansion(Verdict):
    """The form of the error that describes the data best."""

    FREE = True, "a h^p, with the order p fitted (0.5 to 2)"
    FIRST = False, "a h: the fitted order is no credible one, the first is assumed"
    SECOND = False, "a h^2: the fitted order is no credible one, the second is assumed"
    BOTH = False, "a h + b h^2: the fitted order is below 0.5, or the values turn"
    NONE = False, "no fit: it needs four grids that differ"


@dataclass(frozen=True)
class Fit:
    """A fitted expansion; in the unit of the values.

    order: p fitted, or the lowest power that is assumed. free_order: p fitted in any case.
    extrapolated: f0. errors, residuals: eps and f - fit at each grid, (grids,). deviation: sigma.
    """

    expansion: Expansion
    order: float
    free_order: float
    extrapolated: float
    errors: Floats
    residuals: Floats
    deviation: float


def fit(values: npt.ArrayLike, spacings: npt.ArrayLike) -> Fit:
    """Fit the expansion of least standard deviation among those that the fitted order allows.

    values: f in any unit, spacings: h in any unit, both (grids,), four or more, all finite, in any
    order. The order is fitted with weights 1/h and without. Where one of the two is within
    ORDERS, the better such fit is taken; above, the better of the fixed orders 1 and 2; below, of
    these and both together (weighted or not). One departure from the source: both together compete
    wherever the values turn, which a single power cannot. Raises ValueError for fewer than four
    grids.
    """
    f, h = np.asarray(values, float), np.asarray(spacings, float)
    if f.size < FEWEST:
        raise ValueError(f"a fit with its own order needs four grids, not {f.size}")
    h = h / h.min()
    weights = (np.full(f.size, 1.0 / f.size), (1.0 / h) / np.sum(1.0 / h))
    free = [_fit(f, h, w, (_free_order(f, h, w),)) for w in weights]
    free_order = min(free, key=lambda fitted: fitted.deviation).order
    steps = np.diff(f[np.argsort(h)])
    turns = steps.min() < 0 < steps.max()
    fits = [fitted for fitted in free if ORDERS[0] <= fitted.order <= ORDERS[1]]
    fixed: list[tuple[Expansion, tuple[float, ...]]] = []
    fixed += [] if fits else [(Expansion.FIRST, (1.0,)), (Expansion.SECOND, (2.0,))]
    if turns or (not fits and free_order < ORDERS[0]):
        fixed.append((Expansion.BOTH, (1.0, 2.0)))
    fits += [_fit(f, h, w, powers, kind, free_order) for kind, powers in fixed for w in weights]
    return min(fits, key=lambda fitted: fitted.deviation)


def uncertainty(fitted: Fit, values: npt.ArrayLike) -> Floats:
    """Return the half-width about each value that holds the limit in about 95 % of cases.

    F eps + sigma + |residual| with F = 1.25 where the fitted order is reliable (0.5 to 2.1) and
    the fit good (sigma < delta), F = 3 without a reliable order; 3 sigma/delta (eps + sigma +
    |residual|) where the fit is poor. In the unit of the values, (grids,).
    """
    delta = float(np.ptp(values)) / (np.size(values) - 1)
    if fitted.deviation > delta:
        poor = SAFETY_DOUBTFUL * fitted.deviation / delta
        return poor * (fitted.errors + fitted.deviation + abs(fitted.residuals))
    reliable = ORDERS[0] <= fitted.free_order < HIGHEST_RELIABLE
    safety = SAFETY_CREDIBLE if reliable else SAFETY_DOUBTFUL
    return safety * fitted.errors + fitted.deviation + abs(fitted.residuals)


def _fit(
    f: Floats,
    h: Floats,
    weights: Floats,
    powers: tuple[float, ...],
    expansion: Expansion = Expansion.FREE,
    free_order: float | None = None,
) -> Fit:
    """Fit f0 + sum a h^power, weights of sum 1; a free order costs a degree of freedom, too."""
    terms, root = np.column_stack([h**power for power in powers]), np.sqrt(weights)
    design = np.column_stack([np.ones_like(f), terms])
    coefficients = np.linalg.lstsq(design * root[:, None], f * root, rcond=None)[0]
    residuals = f - design @ coefficients
    parameters = 1 + len(powers) + (expansion is Expansion.FREE)
    deviation = float(np.sqrt(f.size * np.sum(weights * residuals**2) / (f.size - parameters)))
    free_order = powers[0] if free_order is None else free_order
    limit, errors = float(coefficients[0]), np.asarray(abs(terms @ coefficients[1:]))
    return Fit(expansion, min(powers), free_order, limit, errors, residuals, deviation)


def _free_order(f: Floats, h: Floats, weights: Floats) -> float:
    """Return the power of least weighted residual, looked for around the best of a few dozen."""
    logarithm, values = np.log(h), f - weights @ f

    def misfits(orders: npt.ArrayLike) -> Floats:
        """Return the weighted squared residuals at the best f0 and a for each order, (orders,)."""
        p = np.atleast_1d(orders)[:, None]
        # (h^p - 1)/p: with a constant the same as h^p, and ln h at p = 0
        curves = np.where(p, np.expm1(p * logarithm) / np.where(p, p, 1.0), logarithm)
        curves = curves - (curves @ weights)[:, None]
        slopes = (curves * values) @ weights / (curves**2 @ weights)
        return np.asarray((values - slopes[:, None] * curves) ** 2 @ weights)

    best = int(np.argmin(misfits(_SEARCHED)))
    around = _SEARCHED[max(best - 1, 0)], _SEARCHED[min(best + 1, _SEARCHED.size - 1)]
    minimum = minimize_scalar(
        lambda order: misfits(order)[0], bounds=around, method="bounded", options={"xatol": 1e-10}
    )
    return float(minimum.x)
