"""Statistics of a slow model: few runs of it and many of the study's model, kept on disk.

The parameters of both are independent draws from the distributions of the study; the runs of the
slow model are at the first of them. Costs are estimates, not measured times, so that no answer
depends on the machine.
"""

import logging
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from math import ceil
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.fidelity_estimates import FidelityEstimate
from impactlab.analysis.multifidelity import FEWEST_PAIRS, Multifidelity, best_ratio
from impactlab.files import opened, write_netcdf
from impactlab.methods.runs import usable
from impactlab.model.checks import integer
from impactlab.model.cost import A_SECOND
from impactlab.model.quantities import time
from impactlab.provenance import provenance
from impactlab.study import MULTIFIDELITY, RARE_EVENT
from impactlab.study.design import design
from impactlab.study.engine import Engine, with_one_client
from impactlab.study.execute import execute
from impactlab.study.multifidelity_answer import FidelityVerdict, answer
from impactlab.study.multifidelity_indices import (
    check_independent,
    number_of_runs,
    slow_indices,
)
from impactlab.study.multifidelity_prediction import (
    check_names,
    points_of,
    predict_options,
    predictions,
    score_columns,
)
from impactlab.study.ownership import study_file
from impactlab.study.rare_event import ScoreRuns
from impactlab.study.schema.declarations import AnyStudy, ImpactStudy
from impactlab.study.schema.prediction_points import Columns
from impactlab.study.schema.readers import slow_study
from impactlab.study.solvers import solver_named
from impactlab.types import Floats
from impactlab.validation.fields import plain
from impactlab.verdicts import flagged

log = logging.getLogger(__name__)

_MOST_PAIRS = 10_000
_MOST_RUNS = 20_000  # of the fast model: of more, the mean of a response hardly gains
_LITTLE = 1.2  # saving below which the fast model is said to be of little use
STATISTICS = (
    *("mean", "standard_deviation"),
    *("percentile_5", "lower_quartile", "median", "upper_quartile", "percentile_95"),
    "exceedance",
)


@with_one_client
def multifidelity(
    study: AnyStudy,
    folder: Path,
    engine: Engine,
    high: Mapping[str, Any] | None = None,
    *,
    pairs: int = 40,
    runs: int = 0,
    budget: float = 0.0,
    indices: bool = False,
    predict: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Return statistics of a study's responses by a slow model; see il.multifidelity.

    folder: of the study's results. high: without it, all settings are the study's. runs: of the
    fast model; 0: the best number. budget: in s of one core, from which the numbers of pairs and
    runs follow; 0: none. indices: True for Sobol indices. predict: values of parameters at which
    the slow model is predicted; without it, the study's. Runs are kept in `folder`/multifidelity
    and are not solved again.

    Raises as ScoreRuns.of, prediction_points and check_pairs, StudyError for a slow model that the
    study cannot have, and ValueError for settings out of range.
    """
    owner = "multifidelity"
    if high is None and (section := study.multifidelity):
        high, pairs, runs, budget = section.high, section.pairs, section.runs, section.budget
        indices = section.indices
        predict = predict or section.predict
    high = high or {}
    pairs = integer(owner, "pairs", pairs, FEWEST_PAIRS)
    runs = integer(owner, "runs", runs, 0)
    if not (np.isfinite(budget) and budget >= 0.0):
        raise ValueError(f"{owner}: budget = {budget!r}: must be positive")
    fast = ScoreRuns.of(study, folder, engine, f"{MULTIFIDELITY}/low")
    if indices:
        check_independent(fast)
    points = points_of(study, predict or {}, pairs)
    declared = slow_study(fast.declared, high)
    first = design(declared, 0, 1).assign_attrs(histories=0, profiles=0)
    slow = replace(fast, declared=declared, first=first, folder=fast.folder.with_name("high"))
    if not isinstance(study, ImpactStudy) and (budget or not runs):
        raise ValueError(f"{owner}: runs: must be stated, because what functions cost is not known")
    pairs = FEWEST_PAIRS if budget else pairs
    scores = _scores(fast, pairs)
    costs = [_cost(model, scores) for model in (fast, slow)]
    _check_budget(budget, pairs, costs[1])
    outputs = [_outputs(model, scores) for model in (fast, slow)]
    ratio = _best_ratio(outputs[0].values, outputs[1].values, costs[1] / costs[0])
    if budget:
        most = int(budget / (costs[1] + ratio * costs[0]))
        pairs = min(max(most, FEWEST_PAIRS), _MOST_PAIRS)
        outputs[1] = _outputs(slow, _scores(fast, pairs))
    runs = max(runs or min(ceil(ratio * pairs), _MOST_RUNS), 2 * pairs)
    outputs[0] = _outputs(fast, _scores(fast, runs))
    dataset = _dataset(fast, *outputs).assign_attrs(
        study.attributes() | provenance(),
        study_file=study_file(study, folder),
        confidence=study.analysis.confidence,
        arguments="".join(f" {quote(f'{name}={plain(value)}')}" for name, value in high.items())
        + f" --pairs {pairs} --runs {runs}{' --indices' * indices}{predict_options(predict or {})}",
        high=", ".join(f"{name} {plain(value)}" for name, value in high.items()),
    )
    if indices:
        shares = slow_indices(fast, partial(_outputs, fast), _scores(fast, pairs), outputs[1])
        dataset, runs = dataset.merge(shares), runs + number_of_runs(scores.shape[1], pairs)
    if points:
        check_names(points, dataset)
        answers = _predictions(fast, points, *outputs, stated=predict or ())
        dataset, runs = dataset.merge(answers), runs + answers.attrs["runs"]
    for name, value, units, meaning in (
        ("pairs", pairs, "1", "runs of the slow model"),
        ("runs", pairs + runs, "1", "runs solved, in all"),
        ("fast_seconds", costs[0], "s", "estimated time of one core of a run of the fast model"),
        ("slow_seconds", costs[1], "s", "estimated time of one core of a run of the slow model"),
        ("best_ratio", ratio, "1", "fast runs per slow run that serve the mean best"),
    ):
        dataset[name] = (), value, {"units": units, "long_name": meaning}
    dataset.attrs["answer"] = answer(dataset)
    write_netcdf(dataset, folder / f"{MULTIFIDELITY}.nc", "multifidelity")
    return dataset


def question_answer(runs: xr.Dataset, folder: Path) -> str:
    """Return the answer in `folder` to what the study of the runs asks: of a slow model, if any."""
    slow = runs.attrs.get("slow_model")
    name = MULTIFIDELITY if slow else RARE_EVENT
    path = folder / f"{name}.nc"
    if path.is_file():
        with opened(path, name, indexed=False) as stored:
            if stored.attrs["study_sha256"] == runs.attrs["study_sha256"]:
                return str(stored.attrs["answer"])
    subject = f"with {slow}" if slow else "on the rare event"
    return f"No answer yet {subject}.\nCaution: `impactlab run` solves the runs that it needs."


def _check_budget(budget: float, pairs: int, cost: float) -> None:
    """Raise ValueError for a budget, in s, that does not pay for these pairs; log their cost."""
    least = pairs * cost
    if budget and budget < least:
        needed = f"{pairs} runs of the slow model alone need about {time(least)}"
        raise ValueError(f"multifidelity: budget = {time(budget)}: {needed}")
    if least > 0.0:
        log.info("%d runs of the slow model: about %s of one core", pairs, time(least))


def _scores(model: ScoreRuns, runs: int) -> Floats:
    """Return standard normal scores, (runs, parameter); the first of more are the same."""
    rng = np.random.default_rng([model.sampling.seed, 39])
    return rng.standard_normal((runs, len(model.sampling.varied)))


def _cost(model: ScoreRuns, scores: Floats) -> float:
    """Return the mean cost of a run in s of one core, estimated; NaN of a function."""
    if not isinstance(model.declared, ImpactStudy):
        return np.nan
    runs = model.design(scores)
    solver = solver_named(str(runs.attrs["solver"]))
    return float(solver.cost(solver.cases(runs, np.arange(len(scores)))).mean() / A_SECOND)


def _outputs(model: ScoreRuns, scores: Floats) -> xr.DataArray:
    """Return the responses on (response, run), NaN where a run has no answer."""
    return _solved(model, model.design(scores))


def _solved(model: ScoreRuns, design: xr.Dataset) -> xr.DataArray:
    """Return the responses of a design on (response, run), NaN where a run has no answer."""
    return usable(execute(design, model.folder, model.engine)).transpose("response", "run")


def _best_ratio(low: Floats, high: Floats, cost_ratio: float) -> float:
    """Return fast runs per slow run that serve the mean of every response."""
    ratios = [2.0]  # as few as a statistic needs
    for fast, slow in zip(low, high, strict=True):
        paired = np.isfinite(fast) & np.isfinite(slow)
        if cost_ratio > 0.0 and paired.sum() > 2 and np.ptp(fast[paired]) and np.ptp(slow[paired]):
            ratios.append(best_ratio(np.corrcoef(fast[paired], slow[paired])[0, 1], cost_ratio))
    return min(max(ratios), cost_ratio + 1.0)  # half of all time at most


def _models(
    low: Floats, high: Floats, confidence: float, inputs: Floats | None = None
) -> Multifidelity | str:
    """Return both models, pairs and runs without an answer left out, or why there are none."""
    pairs, rest = np.isfinite(low[: high.size]) & np.isfinite(high), low[high.size :]
    low = np.concatenate([low[: high.size][pairs], rest[np.isfinite(rest)]])
    inputs = None if inputs is None else inputs[pairs]
    try:
        return Multifidelity(low=low, high=high[pairs], confidence=confidence, inputs=inputs)
    except ValueError as error:
        return _reason(error)


def _predictions(
    model: ScoreRuns,
    points: Columns,
    low: xr.DataArray,
    high: xr.DataArray,
    *,
    stated: Iterable[str],
) -> xr.Dataset:
    """Return the slow model's responses at points from both models' runs.

    stated: names of the parameters that are not at their medians.
    """
    inputs = score_columns(model, model.values(_scores(model, high.sizes["run"])))
    confidence = model.declared.analysis.confidence
    models = {
        name: _models(low.values[row], high.values[row], confidence, inputs)
        for row, name in enumerate(low["response"].values.tolist())
    }
    answers = predictions(model, partial(_solved, model), points, models)
    answers["prediction"].attrs["stated"] = " ".join(stated)
    return answers


def _statistics(
    models: Multifidelity | str, limit: float | None
) -> dict[str, FidelityEstimate | str]:
    """Return the statistics of a response by name, or why there is none; "" without a limit."""
    if isinstance(models, str):
        return dict.fromkeys(STATISTICS, models)
    calls: dict[str, Callable[[], FidelityEstimate]] = {
        "mean": models.mean,
        "standard_deviation": lambda: _root(models.variance()),
        "percentile_5": lambda: models.quantile(0.05),
        "lower_quartile": lambda: models.quantile(0.25),
        "median": lambda: models.quantile(0.5),
        "upper_quartile": lambda: models.quantile(0.75),
        "percentile_95": lambda: models.quantile(0.95),
    }
    if limit is not None:
        calls["exceedance"] = lambda: models.exceedance(limit)
    entries: dict[str, FidelityEstimate | str] = dict.fromkeys(STATISTICS, "")  # in this order
    for name, call in calls.items():
        try:
            entries[name] = call()
        except ValueError as error:
            entries[name] = _reason(error)
    return entries


def _reason(error: ValueError) -> str:
    """Return why there is no estimate, in the words of a study."""
    text = re.sub(r"^Multifidelity[.\w]*: (\w+ = \S+: )?", "", str(error))
    return text.replace("runs of high", "slow runs")


def _root(square: FidelityEstimate) -> FidelityEstimate:
    """Return a standard deviation from a variance."""
    value = float(np.sqrt(square.value))
    errors = square.standard_error / (2 * value), square.plain_error / (2 * value)
    low, high = (float(np.sqrt(end)) for end in square.interval)
    return FidelityEstimate(value, errors[0], (low, high), errors[1])


def _dataset(model: ScoreRuns, low: xr.DataArray, high: xr.DataArray) -> xr.Dataset:
    """Return the statistics of each response, in its units, and both models' pairs."""
    responses, pairs = low["response"].values.tolist(), high.sizes["run"]
    shape = len(responses), len(STATISTICS)
    estimate, saving = np.full((*shape, 3), np.nan), np.full(shape, np.nan)
    reasons = np.full(shape, "", dtype=object)
    correlation, missing = np.full(shape[0], np.nan), np.zeros(shape[0], int)
    verdicts, limits = np.zeros(shape[0], int), np.full(shape[0], np.nan)
    for row, name in enumerate(responses):
        fast, slow = low.values[row], high.values[row]
        models = _models(fast, slow, model.declared.analysis.confidence)
        limit = model.declared.limits.get(name)
        for column, entry in enumerate(_statistics(models, limit).values()):
            if isinstance(entry, str):
                reasons[row, column] = entry
            else:
                estimate[row, column] = entry.value, *entry.interval
                saving[row, column] = entry.saving
        paired = np.isfinite(fast[:pairs]) & np.isfinite(slow)
        missing[row] = pairs - paired.sum() + np.isnan(fast[pairs:]).sum()
        limits[row] = np.nan if limit is None else limit
        if isinstance(models, Multifidelity):
            correlation[row] = models.correlation
        verdicts[row] = _verdict(models, saving[row, 0], int(missing[row]))
    pair = {"units": "1", "long_name": "in units of the response"}
    data = {
        "estimate": (("response", "statistic", "bound"), estimate, pair),
        "saving": (
            ("response", "statistic"),
            saving,
            {"units": "1", "long_name": "slow runs alone per slow run, for the same error"},
        ),
        "refusal": (
            ("response", "statistic"),
            reasons.astype(str),
            {"long_name": "why there is no estimate"},
        ),
        "correlation": ("response", correlation, {"units": "1", "long_name": "correlation"}),
        "missing": ("response", missing, {"units": "1", "long_name": "runs without an answer"}),
        "limit": ("response", limits, pair),
        "fast": (("response", "pair"), low.values[:, :pairs], pair),
        "slow": (("response", "pair"), high.values, pair),
    }
    codes = xr.DataArray(verdicts, dims="response")
    ends = {"long_name": "estimate, and ends of its interval"}
    coords = {
        "response": low["response"],
        "response_units": low["response_units"],
        "response_long_name": low["response_long_name"],
        "statistic": list(STATISTICS),
        "bound": ("bound", ["estimate", "low", "high"], ends),
    }
    return xr.Dataset(data, coords).assign(
        response_verdict=flagged(codes, FidelityVerdict, "verdict on the statistics"),
        verdict=flagged(codes.max(), FidelityVerdict, "worst verdict on the statistics"),
    )


def _verdict(models: Multifidelity | str, saving: float, missing: int) -> FidelityVerdict:
    if isinstance(models, str):
        return FidelityVerdict.NO_STATISTICS
    if missing:
        return FidelityVerdict.MISSING_RUNS
    return FidelityVerdict.USABLE if saving >= _LITTLE else FidelityVerdict.LITTLE_SAVING
