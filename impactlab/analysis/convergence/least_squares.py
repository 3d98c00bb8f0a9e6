"""Error and uncertainty from a least-squares fit over four or more grids, for data that scatter.

Source: Eca and Hoekstra (2014), J. Comput. Phys. 262, 104, sections 3 and 4.

Symbols: f values, h spacings, n grids; f0 the limit, eps = |f - f0| of the fitted curve, sigma the
standard deviation of the fit, delta the data range over n - 1.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

from impactlab.analysis.convergence.richardson import (
    HIGHEST_RELIABLE,
    SAFETY_CREDIBLE,
    SAFETY_DOUBTFUL,
)
from impactlab.types import Floats
from impactlab.verdicts import Verdict

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
