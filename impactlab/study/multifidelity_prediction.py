"""Answers of a study's slow model at stated points, from the fast model's runs there."""

from collections.abc import Callable, Mapping
from shlex import quote
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.fidelity_correction import check_pairs, outside
from impactlab.analysis.multifidelity import Multifidelity
from impactlab.methods.distributions import Choice
from impactlab.model.quantities import engineering
from impactlab.study.rare_event import ScoreRuns
from impactlab.study.schema.declarations import AnyStudy
from impactlab.study.schema.prediction_points import Columns, prediction_points
from impactlab.types import Floats
from impactlab.validation.fields import plain

_KEPT = ("units", "long_name")
_SEPARATOR = ","


def points_of(study: AnyStudy, predict: Mapping[str, Any], pairs: int) -> Columns:
    """Return points to predict; see prediction_points. Raises as that does, and as check_pairs."""
    if predict:
        check_pairs("multifidelity: predict", pairs, study.analysis.confidence)
    return prediction_points(study, predict) if predict else {}


def check_names(points: Columns, dataset: xr.Dataset) -> None:
    """Raise ValueError for a parameter with the name of a variable of the results."""
    for name in points:
        if name in dataset.variables or name in dataset.dims:
            reason = f"the results have a variable {name}: give the parameter another name"
            raise ValueError(f"multifidelity: predict: {reason}")


def score_columns(model: ScoreRuns, values: Columns) -> Floats:
    """Return the standard normal scores of values of each varied parameter, (runs, parameter)."""
    varied = model.sampling.varied
    return np.column_stack([entry.scores(values[name]) for name, entry in varied.items()])


def predictions(
    model: ScoreRuns,
    solved: Callable[[xr.Dataset], xr.DataArray],
    points: Columns,
    models: dict[str, Multifidelity | str],
) -> xr.Dataset:
    """Return the slow model's answers at points, with the reason where there is none.

    solved: returns the fast model's responses on (response, run) of a design. points: values of
    each varied parameter. models: both, with the scores of the pairs as inputs, by response, or why
    there are none. Points beyond all pairs are not solved.
    """
    scores = score_columns(model, points)
    reasons = {
        name: _refusals(model, fidelities, points, scores) for name, fidelities in models.items()
    }
    rows = [row for row in range(len(scores)) if not all(texts[row] for texts in reasons.values())]
    fast = np.full((len(models), len(scores)), np.nan)
    if rows:
        columns = {name: values[rows] for name, values in points.items()}
        fast[:, rows] = solved(model.design_of(columns)).values
    ends = np.full((*fast.shape, 3), np.nan)
    for response, (texts, fidelity) in enumerate(
        zip(reasons.values(), models.values(), strict=True)
    ):
        for row in rows:
            if not texts[row] and np.isnan(fast[response, row]):
                texts[row] = "the study's model has no answer there"
        inner = [row for row in rows if not texts[row]]
        if isinstance(fidelity, str) or not inner:
            continue
        try:
            answers = fidelity.prediction(scores[inner], fast[response, inner])
        except ValueError as error:  # too few of the pairs have answers
            for row in inner:
                texts[row] = str(error).partition(": ")[2]
            continue
        ends[response, inner] = np.column_stack([answers.value, answers.low, answers.high])
        for row, reason in zip(inner, answers.refusal, strict=True):
            texts[row] = reason
    about = {"units": "1", "long_name": "answer of the slow model, in units of the response"}
    attrs = {name: model.first[name].attrs for name in points}
    return xr.Dataset(
        {
            "prediction": (("response", "point", "bound"), ends, about),
            "prediction_refusal": (
                ("response", "point"),
                np.array(list(reasons.values())),
                {"long_name": "why there is no prediction"},
            ),
        },
        {
            name: ("point", values, {key: attrs[name][key] for key in attrs[name] if key in _KEPT})
            for name, values in points.items()
        },
        {"runs": len(rows)},
    )


def _refusals(
    model: ScoreRuns, models: Multifidelity | str, points: Columns, scores: Floats
) -> list[str]:
    """Return why a response has no prediction at each point; "" where it may have one."""
    if isinstance(models, str):
        return [models] * len(scores)
    texts = []
    for row, columns in enumerate(outside(models.inputs, scores)):
        reasons = []
        for column, (name, entry) in enumerate(model.sampling.varied.items()):
            pairs, value = models.inputs[:, column], points[name][row]
            place = f"{model.long_name(name)} {model.stated(name, value)}"
            if isinstance(entry, Choice):
                reasons += [] if scores[row, column] in pairs else [f"no pair has {place}"]
            elif column in columns:
                ends = entry.at_scores(np.array([pairs.min(), pairs.max()]))
                low, high = (model.stated(name, end) for end in ends)
                reasons.append(f"{place} is beyond the pairs, {low} to {high}")
        texts.append("; ".join(reasons))
    return texts


def interval_text(values: list[float], units: str) -> str:
    """Return a value with its unit and its interval."""
    value, low, high = (engineering(number, units) for number in values)
    number, _, unit = low.partition(" ")
    return f"{value} ({number if high.endswith(f' {unit}') else low} to {high})"


def predicted_at(result: xr.Dataset, point: int) -> list[str]:
    """Return the stated parameters and their values there, in words."""
    texts = []
    for name in result["prediction"].attrs["stated"].split():
        column = result[name]
        value = column.values[point]
        is_word = column.dtype.kind in "UO"
        text = value if is_word else engineering(float(value), str(column.attrs.get("units", "1")))
        texts.append(f"{column.attrs.get('long_name', name.replace('_', ' '))} {text}")
    return texts


def prediction_sentence(result: xr.Dataset, row: int) -> str:
    """Return the prediction of a response at the first point, in a sentence."""
    name = str(result["response"].values[row]).replace("_", " ")
    place, points = ", ".join(predicted_at(result, 0)), result.sizes["point"]
    further = f" (the first of {points} points)" if points > 1 else ""
    values = result["prediction"].values[row, 0].tolist()
    if np.isnan(values[0]):
        reason = result["prediction_refusal"].values[row, 0]
        return f"Prediction: none of the {name} at {place}{further}: {reason}."
    text = interval_text(values, str(result["response_units"].values[row]))
    return f"Prediction: at {place} the {name} is {text}{further}."


def predict_options(predict: Mapping[str, Any]) -> str:
    """Return the options of `impactlab multifidelity` for these points."""
    texts = []
    for name, data in predict.items():
        values = data if isinstance(data := plain(data), list) else [data]
        texts.append(f" --predict {quote(f'{name}={_SEPARATOR.join(map(str, values))}')}")
    return "".join(texts)
