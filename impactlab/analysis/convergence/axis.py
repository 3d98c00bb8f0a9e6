"""Convergence along one axis that is refined: behaviour, order, limits, uncertainty, verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.analysis.convergence import by_design, least_squares
from impactlab.analysis.convergence.least_squares import Expansion, Fit
from impactlab.analysis.convergence.richardson import Behaviour, Estimate, estimate, safety
from impactlab.analysis.convergence.uncertainty import How, numerical_uncertainty
from impactlab.analysis.responses import usable
from impactlab.analysis.verdicts import ROUND_OFF, TOLERANCE, Verdict, flagged, verdict_variables
from impactlab.types import Floats

VANISHING = 0.1
"""Richardson value over finest value up to which a shrinking response is on its way to zero."""


class AxisVerdict(Verdict):
    """What refinement shows for one response at one point of the rest of the grid."""

    AT_ROUND_OFF = 0, True, "the three finest grids agree to 1e-9: nothing left to converge"
    CONVERGED_SECOND_ORDER = (
        1,
        True,
        "monotone, order 2 within 0.5, credible on every three successive grids, uncertainty "
        "within 1 %",
    )
    CONVERGED = 2, True, "monotone, credible order (0.5 to 3), uncertainty within 1 %"
    SETTLED = (
        3,
        True,
        "no credible order, but no drift either: the least-squares fit over all grids (of three "
        "grids, three times their range) bounds the error by 1 %",
    )
    TENDS_TO_ZERO = 4, False, "converges to zero: a relative error has no meaning"
    NOT_YET_CONVERGED = 5, False, "convergence too slow or too far off to bound the error by 1 %"
    OSCILLATORY = 6, False, "the differences shrink but change sign: no Richardson value"
    UNDETERMINED = 7, False, "a run on the three finest grids is missing: no number is given"
    DIVERGENT = 8, False, "the differences do not shrink as the grid is refined"
    NOT_CONVERGENT_BY_DESIGN = 9, False, "the model has no limit here: no grid is fine enough"


@dataclass(frozen=True)
class Axis:
    """What is refined. name: prefix of the variables; dim: of the runs; words: "the nodes".

    spacing: from the values on dim to what tends to zero, in any unit.
    """

    name: str
    dim: str
    words: str
    spacing: Callable[[Floats], Floats]


class Judgement(NamedTuple):
    """Numbers and flags on one response; NaN where undefined."""

    observed_order: float
    extrapolated: float
    gci: float
    safety_factor: float
    asymptotic_ratio: float
    fit_order: float
    fit_extrapolated: float
    fit_uncertainty: float
    uncertainty: float
    fit_expansion: int
    uncertainty_from: How
    behaviour: Behaviour
    verdict: AxisVerdict


def judge(values: Floats, spacings: Floats) -> Judgement:
    """All that three or more grids show of one response.

    values: in any unit, spacings: in any unit, both (grids,) and finest first. Order, Richardson
    value, GCI and its asymptotic ratio are those of the three finest; the safety factor is 1.25
    where every three successive grids show a credible order and 3 otherwise; the fit is over all
    of four or more. The extrapolated values are in the unit of the values; gci, fit_uncertainty
    and uncertainty (`numerical_uncertainty` of the finest) relative to the finest value. Raises
    ValueError unless the spacings rise.
    """
    triples = [estimate(values[i : i + 3], spacings[i : i + 3]) for i in range(len(values) - 2)]
    finest, factor = triples[0], safety(triples)
    fitted = _fit(values, spacings)
    bound = numerical_uncertainty(values, spacings)
    gci = finest.gci(factor)
    return Judgement(
        finest.order,
        finest.extrapolated if finest.credible else np.nan,
        gci,
        np.nan if np.isnan(gci) else factor,
        finest.asymptotic_ratio,
        fitted.order if fitted else np.nan,
        fitted.extrapolated if fitted else np.nan,
        relative(least_squares.uncertainty(fitted, values)[0], values[0]) if fitted else np.nan,
        relative(bound.amounts[0], values[0]),
        fitted.expansion if fitted else Expansion.NONE,
        bound.how,
        finest.behaviour,
        _verdict(triples, bound.how, relative(bound.amounts[0], values[0])),
    )


def analysis(runs: xr.Dataset, axis: Axis, comment: str) -> xr.Dataset:
    """Convergence along an axis of every response at every point of the rest of the grid.

    Returns the fields of Judgement as <axis>_<field> on (response, *other grid dims), flags as CF
    flags; beside them <axis>_summary (response) and <axis>_tally (response, <axis>_outcome). What
    has no limit by design keeps its observed order alone. Raises ValueError for a repeated value
    on the axis.
    """
    values = usable(runs)
    spacings = axis.spacing(values[axis.dim].values.astype(float))
    finest_first = np.argsort(spacings)
    values, spacings = values.isel({axis.dim: finest_first}), spacings[finest_first]
    fields = xr.apply_ufunc(
        partial(judge, spacings=spacings),
        values,
        input_core_dims=[[axis.dim]],
        output_core_dims=[[]] * len(Judgement._fields),
        output_dtypes=[np.int8 if name in _FLAGS else float for name in Judgement._fields],
        vectorize=True,
    )
    found = _without_limit(
        dict(zip(Judgement._fields, fields, strict=True)),
        by_design.mask(runs, values, axis.name, axis.dim),
    )
    return _described(found, axis, comment, by_design.reasons(values, axis.name))


def relative(amount: float, value: float) -> float:
    """amount/|value|, infinite where only the value is zero."""
    return float(amount / abs(value)) if value else float(np.inf * amount if amount else 0.0)


def _fit(values: Floats, spacings: Floats) -> Fit | None:
    """The fit over all grids; None for fewer than four, a missing one, or equal values."""
    if values.size < least_squares.FEWEST or not np.isfinite(values).all():
        return None
    if np.ptp(values) <= ROUND_OFF * np.max(abs(values)):
        return None
    return least_squares.fit(values, spacings)


def _verdict(triples: list[Estimate], how: How, uncertainty: float) -> AxisVerdict:
    finest, within = triples[0], how.sound and uncertainty <= TOLERANCE
    if finest.behaviour in _DECIDED:
        return _OTHERWISE[finest.behaviour]
    if within and finest.credible:
        second = finest.asymptotic and all(triple.credible for triple in triples)
        return AxisVerdict.CONVERGED_SECOND_ORDER if second else AxisVerdict.CONVERGED
    if within:
        return AxisVerdict.SETTLED
    return AxisVerdict.TENDS_TO_ZERO if _tends_to_zero(finest) else _OTHERWISE[finest.behaviour]


def _tends_to_zero(finest: Estimate) -> bool:
    fine, middle, coarse = (abs(value) for value in finest.values)
    shrinking = finest.credible and fine < middle < coarse
    return shrinking and abs(finest.extrapolated) <= VANISHING * fine


def _without_limit(found: dict[str, xr.DataArray], mask: xr.DataArray) -> dict[str, xr.DataArray]:
    """The fields, with what has no limit marked and its numbers taken away."""
    instead = {name: np.nan for name in Judgement._fields} | {
        "uncertainty": np.inf,
        "fit_expansion": Expansion.NONE,
        "uncertainty_from": How.NOTHING,
        "behaviour": Behaviour.NOT_CONVERGENT_BY_DESIGN,
        "verdict": AxisVerdict.NOT_CONVERGENT_BY_DESIGN,
    }
    kept = "observed_order"
    return {
        name: field if name == kept else field.where(~mask, instead[name])
        for name, field in found.items()
    }


def _described(
    found: dict[str, xr.DataArray], axis: Axis, comment: str, reasons: str
) -> xr.Dataset:
    name, words = axis.name, f"convergence with {axis.words}"
    numbers = {
        f"{name}_{key}": found[key].assign_attrs(_attributes(key, axis, comment))
        for key in _NUMBERS
    }
    flags = {
        f"{name}_{key}": flagged(found[key], kind, f"{long_name} {axis.words}")
        for key, (kind, long_name) in _FLAGS.items()
        if key != "verdict"
    }
    verdicts = verdict_variables(found["verdict"], AxisVerdict, name, words)
    dataset = xr.Dataset(numbers | flags | verdicts)
    said = {"tolerance": TOLERANCE, "comment": comment}
    for key in ("verdict", "summary"):
        dataset[f"{name}_{key}"].attrs |= said | ({"without_limit": reasons} if reasons else {})
    return dataset


def _attributes(key: str, axis: Axis, comment: str) -> dict[str, str]:
    long_name, units, said = _NUMBERS[key]
    attrs = {"long_name": long_name.format(axis.words), "comment": f"{said} {comment}".strip()}
    return attrs | ({"units": units} if units else {})


_DECIDED = (Behaviour.AT_ROUND_OFF, Behaviour.UNDETERMINED)
_OTHERWISE = {
    Behaviour.AT_ROUND_OFF: AxisVerdict.AT_ROUND_OFF,
    Behaviour.MONOTONE: AxisVerdict.NOT_YET_CONVERGED,
    Behaviour.STALLED: AxisVerdict.NOT_YET_CONVERGED,
    Behaviour.OSCILLATORY: AxisVerdict.OSCILLATORY,
    Behaviour.MONOTONE_DIVERGENT: AxisVerdict.DIVERGENT,
    Behaviour.OSCILLATORY_DIVERGENT: AxisVerdict.DIVERGENT,
    Behaviour.UNDETERMINED: AxisVerdict.UNDETERMINED,
}
"""Verdicts where no number bounds the error."""

_FLAGS: dict[str, tuple[type[Verdict], str]] = {
    "behaviour": (Behaviour, "behaviour of the three finest grids with"),
    "fit_expansion": (Expansion, "form of the error in the least-squares fit with"),
    "uncertainty_from": (How, "what the numerical uncertainty rests on, with"),
    "verdict": (AxisVerdict, "verdict on convergence with"),
}
_NUMBERS = {
    "observed_order": ("observed order of convergence with {}", "1", ""),
    "extrapolated": (
        "Richardson value, extrapolated in {}",
        "",
        "In the unit of response_units; given where the order is credible.",
    ),
    "gci": (
        "grid convergence index of the finest grid, {}",
        "1",
        "Relative to the finest value, infinite where that is zero.",
    ),
    "safety_factor": ("safety factor in the grid convergence index, {}", "1", ""),
    "asymptotic_ratio": (
        "ratio of successive grid convergence indices over r^p, {}",
        "1",
        "1 in the asymptotic range, but near 1 elsewhere, too: not a proof by itself.",
    ),
    "fit_order": (
        "order of the least-squares fit in {}",
        "1",
        "Over four or more grids; assumed, not fitted, where fit_expansion is not `free`.",
    ),
    "fit_extrapolated": (
        "limit of the least-squares fit in {}",
        "",
        "In the unit of response_units; over four or more grids.",
    ),
    "fit_uncertainty": (
        "uncertainty of the finest value by the least-squares fit in {}",
        "1",
        "Relative to the finest value; Eca and Hoekstra (2014), over four or more grids.",
    ),
    "uncertainty": (
        "numerical uncertainty of the finest value, from {}",
        "1",
        "Relative to the finest value; infinite where nothing bounds the error.",
    ),
}
"""Long name, unit and comment of each number."""
