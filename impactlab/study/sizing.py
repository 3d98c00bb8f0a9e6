"""The best design of a study whose probability of exceeding a limit is small enough."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its special is loaded when first used
import xarray as xr

from impactlab.analysis.sizing import (
    MOST_ESTIMATES,
    MOST_VARIABLES,
    Index,
    Sizing,
    SizingVerdict,
    pilot_runs,
    size,
)
from impactlab.files import write_netcdf
from impactlab.methods.distributions import LogUniform, Uniform
from impactlab.model.checks import column
from impactlab.model.parameters import with_values
from impactlab.model.quantities import engineering
from impactlab.provenance import provenance
from impactlab.study import SIZING
from impactlab.study.engine import Engine, with_one_client
from impactlab.study.ownership import study_file
from impactlab.study.rare_event import (
    LimitRuns,
    check_estimate,
    check_per_parameter,
    limited_sample,
)
from impactlab.study.schema.declarations import AnyStudy, ImpactStudy
from impactlab.types import Floats
from impactlab.validation.errors import unknown
from impactlab.verdicts import flagged

MASS = "mass"
"""Name of the objective that is no parameter: the mass of the beam."""
_LEAST, _MOST = 1e-6, 0.3  # probabilities


def most_runs(study: AnyStudy, runs: int) -> int:
    """Return the most runs of a design, of which each estimate takes at most `runs`.

    Raises StudyError as LimitRuns.of.
    """
    return pilot_runs(len(limited_sample(study).varied)) + MOST_ESTIMATES * runs


@with_one_client
def sizing(
    study: AnyStudy,
    folder: Path,
    engine: Engine,
    variables: Sequence[str],
    probability: float,
    *,
    minimise: str = MASS,
    maximise: str = "",
    samples: int = 500,
    runs: int = 6000,
    target: float = 0.1,
) -> xr.Dataset:
    """Return the best design of a study; see il.size.

    folder: of the study's results. Runs are kept in `folder`/sizing and are not solved again.

    Raises as LimitRuns.of, and ValueError for variables and settings that are out of range.
    """
    samples, runs = check_estimate("size", samples, runs, target)
    if not _LEAST <= probability <= _MOST:
        message = f"must be from {_LEAST:g} to {_MOST:g}"
        raise ValueError(f"size: probability = {probability!r}: {message}")
    solver = LimitRuns.of(study, folder, engine, SIZING)
    _check_variables(solver, variables)
    objective, name = _objective(solver, variables, minimise, maximise)
    varied = [*solver.sampling.varied]
    columns = [varied.index(variable) for variable in variables]
    others = [index for index in range(len(varied)) if index not in columns]
    check_per_parameter("size", samples, len(others))

    def solve(designs: Floats, scores: Floats) -> Floats:
        points = np.empty((len(designs), len(varied)))
        points[:, columns] = scipy.special.ndtri(designs)
        points[:, others] = scores
        return solver.outputs(points)

    result = size(
        solve,
        objective,
        len(variables),
        len(others),
        solver.limit,
        probability,
        seed=solver.sampling.seed,
        samples=samples,
        runs=runs,
        target=target,
        confidence=study.analysis.confidence,
    )
    error, result = _numerical(result, solver, columns, others, probability)
    sign = -1.0 if maximise else 1.0
    options = f" --maximise {maximise}" if maximise else f" --minimise {minimise}"
    dataset = _dataset(result, solver, variables, sign, name, error).assign_attrs(
        study.attributes() | provenance(),
        study_file=study_file(study, folder),
        arguments=f" {' '.join(variables)} --probability {probability:g}{options}",
        confidence=study.analysis.confidence,
        target=target,
        largest_probability=probability,
        objective=name,
        answer=_answer(result, solver, variables, sign, name, probability, error),
    )
    write_netcdf(dataset, folder / f"{SIZING}.nc", "sizing")
    return dataset


def _numerical(
    result: Sizing,
    solver: LimitRuns,
    columns: Sequence[int],
    others: Sequence[int],
    probability: float,
) -> tuple[tuple[float, float, float], Sizing]:
    """Return the numerical error, the probabilities with it, and the design as it is judged then.

    The error is that of the response at the design and the likeliest way beyond the limit there, in
    its unit. NaN where there is no such point; infinite, without probabilities, where it is
    unknown.
    """
    estimate = result.probability
    if not result.verdict.sound or estimate.design_point is None:
        return (np.nan, np.nan, np.nan), result
    point = np.empty(len(columns) + len(others))
    point[[*columns]] = scipy.special.ndtri(result.designs[0])
    point[[*others]] = estimate.design_point
    error = solver.numerical_error(point)
    if not np.isfinite(error):
        return (error, np.nan, np.nan), result
    low, high = (estimate.beyond(solver.limit + side) for side in (error, -error))
    if high > probability:
        result = replace(result, verdict=SizingVerdict.NUMERICAL)
    return (error, low, high), result


def _check_variables(solver: LimitRuns, variables: Sequence[str]) -> None:
    """Raise ValueError for design variables without a range, too many, or all parameters."""
    varied = solver.sampling.varied
    for variable in variables:
        if variable not in varied:
            message = unknown("parameter", variable, varied)
            raise ValueError(f"size: variables: {variable!r}: {message}")
        if not isinstance(varied[variable], Uniform | LogUniform):
            raise ValueError(
                f"size: variables: {variable} has no range: give it the distribution uniform, from "
                "the least to the greatest value that you could choose"
            )
    for *pair, _ in solver.correlations:
        for variable in {*pair} & {*variables}:
            other = pair[variable == pair[0]]
            raise ValueError(
                f"size: variables: {variable} is chosen, and so cannot correlate with {other}: "
                "take the entry out of sampling.correlations"
            )
    if len(set(variables)) != len(variables) or not 1 <= len(variables) <= MOST_VARIABLES:
        raise ValueError(f"size: variables: must be 1 to {MOST_VARIABLES} different parameters")
    if len(variables) == len(varied):
        raise ValueError("size: variables: no parameter is left that scatters")


def _objective(
    solver: LimitRuns, variables: Sequence[str], minimise: str, maximise: str
) -> tuple[Index, str]:
    """Return what is to be small, from designs in the unit cube, and its name."""
    varied, study, name = solver.sampling.varied, solver.declared, maximise or minimise

    def values(designs: Floats) -> dict[str, Floats]:
        return {
            variable: varied[variable].quantile(column)
            for variable, column in zip(variables, designs.T, strict=True)
        }

    if name in variables:
        sign = -1.0 if maximise else 1.0
        return lambda designs: sign * values(designs)[name], name
    if maximise or name != MASS or not isinstance(study, ImpactStudy):
        mass = [MASS] if isinstance(study, ImpactStudy) and not maximise else []
        key = "maximise" if maximise else "minimise"
        message = unknown("objective", name, [*mass, *variables])
        raise ValueError(f"size: {key} = {name!r}: {message}")

    def mass_of_beam(designs: Floats) -> Floats:
        columns = {variable: column(row) for variable, row in values(designs).items()}
        stated: dict[str, Any] = {**solver.sampling.fixed, **columns}
        beam = with_values(study.impact, study.discretisation, stated)[0].beam
        return np.broadcast_to(np.asarray(beam.mass_per_length * beam.span), len(designs))

    ends = np.array([np.zeros(len(variables)), np.ones(len(variables))])
    if np.ptp(mass_of_beam(ends)) == 0.0:
        raise ValueError(
            f"size: minimise: the mass of the beam does not depend on {', '.join(variables)}: "
            "state which of them to minimise or to maximise"
        )
    return mass_of_beam, name


def _dataset(
    result: Sizing,
    solver: LimitRuns,
    variables: Sequence[str],
    sign: float,
    name: str,
    numerical: tuple[float, float, float],
) -> xr.Dataset:
    """Return the numbers of a design with names and units."""
    estimates, front = result.estimates, result.front
    label, units = _label(solver, name)
    probability = {"units": "1", "long_name": f"probability that the {solver.event}"}
    best = {"units": units, "long_name": label}
    data: dict[str, Any] = {
        variable: (
            ("bound",),
            solver.sampling.varied[variable].quantile(result.designs[:, index]),
            solver.first[variable].attrs,
        )
        for index, variable in enumerate(variables)
    }
    for index, variable in enumerate(variables):
        values = solver.sampling.varied[variable].quantile(result.tried[:, index])
        data[f"tried_{variable}"] = (("estimate",), values, solver.first[variable].attrs)
    numbers = [result.probability.probability, result.probability.low, result.probability.high]
    data["probability"] = (("bound",), numbers, probability)
    data["objective"] = (("bound",), sign * result.objectives, best)
    data["tried_objective"] = (("estimate",), sign * result.tried_objectives, best)
    for key in ("probability", "low", "high"):
        tried = [getattr(estimate, key) for estimate in estimates]
        long_name = {"low": "lower end of its interval", "high": "upper end of its interval"}
        attrs = probability | ({"long_name": long_name[key]} if key in long_name else {})
        data[f"tried_{key}"] = (("estimate",), tried, attrs)
    data["front_objective"] = (("front", "bound"), sign * front[1:].T, best)
    data["numerical_error"] = (
        (),
        numerical[0],
        {"units": solver.units, "long_name": f"numerical error of {solver.response} there"},
    )
    data["numerical_probability"] = (
        ("side",),
        [*numerical[1:]],
        {"units": "1", "long_name": "probability if the response is smaller or larger by it"},
    )
    data["runs"] = ((), result.runs, {"units": "1", "long_name": "runs solved, in all"})
    bounds = {"long_name": "estimate, and ends of its interval"}
    coords = {
        "bound": ("bound", ["estimate", "favourable", "unfavourable"], bounds),
        "front": ("front", front[0], probability),
    }
    verdict = flagged(xr.DataArray(int(result.verdict)), SizingVerdict, "verdict on the design")
    return xr.Dataset(data, coords).assign(verdict=verdict)


def _label(solver: LimitRuns, name: str) -> tuple[str, str]:
    """Return the objective in words, and its unit."""
    if name in solver.sampling.varied:
        return solver.long_name(name), str(solver.first[name].attrs.get("units", "1"))
    return "mass of the beam", "kg"


def _answer(
    result: Sizing,
    solver: LimitRuns,
    variables: Sequence[str],
    sign: float,
    name: str,
    largest: float,
    numerical: tuple[float, float, float],
) -> str:
    """Return the findings in sentences: the design first."""
    estimate, confidence = result.probability, 100 * solver.declared.analysis.confidence
    label, units = _label(solver, name)
    event = f"the {solver.event}"
    places = ", ".join(
        f"{solver.long_name(variable)} "
        f"{solver.stated(variable, solver.sampling.varied[variable].quantile(share))}"
        for variable, share in zip(variables, result.designs[0], strict=True)
    )
    known = (
        f"{estimate.probability:.2g} ({estimate.low:.2g} to {estimate.high:.2g}, {confidence:g} % "
        f"interval)"
    )
    if np.isnan(estimate.probability):
        known = "unknown, because the runs allowed do not reach the limit"
    if result.verdict is SizingVerdict.UNREACHED:
        known = "too small to estimate"
    if result.verdict in (SizingVerdict.IMPOSSIBLE, SizingVerdict.NOT_CONVERGED):
        return (
            f"No design: {result.verdict.meaning}.\n"
            f"The best one tried: {places}; {event} with probability {known}, and at most "
            f"{largest:g} is wanted ({result.runs:,} runs)."
        )
    kind = "least" if sign > 0 else "greatest"
    lines = [
        f"The design of {kind} {label} for which {event} with probability at most {largest:g} has "
        f"{places}.",
        f"Probability there: {known}, by {estimate.runs:,} of {result.runs:,} runs.",
    ]
    error, least, most = numerical
    if np.isinf(error):
        lines.append("Numerical error: unknown at this design: check the convergence there.")
    elif not np.isnan(error):
        lines.append(
            f"Numerical error: up to {engineering(error, solver.units)} at the likeliest way "
            f"beyond the limit, by which the probability is {least:.2g} to {most:.2g}."
        )
    ends = sign * result.objectives[1:]
    if np.isfinite(ends).all():
        low, high = (engineering(float(end), units) for end in np.sort(ends))
        chosen = engineering(float(sign * result.objectives[0]), units)
        lines.append(f"{label.capitalize()}: {chosen}; the {kind} possible is {low} to {high}.")
    if result.verdict is not SizingVerdict.USABLE:
        meaning = result.verdict.meaning
        if result.verdict is SizingVerdict.UNSOUND:
            meaning += f" ({estimate.verdict.meaning})"
        lines.append(f"Caution: {meaning}.")
    return "\n".join(lines)
