"""The permanent indentation grows with the velocity."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements.claim import Data, Judgement, Number, attempt, holds
from impactlab.paper.statements.curves import against_velocity

SAYS = "The permanent indentation grows with the impact velocity."
TEST = "d(v₂) − U₂ > d(v₁) + U₁ for every two neighbouring velocities v₁ < v₂ of the study."
STUDY = "fig10_nodes"
_CASE = "Stronge contact, after the last contact"


def judge(data: Data) -> Iterable[Judgement]:
    """One judgement."""
    return [attempt(_CASE, lambda: _judged(data))]


def _judged(data: Data) -> Judgement:
    curve = against_velocity(data, STUDY, "permanent_indentation")
    grows = curve.low[1:] > curve.high[:-1]
    numbers = tuple(
        Number(
            f"dent at {curve.velocity[at]:g} m/s",
            float(curve.value[at]),
            "m",
            float(curve.uncertainty[at]),
        )
        for at in (0, -1)
    )
    steps = [
        f"{a:g} to {b:g}"
        for a, b, up in zip(curve.velocity[:-1], curve.velocity[1:], grows, strict=True)
        if not up
    ]
    why = f"It does not from {', '.join(steps)} m/s." if steps else "It grows at every step."
    return Judgement(_CASE, numbers, holds(bool(grows.all())), why)
