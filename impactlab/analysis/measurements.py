"""Measurements beside solved runs: the runs that they are of, and whether both agree.

Uncertainties are standard, or expanded by a coverage factor k (JCGM 100:2008, the GUM).
Measurement and model are compatible where their difference is no larger than the root sum of
squares of both expanded uncertainties (k = 2), as in ASME V&V 20-2009. Both are recalled, not read.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from impactlab.methods.runs import usable
from impactlab.model.parameters import REFINEMENTS
from impactlab.variables import FAILED, MARKED, of_function, reasons
from impactlab.verdicts import Verdict, flagged

COVERAGE = 2.0
"""Coverage factor of every expanded uncertainty in datasets: about 95 % of a normal error."""
_SAME = 1e-6  # relative difference up to which two conditions are the same


@dataclass(frozen=True)
class Measurement:
    """One measured response of one impact, in SI units.

    quantity: name of a response. standard_uncertainty: one standard deviation of the value.
    conditions: parameters of the impact by name; others are taken to be those of the study.
    simulated: from another model, not measured. systematic_uncertainty: the part of
    standard_uncertainty that is the same error in all measurements of this quantity and source.
    """

    quantity: str
    value: float
    standard_uncertainty: float
    units: str
    conditions: Mapping[str, float | int | str]
    source: str
    simulated: bool = False
    systematic_uncertainty: float = 0.0


class Agreement(Verdict):
    """Verdicts on a measurement beside the model."""

    COMPATIBLE = True, "the difference is within the combined uncertainty"
    INCOMPATIBLE = False, "the difference exceeds the combined uncertainty"
    NOT_JUDGED = False, "there is no run, no answer, or no bound of its numerical error"
    OTHER_IMPACT = False, "the measurement is of another impact than the study's"


@dataclass(frozen=True)
class _Row:
    verdict: Agreement
    reason: str = ""
    case: str = ""
    model: float = np.nan
    numerical: float = np.nan


def compared(
    runs: xr.Dataset, analysis: xr.Dataset, measurements: Sequence[Measurement]
) -> xr.Dataset:
    """Compare measurements with the runs of a grid, each with every model that the grid holds.

    runs, analysis: as in runs.nc and analysis.nc. A run is of the measurement's conditions to
    within 1e-6; there is no interpolation. It is that on the finest grid, with the numerical
    uncertainty that the analysis found there along all refined axes, or pilot runs of `auto`.

    Returns, on `comparison`, a row for each measurement and each combination of varied words
    (contact law, beam model, ...): the variables of _LONG_NAMES as compared_<name>, in SI units,
    and compared_verdict (CF flags, see Agreement).
    """
    pairs = [
        (measurement, row)
        for measurement in measurements
        for row in _rows(runs, analysis, measurement)
    ]
    of_measurement = ("quantity", "units", "conditions", "source", "simulated")
    table: dict[str, Any] = {
        key: [getattr(measurement, key) for measurement, _ in pairs] for key in of_measurement
    }
    table["conditions"] = [json.dumps(dict(conditions)) for conditions in table["conditions"]]
    table["simulated"] = np.array(table["simulated"], dtype=np.int8)
    table |= {key: [getattr(row, key) for _, row in pairs] for key in ("case", "reason")}
    measured = np.array([measurement.value for measurement, _ in pairs])
    expanded = COVERAGE * np.array([measurement.standard_uncertainty for measurement, _ in pairs])
    model, numerical = np.array([(row.model, row.numerical) for _, row in pairs]).reshape(-1, 2).T
    table |= {"measured": measured, "uncertainty": expanded, "model": model, "numerical": numerical}
    table |= {"difference": model - measured, "combined": np.hypot(expanded, numerical)}
    variables: dict[str, Any] = {
        f"compared_{name}": ("comparison", column, {"long_name": _LONG_NAMES[name]})
        for name, column in table.items()
    }
    codes = xr.DataArray([int(row.verdict) for _, row in pairs], dims="comparison")
    variables["compared_verdict"] = flagged(codes, Agreement, "verdict on measurement and model")
    return xr.Dataset(variables)


_LONG_NAMES = {
    "measured": "measured value, in compared_units",
    "uncertainty": f"its expanded uncertainty (k = {COVERAGE:g})",
    "model": "the model's value on the finest grid",
    "numerical": "numerical uncertainty of the model's value",
    "difference": "model less measured",
    "combined": "combined uncertainty of the difference",
    "quantity": "response that was measured",
    "units": "SI unit",
    "conditions": "parameters of the impact that are stated with the measurement, SI",
    "source": "where the measurement comes from",
    "simulated": "1 for values of another model, which are not measured",
    "case": "which of the study's models it is compared with",
    "reason": "why there is no verdict",
}


def _rows(runs: xr.Dataset, analysis: xr.Dataset, measurement: Measurement) -> Iterator[_Row]:
    where: dict[str, int] = {}
    for name, condition in measurement.conditions.items():
        if name not in runs.coords:
            reason = f"the study has no {name}, which the measurement states"
            yield _Row(Agreement.OTHER_IMPACT, reason)
            return
        coordinate = runs[name]
        positions = np.flatnonzero(
            [same(value, condition) for value in coordinate.values.ravel().tolist()]
        )
        if coordinate.ndim == 0 and not positions.size:
            reason = f"the study has {name} = {coordinate.item()!r}, the measurement {condition!r}"
            yield _Row(Agreement.OTHER_IMPACT, reason)
            return
        if coordinate.ndim and "run" not in coordinate.dims:
            if not positions.size:
                yield _Row(Agreement.NOT_JUDGED, f"the study has no run at {name} = {condition!r}")
                return
            where[name] = int(positions[0])
    if "run" in runs.dims:
        reason = "a sample has no single prediction: use a grid, or calibrate"
        yield _Row(Agreement.NOT_JUDGED, reason)
        return
    if measurement.quantity not in runs.attrs.get("responses", list(runs.data_vars)):
        yield _Row(
            Agreement.NOT_JUDGED, f"the study leaves out the response {measurement.quantity}"
        )
        return
    values = _finest(usable(runs, measurement.quantity).squeeze("response", drop=True)).isel(where)
    status = _finest(runs["status"]).isel(where)
    share = _numerical(analysis, measurement.quantity, runs).isel(
        {name: index for name, index in where.items() if name in runs.dims}, missing_dims="ignore"
    )
    categorical = [str(dim) for dim in values.dims if values[dim].dtype.kind not in "if"]
    if numbers := [
        str(dim) for dim in values.dims if dim not in categorical and values.sizes[dim] > 1
    ]:
        reason = f"state {', '.join(numbers)}, which the study varies, in its conditions"
        yield _Row(Agreement.NOT_JUDGED, reason)
        return
    for position in np.ndindex(*values.shape):
        place = dict(zip(map(str, values.dims), position, strict=True))
        case = ", ".join(str(values[dim].values[place[dim]]) for dim in categorical)
        answer = float(values.isel(place))
        error = abs(answer) * float(share.isel(place, missing_dims="ignore"))
        yield _judged(measurement, case, answer, error, int(status.isel(place)))


def _judged(measurement: Measurement, case: str, answer: float, error: float, status: int) -> _Row:
    if not np.isfinite(answer):
        why = "; ".join(reasons(status & FAILED)) or "no reason is recorded"
        return _Row(Agreement.NOT_JUDGED, f"the run has no answer: {why}", case)
    if not np.isfinite(error):
        reason = (
            "nothing bounds the numerical error: vary nodes over three values or more, or take "
            "discretisation: auto"
        )
        return _Row(Agreement.NOT_JUDGED, reason, case, answer)
    difference = abs(answer - measurement.value)
    within = difference <= np.hypot(COVERAGE * measurement.standard_uncertainty, error)
    verdict = Agreement.COMPATIBLE if within else Agreement.INCOMPATIBLE
    outside = "beyond the range of the contact law" if status & MARKED else ""
    return _Row(verdict, outside, case, answer, error)


def same(condition: Any, other: Any) -> bool:
    """Return whether two conditions are the same: words, or numbers to within 1e-6."""
    if isinstance(condition, str) or isinstance(other, str):
        return bool(condition == other)
    return bool(abs(condition - other) <= _SAME * max(abs(condition), abs(other)))


def _finest(array: xr.DataArray) -> xr.DataArray:
    """Return the values on the finest grid."""
    for dim, refinement in REFINEMENTS.items():
        if dim in array.dims and not of_function(array[dim]):
            finest = refinement.finest_first(array[dim].values)[0]
            array = array.isel({dim: int(finest)}, drop=True)
    return array


def _numerical(analysis: xr.Dataset, name: str, runs: xr.Dataset) -> xr.DataArray:
    """Return the relative numerical uncertainty on the finest grid; NaN where nothing bounds it."""
    if of_function(runs):  # which has no discretisation
        return xr.DataArray(0.0)
    total, judged = xr.DataArray(0.0), False
    for dim, (axis, _) in REFINEMENTS.items():
        if runs.sizes.get(dim, 1) == 1:
            continue
        if f"{axis}_uncertainty" not in analysis:
            return xr.DataArray(np.nan)
        # an axis with one value adds none where another is judged
        total = total + _finest(analysis[f"{axis}_uncertainty"].sel(response=name, drop=True))
        judged = True
    if not judged and "numerical_uncertainty" in analysis:
        return analysis["numerical_uncertainty"].sel(response=name, drop=True)
    return total if judged else xr.DataArray(np.nan)
