"""Points at which the answer of a slow model is predicted: the key `multifidelity.predict`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from impactlab.methods.distributions import Choice, Steps
from impactlab.model.parameters import PARAMETERS
from impactlab.model.quantities import engineering, si
from impactlab.study.schema.declarations import AnyStudy, FunctionStudy
from impactlab.validation.errors import Problem, StudyError, unknown
from impactlab.validation.fields import plain

Columns = dict[str, np.ndarray[Any, Any]]


def prediction_points(study: AnyStudy, predict: Mapping[str, Any]) -> Columns:
    """Return the values of every varied parameter, (points,), in SI units, or words.

    predict: a value or a list of values by parameter; parameters that it does not have lie at their
    medians. Raises StudyError naming the parameter.
    """
    path, key = str(study.path), "multifidelity.predict"
    varied, problems, columns = study.sampling.varied, [], {}
    for name, data in predict.items():
        if name not in varied:
            reason = unknown("drawn parameter", name, varied)
            problems.append(Problem(path, f"{key}.{name}", reason))
            continue
        values = data if isinstance(data := plain(data), list) else [data]
        try:
            columns[name] = _read(varied[name], _units(study, name), values)
        except ValueError as error:
            problems.append(Problem(path, f"{key}.{name}", str(error), data))
    for name, entry in varied.items():
        if isinstance(entry, Choice) and name not in predict:
            reason = f"words have no median: state {name}, {', '.join(entry.values)}"
            problems.append(Problem(path, key, reason))
    lengths = sorted({column.size for column in columns.values()} - {1})
    if lengths[1:]:
        counts = " and ".join(map(str, lengths))
        problems.append(Problem(path, key, f"lists of {counts} values: must be of one length"))
    if problems:
        raise StudyError(*problems)
    points = max(lengths, default=1)
    medians = {name: entry.quantile(0.5) for name, entry in varied.items() if name not in columns}
    return {name: np.broadcast_to((columns | medians)[name], points) for name in varied}


def _units(study: AnyStudy, name: str) -> str:
    if isinstance(study, FunctionStudy):
        return str(study.labels[name]["units"])
    return PARAMETERS[name].units


def _read(entry: Any, units: str, values: list[Any]) -> np.ndarray[Any, Any]:
    """Return values in SI units, or words. Raises ValueError for what is never drawn."""
    if not values:
        raise ValueError("is empty: list at least one value")
    if isinstance(entry, Choice):
        for word in values:
            if word not in entry.values:
                raise ValueError(unknown("word", word, entry.values))
        return np.array(values)
    numbers = np.array([si(value, units) for value in values])
    if isinstance(entry, Steps):
        steps = np.clip(entry.steps_to(numbers), 0, entry.count - 1)
        levels = entry.at_steps(steps)
        if not np.allclose(levels, numbers, rtol=1e-9, atol=1e-9 * entry.step):
            ends = f"{engineering(entry.low, units)} to {engineering(entry.high, units)}"
            raise ValueError(f"is not drawn: steps of {engineering(entry.step, units)} from {ends}")
        return np.asarray(levels)
    return numbers
