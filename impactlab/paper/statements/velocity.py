"""Statements on the first contact against the impact velocity: durations and indentations."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from operator import itemgetter

from impactlab.model.impact import paper_impact
from impactlab.paper.statements.statement import (
    Assessment,
    Data,
    Number,
    Ruling,
    UnknownError,
    judged,
    response_curve,
    runs_of,
    statement,
)
from impactlab.verification.solutions.contact_laws import stronge_impact

CONTACT_STUDY = "fig08"  # the first contact over velocities, contact laws, beam models and grids


def _contact_laws(data: Data) -> Iterator[tuple[str, str]]:
    """Yield a case and its contact law for each of the study; "any" where it is not solved."""
    laws = ["any"]
    if CONTACT_STUDY in data and "contact" in data[CONTACT_STUDY].dims:
        laws = [str(law) for law in data[CONTACT_STUDY]["contact"].values]
    for law in laws:
        name = "MJG" if law == "mjg" else law.replace("_", "-").title()
        yield f"{name} contact", law


@statement(
    text="The contact duration falls as the impact velocity rises.",
    test=(
        "t(v₂) + U₂ < t(v₁) − U₁ for every two neighbouring velocities v₁ < v₂; t: duration of the "
        "first contact. The statement holds under a reading where this is so from the lowest "
        "velocity on, but not up to the highest."
    ),
    cases=_contact_laws,
    studies=(CONTACT_STUDY,),
)
def duration_falls(data: Data, law: str) -> Assessment:
    """Judge the fall from each velocity to the next."""
    curve = response_curve(data, CONTACT_STUDY, "contact_duration", contact=law)
    speeds, durations = list(curve), list(curve.values())
    falls = [faster.high < slower.low for slower, faster in pairwise(durations)]
    count = [*falls, False].index(False)
    # at the lowest velocity, where the duration stops falling, and at the highest
    numbers = tuple(
        replace(durations[i], name=f"contact duration at {speeds[i]:g} m/s")
        for i in dict.fromkeys((0, count, len(falls)))
    )
    speed_range = f"{speeds[0]:g} to {speeds[-1]:g} m/s"
    if count == len(falls):
        why = f"It falls at every one of the {count} steps."
        return Assessment(numbers, Ruling.HOLDS, why, speed_range)
    last, after = durations[count : count + 2]
    change = "rises" if after.low > last.high else "does not fall by more than its uncertainty"
    why = f"It falls up to {speeds[count]:g} m/s and {change} from there to "
    why += f"{speeds[count + 1]:g} m/s"
    merges = after.value > 1.25 * last.value  # a second push with the first
    why += ": the sphere no longer lifts off between two pushes." if merges else "."
    outcome = Ruling.READING if count else Ruling.FAILS
    return Assessment(numbers, outcome, why, speed_range)


@statement(
    text="The model's contact duration lies above the spring-mass prediction.",
    test=(
        "t(model) − U > t(spring-mass) + U at every velocity, under the same contact law; t: "
        "duration of the first contact. The statement holds under a reading where this is so at "
        "some velocities."
    ),
    cases=_contact_laws,
    studies=(CONTACT_STUDY,),
)
def above_spring_mass(data: Data, law: str) -> Assessment:
    """Judge the durations of both models under the same contact law."""
    if "beam_model" not in runs_of(data, CONTACT_STUDY).dims:
        raise UnknownError(f"the study {CONTACT_STUDY} does not vary beam_model")
    study = CONTACT_STUDY, "contact_duration"
    ours = response_curve(data, *study, contact=law)
    theirs = response_curve(data, *study, contact=law, beam_model="spring_mass")
    higher: list[str] = []
    lower: list[str] = []
    ratios = []
    for (velocity, duration), reference in zip(ours.items(), theirs.values(), strict=True):
        (higher if duration.low > reference.high else lower).append(f"{velocity:g}")
        ratio = duration.value / reference.value
        width = ratio * (
            duration.uncertainty / duration.value + reference.uncertainty / reference.value
        )
        ratios.append((ratio, width))
    first = itemgetter(0)
    ends = {"smallest": min(ratios, key=first), "largest": max(ratios, key=first)}
    numbers = tuple(
        Number(f"{name} model over spring-mass", ratio, "1", width)
        for name, (ratio, width) in ends.items()
    )
    if not lower:
        return Assessment(numbers, Ruling.HOLDS, "It is above at every velocity.")
    if not higher:
        return Assessment(numbers, Ruling.FAILS, "It is above at no velocity.")
    why = f"Above at {', '.join(higher)} m/s, not at {', '.join(lower)}."
    return Assessment(numbers, Ruling.READING, why)


@statement(
    text="The indentation grows with the impact velocity (figure 7: the first loop).",
    test=(
        "δ(v₂) − U₂ > δ(v₁) + U₁ for every two neighbouring velocities v₁ < v₂; δ: the largest "
        "indentation of the first contact, and what Stronge's unloading leaves of it (Eq. 15)."
    ),
    cases=(
        ("largest indentation, Stronge contact", "stronge", False),
        ("indentation left, Stronge contact", "stronge", True),
        ("largest indentation, MJG contact", "mjg", False),
    ),
    studies=(CONTACT_STUDY,),
)
def indentation_grows(data: Data, law: str, left: bool) -> Assessment:
    """Judge the growth from each velocity to the next; left: of what the contact leaves."""
    curve = response_curve(data, CONTACT_STUDY, "maximum_indentation", contact=law)
    if left:
        residual = stronge_impact(paper_impact()).residual_indentation
        for velocity, deepest in curve.items():
            width = abs(residual(deepest.high) - residual(deepest.low)) / 2.0
            curve[velocity] = replace(deepest, value=residual(deepest.value), uncertainty=width)
    ends = min(curve), max(curve)
    numbers = tuple(replace(curve[end], name=f"at {end:g} m/s") for end in ends)
    steps = [
        f"{slow:g} to {fast:g}"
        for slow, fast in pairwise(curve)
        if not curve[fast].low > curve[slow].high
    ]
    shrinks = f"It does not from {', '.join(steps)} m/s."
    why = "It grows at every step."
    return judged(numbers, not steps, why, shrinks, literal=law == "stronge")


@statement(
    text="The circle of contact is small beside the beam.",
    test=(
        "a + U ≤ H/10; a = √(R (2 δ − δ_y)), Stronge's radius at the largest indentation δ; H: the "
        "beam's depth. The paper does not say how small: the tenth is a reading."
    ),
    cases=(("0.99 m/s", 0.99), ("5 m/s", 5.0), ("highest velocity", None)),
    studies=(CONTACT_STUDY,),
)
def circle_is_small(data: Data, velocity: float | None) -> Assessment:
    """Judge the radius over the depth of the beam; velocity: in m/s, None for the highest."""
    curve = response_curve(data, CONTACT_STUDY, "maximum_indentation", contact="stronge")
    velocity = max(curve) if velocity is None else velocity
    if velocity not in curve:
        raise UnknownError(f"the study {CONTACT_STUDY} has no run at {velocity:g} m/s")
    impact, deepest = paper_impact(), curve[velocity]
    first_yield = stronge_impact(impact).yield_indentation
    radii = [
        math.sqrt(impact.sphere.radius * max(2.0 * depth - first_yield, depth))
        for depth in (deepest.low, deepest.value, deepest.high)
    ]
    low, share, high = (radius / impact.beam.depth for radius in radii)
    number = Number("a/H", share, "1", 0.5 * (high - low), percent=True)
    small, large = "It is below a tenth.", "It is not below a tenth."
    return judged((number,), number.high <= 0.1, small, large, literal=False)


def _low_velocities(data: Data) -> Iterator[tuple[str, float]]:
    """Yield a case and its velocity for each up to 1 m/s; "any" where the study is not solved."""
    if CONTACT_STUDY not in data:
        yield "low velocities", 0.0
        return
    for velocity in data[CONTACT_STUDY]["velocity"].values.astype(float).tolist():
        if velocity <= 1.0:
            yield f"{velocity:g} m/s", velocity


@statement(
    text=(
        "At low velocity Hertz's contact law agrees with the measured contact durations, and so "
        "does the model of figure 8 (Stronge's)."
    ),
    test=(
        "|t(Hertz)/t(Stronge) − 1| ≤ U at velocities up to 1 m/s; t: duration of the first "
        "contact. One measured value agrees with both only where they agree with each other. The "
        "measured durations themselves are in a figure that we do not have."
    ),
    cases=_low_velocities,
    studies=(CONTACT_STUDY,),
)
def both_laws_measured(data: Data, velocity: float) -> Assessment:
    """Judge the difference between both laws' durations."""
    hertz, stronge = (
        response_curve(data, CONTACT_STUDY, "contact_duration", contact=law)[velocity]
        for law in ("hertz", "stronge")
    )
    gap = hertz.relative_to(stronge, "Hertz's duration over Stronge's, less 1")
    why = f"Both hold only if durations are measured no better than ± {50 * abs(gap.value):.0f} %."
    return judged((gap,), gap.within(0.0), "The laws agree.", why)


@statement(
    text="The model of figure 8 agrees with the measured contact durations.",
    test="|t(model)/t(measured) − 1| ≤ U of both; t: duration of the first contact.",
    cases=(("Stronge contact, velocities of figure 8",),),
    studies=(CONTACT_STUDY,),
)
def duration_measured(data: Data) -> Assessment:
    """Return our durations with what would judge them."""
    curve = response_curve(data, CONTACT_STUDY, "contact_duration", contact="stronge")
    numbers = tuple(
        replace(curve[velocity], name=f"contact duration at {velocity:g} m/s")
        for velocity in (min(curve), max(curve))
    )
    why = (
        "The measured points of figure 8, read off with their scatter, would decide; this project "
        "has the text alone."
    )
    return Assessment(numbers, Ruling.UNKNOWN, why)
