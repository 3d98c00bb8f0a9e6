"""Some runs of a study, to see what they cost: no sampler is asked, and nothing large is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from impactlab import wings
from impactlab.model import cost as beam_cost
from impactlab.model.parameters import Value, with_values
from impactlab.simulate import case_table
from impactlab.study.declaration import Grid, Sample, Study
from impactlab.study.declaration.solid import asks_for_solid
from impactlab.study.errors import Problem, StudyError

Array = np.ndarray[Any, Any]
_MOST = 4096
_TAIL = 1e-3
"""Of a distribution, on either side: left out."""


class Costs(Protocol):
    """What tells the costs of a table of cases."""

    def work(self, cases: Array) -> Array:
        """Time of each run, in node-steps of the paper's beam."""
        ...

    def memory(self, cases: Array) -> Array:
        """Bytes that each run takes."""
        ...


def costs(study: Study) -> Costs:
    """Of the runs of a study."""
    found: Costs = wings.load(wings.SOLID["costs"]) if asks_for_solid(study) else beam_cost
    return found


def table(study: Study) -> Callable[..., Array]:
    """What makes the table of its cases: simulate.case_table, or as that."""
    if not asks_for_solid(study):
        return case_table
    found: Callable[..., Array] = wings.load(wings.SOLID["cases"]).table
    return found


def looked_at(study: Study) -> dict[str, Array]:
    """Values by varied parameter, one a run: all of a small grid, else some 4096 drawn ones."""
    sampling, random = study.sampling, np.random.default_rng(0)
    if isinstance(sampling, Sample):
        number = min(study.runs, _MOST)
        return {
            name: given.quantile(random.uniform(_TAIL, 1 - _TAIL, number))
            for name, given in sampling.varied.items()
        }
    values = {name: np.array(listed) for name, listed in sampling.parameters.items()}
    if study.runs <= _MOST:
        all_of_them = np.meshgrid(*values.values(), indexing="ij")
        return {name: grid.ravel() for name, grid in zip(values, all_of_them, strict=True)}
    return {name: random.choice(listed, _MOST) for name, listed in values.items()}


def tabled(study: Study, columns: Mapping[str, Sequence[Value] | Array]) -> Array:
    """The table of cases of these runs. Raises StudyError where one of them is impossible."""
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    try:
        return table(study)(*base, duration=study.duration, varied=columns)
    except ValueError as error:
        reason = f"gives runs that are impossible ({error}): take bounded distributions"
        raise StudyError(Problem(str(study.path), "sampling.parameters", reason)) from None


def costliest(study: Study, looked: Mapping[str, Array], cost: Array) -> dict[str, Value]:
    """The largest run, by parameter: from the largest one looked at, each to its costliest end."""
    found = {name: column[int(np.argmax(cost))].item() for name, column in looked.items()}
    for name in found:
        ends = _ends(study, name)
        columns = {key: [value] * len(ends) for key, value in found.items()} | {name: ends}
        found[name] = ends[int(np.argmax(costs(study).work(tabled(study, columns))))]
    return found


def _ends(study: Study, name: str) -> list[Value]:
    """A parameter's least and greatest value, or all its words."""
    sampling = study.sampling
    if isinstance(sampling, Grid):
        values = sampling.parameters[name]
        return list(values) if isinstance(values[0], str) else [min(values), max(values)]
    ends: list[Value] = sampling.varied[name].quantile(np.array([_TAIL, 1 - _TAIL])).tolist()
    return ends
