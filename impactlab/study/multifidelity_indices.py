"""Sobol indices of a study's slow model: runs of the fast one by which parameters count."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.multifidelity_indices import FastIndex, first_order, slow_index, total_order
from impactlab.study.rare_event import ScoreRuns
from impactlab.types import Floats
from impactlab.validation.errors import Problem, StudyError

BASE_SAMPLES = 2048
"""Base samples of the fast model's indices."""
REDRAWS = 8
"""Draws of the other parameters at each pair."""
ORDERS = ("first_order", "total_order")


def check_independent(model: ScoreRuns) -> None:
    """Raise StudyError for a study with correlated parameters."""
    if model.correlations:
        reason = "Sobol indices assume independent parameters: take out indices or correlations"
        raise StudyError(Problem(str(model.declared.path), "multifidelity.indices", reason))


def number_of_runs(parameters: int, pairs: int) -> int:
    """Return the number of runs of the fast model that indices take."""
    return BASE_SAMPLES * (parameters + 2) + 2 * REDRAWS * parameters * pairs


def slow_indices(
    model: ScoreRuns,
    solved: Callable[[Floats], xr.DataArray],
    scores: Floats,
    high: xr.DataArray,
) -> xr.Dataset:
    """Return the indices of each response of the slow model, with the reason where there is none.

    solved: returns the fast model's responses on (response, run) at scores. scores: of the pairs,
    (pairs, parameter). high: responses of the slow model at the pairs, on (response, run).
    """
    pairs, parameters = scores.shape
    rng = np.random.default_rng([model.sampling.seed, 40])
    base = rng.standard_normal((2, BASE_SAMPLES, parameters))
    redraws = rng.standard_normal((REDRAWS, pairs, parameters))
    blocks = [scores, *base]
    for column in range(parameters):
        blocks.append(_with(base[0], base[1], column))
        blocks.append(_with(redraws, scores, column).reshape(-1, parameters))
        blocks.append(_with(scores, redraws, column).reshape(-1, parameters))
    ends = np.cumsum([len(block) for block in blocks])[:-1]
    fast = solved(np.concatenate(blocks))
    names = fast["response"].values.tolist()
    shape = len(names), len(ORDERS), parameters
    index, reasons = np.full((*shape, 3), np.nan), np.full(len(names), "", dtype=object)
    for row in range(len(names)):
        outputs = np.split(fast.values[row], ends)
        try:
            index[row] = _of_response(
                outputs, high.values[row], parameters, model.declared.analysis.confidence
            )
        except ValueError as error:
            reasons[row] = str(error)
    about = {"units": "1", "long_name": "Sobol index of the slow model"}
    return xr.Dataset(
        {
            "slow_index": (("response", "order", "parameter", "bound"), index, about),
            "index_refusal": (
                "response",
                reasons.astype(str),
                {"long_name": "why there are no indices"},
            ),
        },
        {
            "order": list(ORDERS),
            "parameter": list(model.sampling.varied),
            "parameter_long_name": (
                "parameter",
                [model.long_name(name) for name in model.sampling.varied],
            ),
        },
    )


def sensitivity(result: xr.Dataset, row: int) -> str:
    """Return the shares of the variance of a response that are above zero, in a sentence."""
    name = str(result["response"].values[row]).replace("_", " ")
    if reason := str(result["index_refusal"].values[row]):
        return f"Sensitivity: no indices of the {name}: {reason}."
    first = result["slow_index"].sel(order="first_order").isel(response=row)
    order = np.argsort(-first.sel(bound="estimate").values, kind="stable")
    shares = [
        f"{result['parameter_long_name'].values[column]} {stated_index(first.values[column])}"
        for column in order
        if first.values[column, 1] > 0.0
    ]
    listed = "; ".join(shares) or "no parameter for certain"
    return f"Sensitivity: the {name} scatters with {listed}."


def stated_index(values: Floats) -> str:
    """Return an index and its interval as shares of the variance."""
    value, low, high = (f"{100 * number:.0f}" for number in values)
    return f"{value} % ({low} to {high} %)"


def _with(scores: Floats, second: Floats, column: int) -> Floats:
    """Return scores with a column of second ones; they spread over the further axes of either."""
    mixed = np.broadcast_to(scores, np.broadcast_shapes(scores.shape, second.shape)).copy()
    mixed[..., column] = second[..., column]
    return mixed


def _of_response(
    blocks: list[Floats], high: Floats, parameters: int, confidence: float
) -> list[Any]:
    """Return indices, (order, parameter, bound). Raises ValueError where there are none."""
    missing = sum(int(np.isnan(block).sum()) for block in blocks)
    if missing := missing + int(np.isnan(high).sum()):
        raise ValueError(
            f"{missing} runs have no answer, and indices need all of them: narrow the distributions"
        )
    low, outputs, second, *rest = blocks
    if np.ptp(low) == 0.0 or np.ptp(high) == 0.0 or np.ptp(outputs) == 0.0:
        raise ValueError("outputs that do not vary have no indices")
    variance = float(np.concatenate([outputs, second]).var(ddof=1))
    indices: list[list[FastIndex]] = [[], []]
    for column in range(parameters):
        mixed, alone, without = rest[3 * column : 3 * column + 3]
        parts = alone.reshape(REDRAWS, -1), without.reshape(REDRAWS, -1)
        indices[0].append(first_order(outputs, second, mixed, parts[0]))
        indices[1].append(total_order(outputs, second, mixed, parts[1], low))
    return [
        [slow_index(low, high, variance, fast, confidence) for fast in order] for order in indices
    ]
