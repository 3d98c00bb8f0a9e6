"""The model lies above the prediction of a spring and a mass in the beam's place."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements.claim import Data, Judgement, Number, UnknownError, Verdict, attempt
from impactlab.paper.statements.curves import Floats, against_velocity, laws, named
from impactlab.paper.statements.evidence import runs_of

SAYS = "The model's contact duration lies above the spring-mass prediction."
TEST = (
    "t(model) − U > t(spring-mass) + U at every velocity, under the same contact law; t: duration "
    "of the first contact. Holds under a reading where that is so at some velocities."
)
STUDY = "fig08"
SPRING_MASS = "spring_mass"


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each contact law of the study."""
    for law in laws(data, STUDY):
        yield attempt(named(law), lambda law=law: _judged(law, data))  # type: ignore[misc]


def _judged(law: str, data: Data) -> Judgement:
    if "beam_model" not in runs_of(data, STUDY).dims:
        raise UnknownError(f"the study {STUDY} does not vary beam_model")
    ours = against_velocity(data, STUDY, "contact_duration", contact=law)
    theirs = against_velocity(data, STUDY, "contact_duration", contact=law, beam_model=SPRING_MASS)
    above = ours.low > theirs.high
    ratio = ours.value / theirs.value
    width = ratio * (ours.uncertainty / ours.value + theirs.uncertainty / theirs.value)
    numbers = tuple(
        Number(f"{name} model over spring-mass", float(ratio[at]), "1", float(width[at]))
        for name, at in (("smallest", int(ratio.argmin())), ("largest", int(ratio.argmax())))
    )
    if above.all():
        return Judgement(named(law), numbers, Verdict.HOLDS, "It is above at every velocity.")
    if not above.any():
        return Judgement(named(law), numbers, Verdict.FAILS, "It is above at no velocity.")
    why = f"Above at {_listed(ours.velocity[above])} m/s, not at {_listed(ours.velocity[~above])}."
    return Judgement(named(law), numbers, Verdict.READING, why)


def _listed(velocities: Floats) -> str:
    return ", ".join(f"{velocity:g}" for velocity in velocities)
