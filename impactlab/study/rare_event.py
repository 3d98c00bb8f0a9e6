"""The probability of a rare event from runs of a study's solver, kept and found again on disk."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr

from impactlab.analysis.rare_event import Estimate, RareEventVerdict
from impactlab.analysis.rare_event import estimate as estimated
from impactlab.files import write_netcdf
from impactlab.methods.distributions import Choice
from impactlab.methods.hypercube import (
    FEWEST_PLACED,
    Correlations,
    Hypercube,
    UntilProbability,
    correlation_matrix,
)
from impactlab.methods.runs import usable
from impactlab.methods.sampling import RandomSample
from impactlab.model.checks import integer
from impactlab.model.quantities import engineering
from impactlab.provenance import provenance
from impactlab.study import RARE_EVENT, steps
from impactlab.study.adaptive.recommendation import AXES, grid_uncertainty
from impactlab.study.design import design
from impactlab.study.engine import Engine, with_one_client
from impactlab.study.estimate import Estimate as Cost
from impactlab.study.estimate import estimate as cost_of
from impactlab.study.execute import execute
from impactlab.study.ownership import check_unclaimed, study_file
from impactlab.study.schema.consistency import further_models
from impactlab.study.schema.declarations import AnyStudy, ImpactStudy
from impactlab.types import Floats
from impactlab.validation.errors import Problem, StudyError
from impactlab.verdicts import flagged

log = logging.getLogger(__name__)

SAMPLES, _FEWEST = 500, 200  # runs per level, by default and at least
_DEFAULTS = {"samples": SAMPLES, "runs": 6000, "variation": 0.1}
"""Of the options of `impactlab rare`."""
_PER_PARAMETER = 25
"""Least number of runs per level and parameter: with half of it probabilities are too small."""
_MATTERS = 0.5  # standard deviations from which on the answer names a parameter


@dataclass
class ScoreRuns:
    """Runs of a study's solver at standard normal scores.

    Scores are independent; with correlations, those of the parameters are their Gaussian copula.
    declared: the study, with a discretisation. first: its first run, as a design. folder: of the
    runs, which are not solved again.
    """

    declared: AnyStudy
    sampling: RandomSample
    first: xr.Dataset
    folder: Path
    engine: Engine

    @classmethod
    def of(cls, study: AnyStudy, folder: Path, engine: Engine, kind: str) -> Self:
        """Return the runs of a study, kept in `folder`/`kind`.

        Raises StudyError for a study without a sample, ValueError where another study has results
        in `folder`.
        """
        sampling = random_sample(study)
        check_unclaimed(study, folder / "runs.nc")
        declared = steps.resolved(study, folder, engine) or study
        first = design(declared, 0, 1).assign_attrs(histories=0, profiles=0)
        return cls(declared, sampling, first, folder / kind, engine)

    def design(self, scores: Floats) -> xr.Dataset:
        """Return the design at standard normal scores (runs, parameter)."""
        return self.design_of(self.values(scores))

    def design_of(self, values: Mapping[str, np.ndarray]) -> xr.Dataset:
        """Return the design at values, or words, of each varied parameter, (runs,)."""
        size = len(next(iter(values.values())))
        runs = self.first.isel(run=np.zeros(size, int))
        columns = {name: ("run", column, self.first[name].attrs) for name, column in values.items()}
        numbers = ("run", np.arange(size), self.first["run"].attrs)
        return runs.assign_coords({"run": numbers} | columns)

    def deviations(self, scores: Floats) -> Floats:
        """Return the scores that correlated parameters have by themselves, (runs, parameter)."""
        if not self.correlations:
            return scores
        linear = correlation_matrix(list(self.sampling.varied), self.correlations)
        # einsum, not a product of matrices: the same bits for any number of threads
        return np.asarray(np.einsum("nj,ij->ni", scores, np.linalg.cholesky(linear)))

    @property
    def correlations(self) -> Correlations:
        """Pairs of parameters with their rank correlation."""
        return self.sampling.correlations if isinstance(self.sampling, Hypercube) else ()

    def values(self, scores: Floats) -> dict[str, np.ndarray]:
        """Return the values, or words, of each varied parameter at scores (runs, parameter)."""
        scores = self.deviations(scores)
        return {
            name: entry.quantile(scipy.special.ndtr(column))
            if isinstance(entry, Choice)
            else entry.at_scores(column)
            for (name, entry), column in zip(self.sampling.varied.items(), scores.T, strict=True)
        }

    def long_name(self, parameter: str) -> str:
        """Return the name of a parameter in words."""
        attrs = self.first[parameter].attrs
        return str(attrs.get("long_name", parameter.replace("_", " ")))

    def stated(self, parameter: str, value: Any) -> str:
        """Return the value with its unit, or a word."""
        if isinstance(self.sampling.varied[parameter], Choice):
            return str(value)
        return engineering(float(value), str(self.first[parameter].attrs.get("units", "1")))


@dataclass
class LimitRuns(ScoreRuns):
    """Runs at standard normal scores, and the response that has a limit.

    units: of the response, known after the first runs.
    """

    units: str = ""

    @classmethod
    def of(cls, study: AnyStudy, folder: Path, engine: Engine, kind: str) -> Self:
        """Return the runs of a study, kept in `folder`/`kind`.

        Raises as ScoreRuns.of, and StudyError for a study with other than one limit.
        """
        limited_sample(study)
        return super().of(study, folder, engine, kind)

    @property
    def response(self) -> str:
        """Name of the response that has a limit."""
        return next(iter(self.declared.limits))

    @property
    def limit(self) -> float:
        """Limit of the response, in its unit."""
        return self.declared.limits[self.response]

    def outputs(self, scores: Floats) -> Floats:
        """Return the response at standard normal scores (runs, parameter), NaN where missing."""
        solved = execute(self.design(scores), self.folder, self.engine)
        self.units = str(solved[self.response].attrs.get("units", "1"))
        return np.asarray(usable(solved, self.response).values[0])

    def numerical_error(self, scores: Floats) -> float:
        """Return the numerical uncertainty of the response at scores (parameter,), in its unit.

        It is infinite where it is unknown, and NaN for a function or a varied discretisation, which
        have none.
        """
        study = self.declared
        if not isinstance(study, ImpactStudy) or {*AXES} & {*self.sampling.varied}:
            return np.nan
        if further_models(study):  # of a wing, whose mesh has other axes
            return np.inf
        cases = {name: column.tolist() for name, column in self.values(scores[np.newaxis]).items()}
        errors = grid_uncertainty(study, cases, self.folder, self.engine)
        return float(errors.sel(response=self.response).item())

    @property
    def event(self) -> str:
        """The event in words: the response exceeds its limit."""
        limit = engineering(self.limit, self.units)
        return f"{self.response.replace('_', ' ')} exceeds {limit}"


def random_sample(study: AnyStudy) -> RandomSample:
    """Return the sample of a study. Raises StudyError for a study without one."""
    if not isinstance(study.sampling, RandomSample):
        reason = "has no distributions to draw from: use any method but grid"
        raise StudyError(Problem(str(study.path), "sampling.method", reason))
    return study.sampling


def limited_sample(study: AnyStudy) -> RandomSample:
    """Return the sample of a study with one limit. Raises StudyError for another study."""
    sampling = random_sample(study)
    if len(study.limits) != 1:
        reason = f"state {len(study.limits)} limits, and a rare event has one: state one response"
        raise StudyError(Problem(str(study.path), "limits", reason))
    return sampling


def check_estimate(
    owner: str, samples: int, runs: int, target: float, *, surrogate: bool = False
) -> tuple[int, int]:
    """Return runs per level and of an estimate.

    Raises ValueError for settings out of range, OSError where a package is not installed.
    """
    if surrogate and find_spec("sklearn") is None:
        raise OSError(f"{owner}: surrogate: needs scikit-learn: pip install 'impactlab[kriging]'")
    samples = integer(owner, "samples", samples, _FEWEST)
    if not 0.01 <= target <= 0.5:
        message = "must be from 0.01 to 0.5"
        raise ValueError(f"{owner}: coefficient_of_variation = {target!r}: {message}")
    return samples, integer(owner, "runs", runs, FEWEST_PLACED if surrogate else 4 * samples)


def check_per_parameter(owner: str, samples: int, parameters: int) -> None:
    """Raise ValueError for too few runs per level to move in so many parameters."""
    if samples < (fewest := _PER_PARAMETER * parameters):
        message = f"must be at least {fewest}, which is {_PER_PARAMETER} per parameter that varies"
        raise ValueError(f"{owner}: samples = {samples}: {message}")


def cost(study: AnyStudy, folder: Path, workers: int, runs: int) -> Cost:
    """Return the cost of at most so many runs of a study. Raises StudyError as LimitRuns.of."""
    limited_sample(study)
    return cost_of(steps.resolved(study, folder) or study, folder, workers, runs)


@with_one_client
def rare_event(
    study: AnyStudy,
    folder: Path,
    engine: Engine,
    samples: int,
    runs: int,
    target: float,
    *,
    surrogate: bool = False,
) -> xr.Dataset:
    """Return the probability that a study's response exceeds its limit; see il.rare_event.

    folder: of the study's results. Runs are kept in `folder`/rare_event and are not solved again.

    Raises as LimitRuns.of and check_estimate.
    """
    samples, runs = check_estimate("rare_event", samples, runs, target, surrogate=surrogate)
    solver = LimitRuns.of(study, folder, engine, RARE_EVENT)
    event = solver.outputs, len(solver.sampling.varied), solver.limit
    settings: dict[str, Any] = {"seed": solver.sampling.seed, "most": runs, "target": target}
    settings["confidence"] = study.analysis.confidence
    if surrogate:
        from impactlab.analysis.limit_state import MOST_PARAMETERS, learned_estimate

        if event[1] > MOST_PARAMETERS:
            message = f"a Gaussian process knows at most {MOST_PARAMETERS} parameters"
            raise ValueError(f"rare_event: surrogate: {message}, and {event[1]} vary: leave it out")
        result = learned_estimate(*event, **settings)
    else:
        check_per_parameter("rare_event", samples, event[1])
        result = estimated(*event, samples=samples, **settings)
    dataset = _dataset(result, solver).assign_attrs(
        study.attributes() | provenance(),
        study_file=study_file(study, folder),
        confidence=study.analysis.confidence,
        target=target,
        words=solver.sampling.words,
        arguments=_options(samples, runs, target, surrogate=surrogate),
        answer=_answer(result, solver),
    )
    write_netcdf(dataset, folder / f"{RARE_EVENT}.nc", "rare_event")
    return dataset


def _options(samples: int, runs: int, target: float, *, surrogate: bool) -> str:
    """Return the options of `impactlab rare` that are not its defaults."""
    values = zip(_DEFAULTS.items(), (samples, runs, target), strict=True)
    options = [f" --{name} {value:g}" for (name, default), value in values if value != default]
    return "".join([" --surrogate", *options] if surrogate else options)


def place_runs(study: AnyStudy, folder: Path, engine: Engine, until: UntilProbability) -> None:
    """Place runs until the probability is known as well as the study asks; log the answer."""
    settings = SAMPLES, until.runs, until.coefficient_of_variation
    result = rare_event(study, folder, engine, *settings, surrogate=True)
    (folder / f"{RARE_EVENT}.html").unlink(missing_ok=True)  # of the result before
    for line in result.attrs["answer"].splitlines():
        log.info("%s", line)


def _dataset(result: Estimate, solver: LimitRuns) -> xr.Dataset:
    """Return the numbers of an estimate with names and units."""
    sampling, units = solver.sampling, solver.units
    gap = np.full(len(sampling.varied), np.nan)
    point = gap if result.design_point is None else result.design_point
    distance = float(np.sqrt((point**2).sum()))
    if sampling.words:  # no plane lies along words
        distance = np.nan
    numbers: dict[str, tuple[float, str, str]] = {
        "limit": (solver.limit, units, f"limit of {solver.response}"),
        "probability": (result.probability, "1", "probability that the response exceeds it"),
        "low": (result.low, "1", "lower end of its interval, if no missing run exceeds the limit"),
        "high": (result.high, "1", "upper end of its interval, if every missing run does"),
        "if_none": (result.if_none, "1", "probability if no missing run exceeds the limit"),
        "if_all": (result.if_all, "1", "probability if every missing run does"),
        "check": (result.check, "1", "independent estimate by the sample before the last"),
        "coefficient_of_variation": (
            result.coefficient_of_variation,
            "1",
            "standard error of the probability over itself",
        ),
        "first_order": (
            float(scipy.special.ndtr(-distance)),
            "1",
            "probability beyond a plane through the design point (FORM)",
        ),
        "runs": (result.runs, "1", "runs solved, in all"),
        "last_sample": (result.last_sample, "1", "runs of the sample that gives the estimate"),
        "placed": (result.placed, "1", "runs that a Gaussian process placed, with its first ones"),
        "missing": (result.missing, "1", "of these, runs without an answer"),
    }
    variables = {
        name: ((), value, {"units": unit, "long_name": meaning})
        for name, (value, unit, meaning) in numbers.items()
    }
    scores = {"units": "1", "long_name": "design point, in standard normal scores"}
    values = {"long_name": "values of the design point"}
    places = solver.values(point[np.newaxis])
    point = solver.deviations(point[np.newaxis])[0]
    texts = [
        "" if np.isnan(point).any() else solver.stated(name, places[name][0]) for name in places
    ]
    levels = {"units": units, "long_name": "limit of each level"}
    code = xr.DataArray(int(result.verdict))
    return xr.Dataset(
        variables
        | {
            "design_point": ("parameter", point, scores),
            "design_value": ("parameter", texts, values),
            "level": ("levels", np.array(result.levels), levels),
        },
        {
            "parameter": list(sampling.varied),
            "parameter_long_name": ("parameter", [solver.long_name(name) for name in places]),
        },
    ).assign(verdict=flagged(code, RareEventVerdict, "verdict on the probability"))


def _answer(result: Estimate, solver: LimitRuns) -> str:
    """Return the findings in sentences: the probability first."""
    varied, study = solver.sampling.varied, solver.declared
    if result.design_point is None:
        meaning = result.verdict.meaning
        return f"No probability that the {solver.event}: {meaning} ({result.runs:,} runs)"
    text = (
        f"The {solver.event} with probability {result.probability:.2g} ({result.low:.2g} to "
        f"{result.high:.2g}, {100 * study.analysis.confidence:g} % interval; coefficient of "
        f"variation {result.coefficient_of_variation:.2g}; {result.runs:,} runs)."
    )
    if result.placed:
        plain = (1 - result.probability) / (result.probability * result.coefficient_of_variation**2)
        text += (
            f"\nRuns: {result.placed:,} for a Gaussian process, {result.last_sample:,} for the "
            f"estimate; plain draws would take about {float(f'{plain:.2g}'):,.0f}."
        )
    if result.verdict is not RareEventVerdict.USABLE:
        text += f"\nCaution: {result.verdict.meaning}."
    places = []
    row = result.design_point[np.newaxis]
    point = dict(zip(varied, solver.deviations(row)[0].tolist(), strict=True))
    values = solver.values(row)
    for name, score in sorted(point.items(), key=lambda item: -abs(item[1])):
        if isinstance(varied[name], Choice):
            places.append(f"{solver.long_name(name)} {values[name][0]}")
        elif abs(score) >= _MATTERS:
            value = solver.stated(name, values[name][0])
            places.append(f"{solver.long_name(name)} {score:+.1f} sd ({value})".replace("-", "−"))
    if not places:  # the middle of all scores lies beyond
        return text
    return f"{text}\nThe likeliest way to exceed it: {', '.join(places)}."
