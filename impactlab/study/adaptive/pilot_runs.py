"""Pilot runs: the corner cases of a study, solved along one axis of the discretisation.

Corner cases are the numbers of a study at their extremes. With more than four numbers all corners
would be too many. Then the columns of a Hadamard matrix and their negatives are taken (a two-level
design of resolution IV: any three parameters meet in all eight combinations of their extremes; Box,
Hunter and Hunter (2005), Statistics for Experimenters, ch. 6), and the case in the middle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import hadamard

from impactlab.analysis.convergence.axes import without_limit
from impactlab.analysis.responses import usable
from impactlab.model.discretisation import Discretisation
from impactlab.model.parameters import Value, flatten
from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.schema.parameters import Distribution
from impactlab.study.schema.study import Study
from impactlab.variables import described

AXES = ("nodes", "points", "courant")
Cases = Mapping[str, Sequence[Value]]
_ALL = 4
"""Most numbers of which all corners are taken."""
_TAIL = 0.005
"""Probability of either tail of a distribution without end, whose quantiles are its extremes."""


def solve_along(
    study: Study,
    cases: Cases,
    folder: Path,
    engine: Engine,
    axis: str,
    levels: Sequence[float],
    at: Discretisation,
) -> tuple[xr.DataArray, xr.DataArray]:
    """Solve the corner cases of a study with these values of nodes, points or courant.

    folder: for the shards. levels: the values; the other two are those of `at`. Returns values on
    (response, case, axis), NaN where a run failed, in SI units; and on (response, case), True where
    the model itself does not converge along this axis. Raises OSError when the disk is full or no
    scheduler answers.
    """
    fixed = flatten(study.impact, at) | {"duration": study.duration}
    varied: dict[str, Any] = {name: ("case", np.array(values)) for name, values in cases.items()}
    varied["case"] = np.arange(len(next(iter(cases.values()))))
    varied[axis] = axis, np.array(levels)
    scalars = {name: ((), value) for name, value in fixed.items() if name not in varied}
    attrs = {
        "study": study.name,
        "varied": [*cases, axis],
        "responses": list(study.responses),
        "histories": 0,
        "profiles": 0,
        "history_samples": study.store.samples,
    }
    runs = execute(described(xr.Dataset(coords=scalars | varied, attrs=attrs)), folder, engine)
    values = usable(runs).transpose("response", "case", axis)
    without = without_limit(runs, values, axis, axis)
    labels = [name for name in values.coords if name not in values.dims]
    others = [name for name in labels if values[name].dims != ("response",)]
    return values.drop_vars(others), without.drop_vars(others, errors="ignore")


def corner_cases(study: Study) -> dict[str, list[Value]]:
    """Return one value per parameter and case: numbers at extremes and middle, and all words.

    Nodes, points and courant are not varied. Where nothing else is, the study's own impact is the
    one case.
    """
    varied = study.sampling.varied.items()
    ends = {name: _ends(given) for name, given in varied if name not in AXES}
    words = {name: values for name, values in ends.items() if isinstance(values[0], str)}
    numbers = {name: values for name, values in ends.items() if name not in words}
    signs = corners(len(numbers))
    rows = []
    for combination in product(*words.values()):
        for row in signs.tolist():
            levels = [values[1 + sign] for values, sign in zip(numbers.values(), row, strict=True)]
            rows.append((*combination, *levels))
    if not ends:
        return {"velocity": [study.impact.velocity]}
    return {name: [row[at] for row in rows] for at, name in enumerate([*words, *numbers])}


def corners(count: int) -> NDArray[np.int64]:
    """Return the signs (cases, count) of all or some corners of a cube; the middle (0) is last."""
    middle = np.zeros((1, count), dtype=np.int64)
    if count == 0:
        return middle
    if count <= _ALL:
        signs = np.array(list(product((-1, 1), repeat=count)))
    else:
        half = hadamard(1 << (count - 1).bit_length())[:, :count]
        signs = np.concatenate([half, -half])
    return np.concatenate([signs, middle])


def _ends(given: Any) -> Sequence[Any]:
    """Return (least, middle, greatest) of a varied number, or all words."""
    if isinstance(given, Distribution):
        low, middle, high = given.quantile(np.array([_TAIL, 0.5, 1.0 - _TAIL])).tolist()
        bounds = given.bounds()
        return bounds.get("low", low), middle, bounds.get("high", high)
    if isinstance(given[0], str):
        return tuple(given)
    ordered = sorted(given)
    return ordered[0], ordered[len(ordered) // 2], ordered[-1]
