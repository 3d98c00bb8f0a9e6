"""The runs behind a recommendation: all corner cases along one axis of the discretisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from impactlab.analysis.convergence import by_design
from impactlab.analysis.responses import usable
from impactlab.model.discretisation import Discretisation
from impactlab.model.parameters import Value, flatten
from impactlab.study.declaration import Study
from impactlab.study.engine import Engine
from impactlab.study.execution import execute
from impactlab.variables import described

Cases = Mapping[str, Sequence[Value]]


class Answered(NamedTuple):
    """Responses of all cases along an axis of the discretisation.

    values: on (response, case, axis), NaN where a run failed, in SI units; without_limit: on
    (response, case), where the model itself has none along this axis.
    """

    values: xr.DataArray
    without_limit: xr.DataArray


class Trials:
    """Solves the corner cases of a study with other discretisations; what is solved is kept."""

    def __init__(self, study: Study, cases: Cases, folder: Path, engine: Engine) -> None:
        """cases: values by parameter, one a case; folder: for the shards."""
        self._study, self._cases, self._folder, self._engine = study, cases, folder, engine

    def along(self, axis: str, rungs: Sequence[float], at: Discretisation) -> Answered:
        """The answers with these values of nodes, points or courant.

        rungs: the values; the other two are those of `at`. Raises OSError when the disk is full or
        no scheduler answers.
        """
        runs = execute(self._design(axis, rungs, at), self._folder, self._engine)
        values = usable(runs).transpose("response", "case", axis)
        without = by_design.mask(runs, values, axis, axis)
        labels = [name for name in values.coords if name not in values.dims]
        others = [name for name in labels if values[name].dims != ("response",)]
        return Answered(values.drop_vars(others), without.drop_vars(others, errors="ignore"))

    def _design(self, axis: str, rungs: Sequence[float], at: Discretisation) -> xr.Dataset:
        study = replace(self._study, discretisation=at)
        scalars = flatten(study.impact, study.discretisation) | {"duration": study.duration}
        count = len(next(iter(self._cases.values()), [None]))
        varied: dict[str, Any] = {
            name: ("case", np.array(values)) for name, values in self._cases.items()
        }
        varied |= {"case": np.arange(count), axis: (axis, np.array(rungs))}
        attrs = {
            "study": study.name,
            "varied": [*self._cases, axis],
            "responses": list(study.responses),
            "histories": 0,
            "profiles": 0,
            "history_samples": study.store.samples,
        }
        scalars_kept = {name: ((), value) for name, value in scalars.items() if name not in varied}
        return described(xr.Dataset(coords=scalars_kept | varied, attrs=attrs))
