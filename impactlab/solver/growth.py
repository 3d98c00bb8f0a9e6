"""Dents and deflections left by repeated strikes, and the strikes from which on they do not grow.

A quantity y does not grow from strike m on if |y_n - y_(n-1)| <= NO_GROWTH |y_n|, but for
round-off, for all n from m to the last one. Plain numpy: compiled kernels fill in the series.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.solver.outputs import (
    DIVERGED,
    EARLIER_STRIKE_UNFINISHED,
    ENERGY_OUT_OF_BALANCE,
    NO_SHAKEDOWN,
    NOT_STEADY,
    SERIES,
)
from impactlab.solver.types import Array

NO_GROWTH = 1e-3
"""Largest growth in a strike, over what strikes have left so far, that counts as none."""
GROWING = {
    "steady_strike": (("permanent_indentation", "residual_deflection"), NOT_STEADY),
    "shakedown_strike": (("permanent_indentation", "plastic_dissipation"), NO_SHAKEDOWN),
}
"""Strikes from which on quantities do not grow: which, and the bit of `remarks` without one."""
_WHOLE_RUN = DIVERGED | ENERGY_OUT_OF_BALANCE | EARLIER_STRIKE_UNFINISHED
"""Bits of runs without any response."""
_ROUND_OFF = 1e-12
"""Growth that is none, in m or J: of a beam at rest to which nothing happened."""


def by_strike(cases: Array, columns: dict[str, Array], series: Array) -> dict[str, Array]:
    """Return the series by name, (R, strikes), GROWING, (R,), and the remarks with its bits.

    cases: CASE records. columns: answers so far, (R,). series: (R, strikes, len(SERIES)), to which
    those of single strikes are added: kernels do not put the beam to rest after these, and answers
    have all but its deflection.
    """
    strikes = cases["strikes"]
    rows = np.flatnonzero(strikes == 1)
    for place, name in enumerate(SERIES):
        if name in columns:
            series[rows, 0, place] = columns[name][rows]
    values = dict(zip(SERIES, np.moveaxis(series, 2, 0), strict=True))
    answers = {f"{name}_over_strikes": value for name, value in values.items()}
    lost, remarks = columns["status"] & _WHOLE_RUN != 0, columns["remarks"].copy()
    values["residual_deflection"] = _at_touch(cases, values["residual_deflection"])
    for name, (quantities, bit) in GROWING.items():
        first = first_without_growth(strikes, [values[quantity] for quantity in quantities])
        answers[name] = np.where(lost, np.nan, first)
        remarks |= np.where(np.isnan(first) & ~lost, bit, 0)
    return answers | {"remarks": remarks}


def _at_touch(cases: Array, deflection: Array) -> Array:
    """Return deflections that compare: of a beam that moves on, the last one alone is at rest.

    It is taken as that at the touch before. deflection: (R, strikes).
    """
    values = deflection.copy()
    rows = np.flatnonzero((cases["strikes"] > 1) & (cases["strike_interval"] > 0.0))
    last = cases["strikes"][rows] - 1
    values[rows, last] = values[rows, last - 1]
    return values


def first_without_growth(strikes: Array, series: Iterable[Array]) -> Array:
    """Return the strike of each run from which on nothing grows, NaN for none.

    strikes: of each run. series: of what may grow, (R, strikes) each.
    """
    last = np.zeros(strikes.size)  # the last strike in which something grows
    for values in series:
        numbers = np.arange(1, values.shape[1] + 1)
        growth = np.abs(np.diff(values, axis=1, prepend=0.0))
        grows = ~(growth <= NO_GROWTH * np.abs(values) + _ROUND_OFF)  # NaN: may grow
        grows &= numbers <= strikes[:, np.newaxis]
        last = np.maximum(last, np.where(grows, numbers, 0).max(axis=1))
    return np.where(last < strikes, last + 1.0, np.nan)
