"""Statements on the contact: its duration and the permanent indentation against the velocity."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    response_curve,
    runs_of,
    verdict,
)

DURATION_STUDY, INDENTATION_STUDY = "fig08", "fig10_nodes"
SPRING_MASS = "spring_mass"
"""The beam model that puts a spring and a mass in the beam's place."""
_ACRONYMS = {"mjg": "MJG"}


def _contact_laws(data: Data) -> Iterator[tuple[str, str]]:
    """Yield a case and its contact law for each of the study; "any" where it is not solved."""
    laws = ["any"]
    if DURATION_STUDY in data and "contact" in data[DURATION_STUDY].dims:
        laws = [str(law) for law in data[DURATION_STUDY]["contact"].values]
    for law in laws:
        yield f"{_ACRONYMS.get(law) or law.replace('_', '-').title()} contact", law


def _judge_duration(case: str, data: Data, law: str) -> Judgement:
    curve = response_curve(data, DURATION_STUDY, "contact_duration", contact=law)
    falls = curve.high[1:] < curve.low[:-1]
    count = falls.size if falls.all() else int(np.argmin(falls))
    # at the lowest velocity, where the duration stops falling, and at the highest
    numbers = tuple(
        curve.number(at, f"contact duration at {curve.velocity[at]:g} m/s", "s")
        for at in dict.fromkeys((0, count, curve.velocity.size - 1))
    )
    case = f"{case}, {curve.velocity[0]:g} to {curve.velocity[-1]:g} m/s"
    if count == falls.size:
        why = f"It falls at every one of the {count} steps."
        return Judgement(case, numbers, Verdict.HOLDS, why)
    rises = curve.low[count + 1] > curve.high[count]
    change = "rises" if rises else "does not fall by more than its uncertainty"
    why = f"It falls up to {curve.velocity[count]:g} m/s and {change} from there to "
    why += f"{curve.velocity[count + 1]:g} m/s"
    merges = curve.value[count + 1] > 1.25 * curve.value[count]  # a second push with the first
    why += ": the sphere no longer lifts off between two pushes." if merges else "."
    outcome = Verdict.READING if 2 * count > falls.size else Verdict.FAILS
    return Judgement(case, numbers, outcome, why)


DURATION_FALLS = Statement(
    "duration_falls",
    text="The contact duration falls as the impact velocity rises.",
    test=(
        "t(v₂) + U₂ < t(v₁) − U₁ for every two neighbouring velocities v₁ < v₂; t: duration of the "
        "first contact. The statement holds under a reading where this is so over more than half "
        "of the velocities, from the lowest on."
    ),
    judge_case=_judge_duration,
    cases=_contact_laws,
    studies=(DURATION_STUDY,),
)


def _judge_spring_mass(case: str, data: Data, law: str) -> Judgement:
    if "beam_model" not in runs_of(data, DURATION_STUDY).dims:
        raise UnknownError(f"the study {DURATION_STUDY} does not vary beam_model")
    response = "contact_duration"
    ours = response_curve(data, DURATION_STUDY, response, contact=law)
    theirs = response_curve(data, DURATION_STUDY, response, contact=law, beam_model=SPRING_MASS)
    above = ours.low > theirs.high
    ratio = ours.value / theirs.value
    width = ratio * (ours.uncertainty / ours.value + theirs.uncertainty / theirs.value)
    numbers = tuple(
        Number(f"{name} model over spring-mass", float(ratio[at]), "1", float(width[at]))
        for name, at in (("smallest", int(ratio.argmin())), ("largest", int(ratio.argmax())))
    )
    if above.all():
        return Judgement(case, numbers, Verdict.HOLDS, "It is above at every velocity.")
    if not above.any():
        return Judgement(case, numbers, Verdict.FAILS, "It is above at no velocity.")
    higher, lower = (
        ", ".join(f"{velocity:g}" for velocity in ours.velocity[where]) for where in (above, ~above)
    )
    why = f"Above at {higher} m/s, not at {lower}."
    return Judgement(case, numbers, Verdict.READING, why)


ABOVE_SPRING_MASS = Statement(
    "above_spring_mass",
    text="The model's contact duration lies above the spring-mass prediction.",
    test=(
        "t(model) − U > t(spring-mass) + U at every velocity, under the same contact law; t: "
        "duration of the first contact. The statement holds under a reading where this is so at "
        "some velocities."
    ),
    judge_case=_judge_spring_mass,
    cases=_contact_laws,
    studies=(DURATION_STUDY,),
)


def _judge_indentation(case: str, data: Data) -> Judgement:
    curve = response_curve(data, INDENTATION_STUDY, "permanent_indentation")
    grows = curve.low[1:] > curve.high[:-1]
    numbers = tuple(curve.number(at, f"dent at {curve.velocity[at]:g} m/s", "m") for at in (0, -1))
    steps = [
        f"{a:g} to {b:g}"
        for a, b, up in zip(curve.velocity[:-1], curve.velocity[1:], grows, strict=True)
        if not up
    ]
    why = f"It does not from {', '.join(steps)} m/s." if steps else "It grows at every step."
    return Judgement(case, numbers, verdict(not steps), why)


DENT_GROWS = Statement(
    "dent_grows",
    text="The permanent indentation grows with the impact velocity.",
    test="d(v₂) − U₂ > d(v₁) + U₁ for every two neighbouring velocities v₁ < v₂ of the study.",
    judge_case=_judge_indentation,
    cases=(("Stronge contact, after the last contact",),),
    studies=(INDENTATION_STUDY,),
)
