"""Delta, the moment-independent measure, and the first order, both from given data, by SALib.

SALib's estimators with the bias reduction of Plischke et al. (2013), eq. 30, about the estimate on
the data themselves. SALib 1.6 takes a resample for these, which brings back the bias that the
reduction is to take away, and its "balanced" delta weighs the inputs anew, as if all of them were
uniform.
"""

from __future__ import annotations

import numpy as np
from SALib.analyze.delta import calc_delta, sobol_first

from impactlab.analysis.sensitivity import dummy
from impactlab.analysis.sensitivity.index import Index
from impactlab.analysis.sensitivity.sample import Array, Sample

GRID = 100
"""Places at which densities are compared, as in SALib."""
_2013 = "Plischke et al. (2013), Eur. J. Oper. Res. 226, 536"
_DUMMY = "of a random column that the model never saw"
_INDICES = {
    "delta": Index("delta, moment-independent importance", f"{_2013}, eqs. 26 and 30"),
    "delta_first_order": Index("first-order Sobol index from given data", f"{_2013}, section 3"),
    "dummy_delta": Index("delta of a dummy", f"{_2013}, eqs. 26 and 30", (), comment=_DUMMY),
    "dummy_delta_first_order": Index(
        "first-order Sobol index of a dummy from given data",
        f"{_2013}, section 3",
        (),
        comment=_DUMMY,
    ),
}


def indices(sample: Sample) -> dict[str, Index]:
    """What is estimated, by variable name."""
    return _INDICES


def check(sample: Sample) -> None:
    """Raises ValueError where groups are stated."""
    sample.ungrouped()


def varying(outputs: Array, sample: Sample) -> list[Array]:
    """The outputs that have to vary."""
    return [outputs]


def estimate(outputs: Array, sample: Sample, response: str) -> dict[str, Array]:
    """Indices of one response and half-widths of their intervals, by variable name.

    outputs: (runs,), finite and varying. NaN for a parameter of which a class holds one value of
    the response alone: SALib takes such a class for one without influence.
    """
    runs, rng = len(outputs), sample.rng(response)
    inputs = np.column_stack([sample.inputs, dummy.column(runs, sample.rng("dummy"))])
    edges = np.linspace(0, runs, classes(runs) + 1)
    found = [_one(column, outputs, edges, sample, rng) for column in inputs.T]
    result: dict[str, Array] = {}
    for name, values in zip(_INDICES, np.moveaxis(np.array(found), 0, -1), strict=False):
        for ending, row in zip(("", "_interval"), values, strict=True):
            result[f"{name}{ending}"] = row[:-1]
            result[f"dummy_{name}{ending}"] = row[-1]
    return result


def classes(runs: int) -> int:
    """Into how many classes of equal numbers the values of a parameter go, as in SALib."""
    exponent = 2.0 / (7.0 + np.tanh((1500.0 - runs) / 500.0))
    return round(min(int(np.ceil(runs**exponent)), 48))


def _one(
    column: Array, outputs: Array, edges: Array, sample: Sample, rng: np.random.Generator
) -> Array:
    """(delta, first order) by (index, half-width) of one parameter."""
    runs = len(outputs)
    drawn = rng.integers(runs, size=(sample.resamples, runs))
    places = np.linspace(outputs.min(), outputs.max(), GRID)
    replicates = np.array([_raw(column[rows], outputs[rows], edges, places) for rows in drawn])
    value = _raw(column, outputs, edges, places)
    value[0] = 2 * value[0] - replicates[:, 0].mean()
    return np.stack([value, sample.half_width(replicates)], axis=1)


def _raw(column: Array, outputs: Array, edges: Array, places: Array) -> Array:
    """Delta with its bias, NaN where a class has no density; and the first order.

    edges: of the classes, in ranks; places: (GRID,), where densities are compared.
    """
    order = np.argsort(column, kind="stable")
    groups = np.split(outputs[order], edges[1:-1].astype(int))
    first = float(sobol_first(outputs, column, edges))
    if min(np.ptp(group) for group in groups) == 0:
        return np.array([np.nan, first])
    return np.array([float(calc_delta(outputs, places, column, edges)), first])
