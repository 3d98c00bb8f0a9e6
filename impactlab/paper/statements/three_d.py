"""Statements that compare the beam model with a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from impactlab.model.impact import SOLID
from impactlab.paper.statements.evidence import (
    BEAM,
    FIRST_CONTACT,
    MESHES,
    VELOCITY,
    Floats,
    beam_response,
    refined_elements,
    refined_runs,
    solid_response,
    solid_runs,
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

BEAMS = {BEAM: "Euler-Bernoulli beam", "timoshenko": "Timoshenko beam"}
"""The beam models that are compared, the paper's first."""
DISPLACEMENT_LIMIT = 0.10
DISPLACEMENTS = {"midspan_deflection": "deflection at mid-span", "sphere_displacement": "sphere"}
PRINTED_EXTENT = 1.52e-3
"""Extent of the plastic zone from the centre of the impact, m."""
ZONE_READINGS = {
    "on the surface, PEEQ above 0.2 %": ("plastic_zone_radius", 1.0),
    "at any depth, PEEQ above 1e-5": ("plastic_zone_length", 0.5),
}
"""A variable of the runs, and the factor to the extent from the centre."""


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
        if FIRST_CONTACT in data and "velocity" in data[FIRST_CONTACT].dims:
            velocities = sorted(
                float(velocity) for velocity in data[FIRST_CONTACT]["velocity"].values
            )
        for velocity in velocities:
            for model, words in BEAMS.items():
                yield attempt(f"{velocity:g} m/s, {words}", self._judge, data, velocity, model)

    def _judge(self, case: str, data: Data, velocity: float, model: str) -> Judgement:
        ours = beam_response(data, self.response, velocity, model)
        theirs = solid_response(data, self.response, velocity)
        ratio = ours.value / theirs.value
        share = ours.uncertainty / abs(ours.value) + theirs.uncertainty / abs(theirs.value)
        gap = Number("difference, relative to the 3-D model", ratio - 1.0, "1", ratio * share)
        numbers = (ours, theirs, gap)
        least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
        if least <= self.limit < most:
            return Judgement(case, numbers, Verdict.UNKNOWN, _undecided(self.limit))
        comparative = self.below if gap.value < 0 else self.above
        why = f"The beam's is {100 * abs(gap.value):.1f} % {comparative}."
        reading = (velocity, model) != self.stated
        return Judgement(case, numbers, verdict(most <= self.limit, reading=reading), why)


def _undecided(limit: float) -> str:
    return f"{100 * limit:g} % lies within the uncertainty of the two models together."


FORCE_OF_WITNESS = Statement(
    "force_of_witness",
    text="The peak force lies within 2.4 % of that of a 3-D finite-element model.",
    test=(
        "|F(beam)/F(3-D) − 1| ± U ≤ 2.4 %; F: largest force; U: the numerical uncertainties of "
        "both. 3-D: this project's 3-D model in place of the paper's. The paper states it at 0.99 "
        "m/s of its own beam; other velocities, and the Timoshenko beam, are readings."
    ),
    judge=Agreement("peak_force", 0.024, "smaller", "larger", stated=(VELOCITY, BEAM)),
    studies=(FIRST_CONTACT, MESHES),
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
    studies=(FIRST_CONTACT, MESHES),
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
        return Judgement(case, numbers, Verdict.UNKNOWN, _undecided(DISPLACEMENT_LIMIT))
    than = "more" if gap > width else "no more"
    why = f"They differ by up to {100 * gap:.1f} % of the largest displacement, "
    why += f"{than} than the uncertainty."
    return Judgement(case, numbers, verdict(gap + width <= DISPLACEMENT_LIMIT, reading=True), why)


def _histories(data: Data, variable: str, model: str) -> list[Floats]:
    """Return a history at the paper's velocity per grid of the model, finest first, (time,)."""
    runs = refined_runs(data)
    elements = refined_elements(runs)
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
        "U: three times the same between the two finest grids of each model. The models “agree” "
        "where d + U ≤ 10 %, with “deviations” where d − U > 0. The paper gives no number: 10 % is "
        "ours."
    ),
    judge=_judge_displacements,
    studies=(FIRST_CONTACT, MESHES),
)


def _judge_zone(data: Data) -> Iterator[Judgement]:
    for words, (variable, factor) in ZONE_READINGS.items():
        yield attempt(f"{VELOCITY:g} m/s, {words}", _judge_zone_case, data, variable, factor)


def _judge_zone_case(case: str, data: Data, variable: str, factor: float) -> Judgement:
    runs = solid_runs(data, VELOCITY)
    if "element_size" not in runs.dims:
        raise UnknownError(f"the study {MESHES} has not been solved")
    least = float(runs["element_size"].min()) / factor
    found = solid_response(data, variable, VELOCITY, least)
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
    studies=(FIRST_CONTACT, MESHES),
)
