"""Statements that compare the beam model with a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.element_size import SPACINGS
from impactlab.analysis.convergence.uncertainty import numerical_uncertainty
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.paper.statements.evidence import (
    BEAM,
    Floats,
    finest_grid,
    runs_of,
    select_response,
)
from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    attempt,
    verdict,
)
from impactlab.variables import RESPONSES, WITNESS

STUDIES = STUDY, MESHES = "witness", "witness_mesh"
"""The first contact by beam and 3-D models; the 3-D model at VELOCITY on finer meshes."""
VELOCITY = 0.99
"""The paper's, in m/s."""
BEAMS = {BEAM: "Euler-Bernoulli beam", "timoshenko": "Timoshenko beam"}
"""The beam models that are compared, the paper's first."""
DISPLACEMENT_LIMIT = 0.10
DISPLACEMENTS = {"midspan_deflection": "deflection at mid-span", "sphere_displacement": "sphere"}
PRINTED_EXTENT = 1.52e-3
"""Of the plastic zone from the centre of the impact, m."""
ZONE_READINGS = {
    "on the surface, PEEQ above 0.2 %": ("plastic_zone_radius", 1.0),
    "at any depth, PEEQ above 1e-5": ("plastic_zone_length", 0.5),
}
"""A variable of the runs, and the factor to the extent from the centre."""


def _beam_response(data: Data, response: str, velocity: float, model: str) -> Number:
    """Return a beam model's response; raises UnknownError where its uncertainty is unknown."""
    runs = _refined_runs(data)
    runs = runs.isel({_refined_elements(runs): 0})
    return _bounded(finest_grid(runs, response, velocity=velocity, beam_model=model))


def _solid_response(data: Data, response: str, velocity: float, least: float = 0.0) -> Number:
    """Return the 3-D model's response, its uncertainty from the element sizes, at least `least`.

    At the paper's velocity it comes from the study MESHES, where that is solved. Raises
    UnknownError where a run is missing or nothing bounds the error.
    """
    runs = _solid_runs(data, velocity)
    if response not in runs:
        study = runs.attrs.get("study", STUDY)
        raise UnknownError(f"the runs of the study {study} do not hold the {response}")
    values = select_response(runs, response, velocity=velocity, beam_model=SOLID)
    spacings = SPACINGS[dim := _refined_elements(runs)](runs[dim].values.astype(float))
    finest_first = np.argsort(spacings)
    found = values.values.astype(float)[finest_first]
    width = max(float(numerical_uncertainty(found, spacings[finest_first]).amounts[0]), least)
    entry = (RESPONSES | WITNESS)[response]
    return _bounded(Number(f"{entry.long_name} (3-D)", found[0], entry.units, width))


def _refined_runs(data: Data) -> xr.Dataset:
    """Return the runs of STUDY; raises UnknownError unless both kinds of model are refined."""
    runs = runs_of(data, STUDY)
    if "nodes" not in runs.dims:
        raise UnknownError(f"the study {STUDY} does not vary nodes: the error is unknown")
    _refined_elements(runs)
    return runs


def _refined_elements(runs: xr.Dataset) -> str:
    """Return the dimension on which the 3-D elements are refined; raises UnknownError without."""
    for name in ELEMENTS:
        if name in runs.dims:
            return name
    study = runs.attrs.get("study", "?")
    raise UnknownError(f"the study {study} does not vary {ELEMENTS[0]}: the error is unknown")


def _solid_runs(data: Data, velocity: float) -> xr.Dataset:
    """Return runs, among them those of the 3-D model, that vary the element size."""
    if velocity == VELOCITY and MESHES in data:
        return data[MESHES].expand_dims("velocity")
    return _refined_runs(data).isel(nodes=0)


def _bounded(number: Number) -> Number:
    if not np.isfinite(number.uncertainty):
        raise UnknownError(f"nothing bounds the numerical error of the {number.name}")
    return number


@dataclass(frozen=True)
class Agreement:
    """A judge of |beam/3-D − 1| ± U ≤ limit; U: the numerical uncertainties of both.

    below, above: words for a smaller and a larger value, such as "shorter" and "longer".
    stated: (velocity in m/s, beam model) that the paper speaks of; all others are readings.
    """

    response: str
    limit: float
    below: str
    above: str
    stated: tuple[float, str] | None = None

    def __call__(self, data: Data) -> Iterator[Judgement]:
        """Yield one judgement per velocity and beam model."""
        velocities = [VELOCITY]
        if STUDY in data and "velocity" in data[STUDY].dims:
            velocities = sorted(float(velocity) for velocity in data[STUDY]["velocity"].values)
        for velocity in velocities:
            for model, words in BEAMS.items():
                yield attempt(f"{velocity:g} m/s, {words}", self._judge, data, velocity, model)

    def _judge(self, case: str, data: Data, velocity: float, model: str) -> Judgement:
        ours = _beam_response(data, self.response, velocity, model)
        theirs = _solid_response(data, self.response, velocity)
        ratio = ours.value / theirs.value
        share = ours.uncertainty / abs(ours.value) + theirs.uncertainty / abs(theirs.value)
        gap = Number("difference, relative to the 3-D model", ratio - 1.0, "1", ratio * share)
        numbers = (ours, theirs, gap)
        least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
        if least <= self.limit < most:
            why = f"{self.limit:.1%} lies within the uncertainty of the two models together."
            return Judgement(case, numbers, Verdict.UNKNOWN, why)
        why = f"The beam's is {abs(gap.value):.1%} {self.below if gap.value < 0 else self.above}."
        reading = (velocity, model) != self.stated
        return Judgement(case, numbers, verdict(most <= self.limit, reading=reading), why)


FORCE_OF_WITNESS = Statement(
    "force_of_witness",
    text="The peak force lies within 2.4 % of that of a 3-D finite-element model.",
    test=(
        "|F(beam)/F(3-D) − 1| ± U ≤ 2.4 %; F: largest force; U: the numerical uncertainties of "
        "both. 3-D: this project's 3-D model in place of the paper's. The paper states it at 0.99 "
        "m/s of its own beam; other velocities, and the Timoshenko beam, are readings."
    ),
    judge=Agreement("peak_force", 0.024, "smaller", "larger", stated=(VELOCITY, BEAM)),
    studies=STUDIES,
)
DURATION_OF_WITNESS = Statement(
    "duration_of_witness",
    text="The contact duration against the velocity agrees with a 3-D finite-element model.",
    test=(
        "|t(beam)/t(3-D) − 1| ± U ≤ 5 %; t: duration of the first contact; U: the numerical "
        "uncertainties of both. The paper gives no number: 5 % is ours, about what its figure "
        "shows, so a case that holds does so under a reading."
    ),
    judge=Agreement("contact_duration", 0.05, "shorter", "longer"),
    studies=STUDIES,
)


def _judge_displacements(data: Data) -> Iterator[Judgement]:
    for variable, what in DISPLACEMENTS.items():
        for model, words in BEAMS.items():
            case = f"{VELOCITY:g} m/s, {what}, {words}"
            yield attempt(case, _judge_displacement, data, variable, model)


def _judge_displacement(case: str, data: Data, variable: str, model: str) -> Judgement:
    ours, theirs = (_histories(data, variable, name) for name in (model, SOLID))
    scale = float(np.max(np.abs(theirs[0])))
    gap = float(np.max(np.abs(ours[0] - theirs[0]))) / scale
    width = (_history_uncertainty(ours) + _history_uncertainty(theirs)) / scale
    name = "largest difference over the largest displacement"
    numbers = (Number(name, gap, "1", width, percent=True),)
    if gap - width <= DISPLACEMENT_LIMIT < gap + width:
        limit = f"{DISPLACEMENT_LIMIT:.0%}"
        why = f"{limit} lies within the uncertainty of the two models together."
        return Judgement(case, numbers, Verdict.UNKNOWN, why)
    than = "more" if gap > width else "no more"
    why = (
        f"They differ by up to {gap:.1%} of the largest displacement, {than} than the uncertainty."
    )
    return Judgement(case, numbers, verdict(gap + width <= DISPLACEMENT_LIMIT, reading=True), why)


def _histories(data: Data, variable: str, model: str) -> list[Floats]:
    """Return a history at the paper's velocity per grid of the model, finest first, (time,)."""
    runs = _refined_runs(data)
    elements = _refined_elements(runs)
    refined, other = (elements, "nodes") if model == SOLID else ("nodes", elements)
    runs = runs.isel({other: 0})
    if variable not in runs:
        raise UnknownError(f"the study {STUDY} keeps no histories")
    chosen = runs[variable].sel(velocity=VELOCITY, beam_model=model).compute()
    order = np.sort(chosen[refined].values)[:: 1 if refined == "element_size" else -1]
    curves = [chosen.sel({refined: value}).values for value in order]
    if not np.isfinite(curves).all():
        raise UnknownError(f"the {variable.replace('_', ' ')} of a run is missing")
    return curves


def _history_uncertainty(curves: list[Floats]) -> float:
    """Return three times the largest change from the second finest grid to the finest, in m."""
    return 3.0 * float(np.max(np.abs(curves[1] - curves[0])))


DISPLACEMENT_OF_WITNESS = Statement(
    "displacement_of_witness",
    text=(
        "The displacements of sphere and beam agree with a 3-D finite-element model, with slight "
        "deviations."
    ),
    test=(
        "d = max over time of |w(beam) − w(3-D)|, over the largest |w(3-D)|, on the finest grids; "
        "U: three times the same between each model's own two finest grids. They "
        "“agree” with d + U ≤ 10 %, and have “deviations” with d − U > 0. The paper gives no "
        "number: 10 % is ours."
    ),
    judge=_judge_displacements,
    studies=STUDIES,
)


def _judge_zone(data: Data) -> Iterator[Judgement]:
    for words, (variable, factor) in ZONE_READINGS.items():
        yield attempt(f"{VELOCITY:g} m/s, {words}", _judge_zone_case, data, variable, factor)


def _judge_zone_case(case: str, data: Data, variable: str, factor: float) -> Judgement:
    runs = _solid_runs(data, VELOCITY)
    if "element_size" not in runs.dims:
        raise UnknownError(f"the study {MESHES} has not been solved")
    least = float(runs["element_size"].min()) / factor
    found = _solid_response(data, variable, VELOCITY, least)
    reach = Number("extent from the centre", factor * found.value, "m", factor * found.uncertainty)
    within = reach.low <= PRINTED_EXTENT <= reach.high
    if within and reach.uncertainty > 0.5 * PRINTED_EXTENT:
        why = "The elements are too large to tell."
        return Judgement(case, (reach,), Verdict.UNKNOWN, why)
    why = f"The printed extent lies {'within' if within else 'outside'} the uncertainty."
    return Judgement(case, (reach,), verdict(within, reading=True), why)


PLASTIC_ZONE_OF_WITNESS = Statement(
    "plastic_zone_of_witness",
    text="At 0.99 m/s the plastic zone reaches 1.52 mm from the centre (3-D finite elements).",
    test=(
        "|r − 1.52 mm| ≤ U; U: the numerical uncertainty of r, at least the size of an element. "
        "The paper does not say at which strain its zone ends, so there are two readings of r: on "
        "the struck surface, where PEEQ falls to 0.2 % along the beam (element means, linear in "
        "between); and at any depth, half of the length of beam in which an element has a PEEQ "
        "above 1e-5."
    ),
    judge=_judge_zone,
    studies=STUDIES,
)
