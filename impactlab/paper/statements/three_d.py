"""Statements that compare the beam model with a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.axes import ELEMENT_SIZE
from impactlab.analysis.convergence.judgement import numerical_uncertainty
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.paper.statements.statement import (
    BEAM,
    Case,
    Data,
    Judgement,
    Number,
    UnknownError,
    Verdict,
    finest_grid,
    judged,
    runs_of,
    select_response,
    statement,
)
from impactlab.types import Floats
from impactlab.variables import RESPONSES, WITNESS

VELOCITY = 0.99
"""The paper's impact velocity, m/s."""
FIRST_CONTACT, MESHES = "witness", "witness_mesh"
"""Studies: beam and 3-D models over the velocities; the 3-D model at VELOCITY on finer meshes."""
BEAMS = {BEAM: "Euler-Bernoulli beam", "timoshenko": "Timoshenko beam"}
"""The beam models that are compared, the paper's first."""
_UNDECIDED = "{:g} % lies within the uncertainty of the two models together."


def _solid_response(data: Data, response: str, velocity: float, least: float = 0.0) -> Number:
    """Return the 3-D model's response; its uncertainty is `least` or more."""
    runs = _solid_runs(data, velocity)
    if response not in runs:
        study = runs.attrs.get("study", FIRST_CONTACT)
        raise UnknownError(f"the runs of the study {study} do not hold the {response}")
    values = select_response(runs, response, velocity=velocity, beam_model=SOLID)
    elements = _refined_elements(runs)
    spacings = ELEMENT_SIZE.spacings[elements](runs[elements].values.astype(float))
    finest_first = np.argsort(spacings)
    found = values.values.astype(float)[finest_first]
    width = max(float(numerical_uncertainty(found, spacings[finest_first])[0][0]), least)
    entry = (RESPONSES | WITNESS)[response]
    return _bounded(Number(f"{entry.long_name} (3-D)", found[0], entry.units, width))


def _solid_runs(data: Data, velocity: float) -> xr.Dataset:
    """Return runs that vary the elements: of MESHES at the paper's velocity, if solved."""
    if velocity == VELOCITY and MESHES in data:
        return data[MESHES].expand_dims("velocity")
    return _refined_runs(data)[0].isel(nodes=0)


def _refined_runs(data: Data) -> tuple[xr.Dataset, str]:
    """Return the runs of FIRST_CONTACT and the dimension that refines their elements."""
    runs = runs_of(data, FIRST_CONTACT)
    if "nodes" not in runs.dims:
        raise UnknownError(f"the study {FIRST_CONTACT} does not vary nodes: its error is unknown")
    return runs, _refined_elements(runs)


def _refined_elements(runs: xr.Dataset) -> str:
    if found := [name for name in ELEMENTS if name in runs.dims]:
        return found[0]
    study = runs.attrs.get("study", "?")
    raise UnknownError(f"the study {study} does not vary {ELEMENTS[0]}: its error is unknown")


def _bounded(number: Number) -> Number:
    if not np.isfinite(number.uncertainty):
        raise UnknownError(f"nothing bounds the numerical error of the {number.name}")
    return number


def _velocities_and_beams(data: Data) -> Iterator[Case]:
    velocities = [VELOCITY]
    if FIRST_CONTACT in data and "velocity" in data[FIRST_CONTACT].dims:
        velocities = np.sort(data[FIRST_CONTACT]["velocity"].values.astype(float)).tolist()
    for velocity in velocities:
        for model, words in BEAMS.items():
            yield f"{velocity:g} m/s, {words}", velocity, model


def _judge_ratio(
    case: str,
    data: Data,
    velocity: float,
    model: str,
    response: str,
    limit: float,
    words: tuple[str, str],
    literal: bool,
) -> Judgement:
    """Judge |beam/3-D − 1| ± U ≤ limit; words: for less and more; literal: see judged."""
    runs, elements = _refined_runs(data)
    runs = runs.isel({elements: 0})
    ours = _bounded(finest_grid(runs, response, velocity=velocity, beam_model=model))
    theirs = _solid_response(data, response, velocity)
    ratio = ours.value / theirs.value
    share = ours.uncertainty / abs(ours.value) + theirs.uncertainty / abs(theirs.value)
    gap = Number("difference, relative to the 3-D model", ratio - 1.0, "1", ratio * share)
    numbers = (ours, theirs, gap)
    least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
    if least <= limit < most:
        return Judgement(case, numbers, Verdict.UNKNOWN, _UNDECIDED.format(100 * limit))
    why = f"The beam's is {100 * abs(gap.value):.1f} % {words[0 if gap.value < 0 else 1]}."
    return judged(case, numbers, most <= limit, why, literal=literal)


@statement(
    text="The peak force lies within 2.4 % of that of a 3-D finite-element model.",
    test=(
        "|F(beam)/F(3-D) − 1| ± U ≤ 2.4 %; F: largest force; U: the numerical uncertainties of "
        "both. 3-D: this project's 3-D model in place of the paper's. The paper states it at 0.99 "
        "m/s of its own beam; other velocities, and the Timoshenko beam, are readings."
    ),
    cases=_velocities_and_beams,
    studies=(FIRST_CONTACT, MESHES),
)
def force_of_witness(case: str, data: Data, velocity: float, model: str) -> Judgement:
    """Judge the peak forces."""
    printed, words = (velocity, model) == (VELOCITY, BEAM), ("smaller", "larger")
    return _judge_ratio(case, data, velocity, model, "peak_force", 0.024, words, printed)


@statement(
    text=(
        "The displacements of sphere and beam agree with a 3-D finite-element model, with slight "
        "deviations."
    ),
    test=(
        "d = max over time of |w(beam) − w(3-D)|, over the largest |w(3-D)|, on the finest grids; "
        "U: three times the same between the two finest grids of each model. The models “agree” "
        "where d + U ≤ 10 %, with “deviations” where d − U > 0. The paper gives no number: 10 % is "
        "ours."
    ),
    cases=tuple(
        (f"{VELOCITY:g} m/s, {what}, {words}", variable, model)
        for variable, what in (
            ("midspan_deflection", "deflection at mid-span"),
            ("sphere_displacement", "sphere"),
        )
        for model, words in BEAMS.items()
    ),
    studies=(FIRST_CONTACT, MESHES),
)
def displacement_of_witness(case: str, data: Data, variable: str, model: str) -> Judgement:
    """Judge the histories of a displacement."""
    ours, theirs = (_histories(data, variable, name) for name in (model, SOLID))
    scale = float(np.max(np.abs(theirs[0])))
    gap = float(np.max(np.abs(ours[0] - theirs[0]))) / scale
    # three times the largest change from the second finest grid to the finest, of each model
    changes = [3.0 * float(np.max(np.abs(curves[1] - curves[0]))) for curves in (ours, theirs)]
    width = (changes[0] + changes[1]) / scale
    name = "largest difference over the largest displacement"
    numbers = (Number(name, gap, "1", width, percent=True),)
    if gap - width <= 0.10 < gap + width:
        return Judgement(case, numbers, Verdict.UNKNOWN, _UNDECIDED.format(100 * 0.10))
    than = "more" if gap > width else "no more"
    why = f"They differ by up to {100 * gap:.1f} % of the largest displacement, "
    why += f"{than} than the uncertainty."
    return judged(case, numbers, gap + width <= 0.10, why, literal=False)


def _histories(data: Data, variable: str, model: str) -> list[Floats]:
    """Return a history at the paper's velocity per grid of the model, finest first, (time,)."""
    runs, elements = _refined_runs(data)
    refined, other = (elements, "nodes") if model == SOLID else ("nodes", elements)
    runs = runs.isel({other: 0})
    if variable not in runs:
        raise UnknownError(f"the study {FIRST_CONTACT} keeps no histories")
    chosen = runs[variable].sel(velocity=VELOCITY, beam_model=model).compute()
    order = np.sort(chosen[refined].values)[:: 1 if refined == "element_size" else -1]
    curves = [chosen.sel({refined: value}).values for value in order]
    if not np.isfinite(curves).all():
        raise UnknownError(f"the {variable.replace('_', ' ')} of a run is missing")
    return curves


@statement(
    text="The contact duration against the velocity agrees with a 3-D finite-element model.",
    test=(
        "|t(beam)/t(3-D) − 1| ± U ≤ 5 %; t: duration of the first contact; U: the numerical "
        "uncertainties of both. The paper gives no number: 5 % is ours, about what its figure "
        "shows, so a case that holds does so under a reading."
    ),
    cases=_velocities_and_beams,
    studies=(FIRST_CONTACT, MESHES),
)
def duration_of_witness(case: str, data: Data, velocity: float, model: str) -> Judgement:
    """Judge the durations of the first contact."""
    words = "shorter", "longer"
    return _judge_ratio(case, data, velocity, model, "contact_duration", 0.05, words, False)


@statement(
    text="At 0.99 m/s the plastic zone reaches 1.52 mm from the centre (3-D finite elements).",
    test=(
        "|r − 1.52 mm| ≤ U; U: the numerical uncertainty of r, at least the size of an element. "
        "The paper does not say at which strain its zone ends, so there are two readings of r: on "
        "the struck surface, where PEEQ falls to 0.2 % along the beam (element means, linear in "
        "between); and at any depth, half of the length of beam in which an element has a PEEQ "
        "above 1e-5."
    ),
    cases=(
        (f"{VELOCITY:g} m/s, on the surface, PEEQ above 0.2 %", "plastic_zone_radius", 1.0),
        (f"{VELOCITY:g} m/s, at any depth, PEEQ above 1e-5", "plastic_zone_length", 0.5),
    ),
    studies=(FIRST_CONTACT, MESHES),
)
def plastic_zone_of_witness(case: str, data: Data, variable: str, factor: float) -> Judgement:
    """Judge a variable of the runs; factor: from it to the extent from the centre."""
    printed = 1.52e-3  # m
    runs = _solid_runs(data, VELOCITY)
    if "element_size" not in runs.dims:
        raise UnknownError(f"the study {MESHES} has not been solved")
    least = float(runs["element_size"].min()) / factor
    found = _solid_response(data, variable, VELOCITY, least)
    reach = Number("extent from the centre", factor * found.value, "m", factor * found.uncertainty)
    within = reach.low <= printed <= reach.high
    if within and reach.uncertainty > 0.5 * printed:
        why = "The elements are too large to tell."
        return Judgement(case, (reach,), Verdict.UNKNOWN, why)
    why = f"The printed extent lies {'within' if within else 'outside'} the uncertainty."
    return judged(case, (reach,), within, why, literal=False)
