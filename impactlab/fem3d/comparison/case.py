"""The one impact that a witness is asked about."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import Value, flatten, with_values
from impactlab.study.declaration import Study

_LONGEST = 5e-3
"""Simulated time of the paper's case in s, within which its first contact ends at any velocity."""


@dataclass(frozen=True)
class Case:
    """name: of the study. file: where it stands. discretisation: of the beam models.

    longest: simulated time of the study in s. held: what the study varies, which one value stands
    for here, by name.
    """

    name: str
    file: str
    impact: Impact
    discretisation: Discretisation
    longest: float
    held: dict[str, Value] = field(default_factory=dict)

    def with_impact(self, velocity: float | None, contact: str | None) -> Case:
        """The case with another velocity (m/s) or contact law. Raises ValueError as Impact does."""
        changed = {"velocity": velocity, "contact": contact}
        given = {name: value for name, value in changed.items() if value is not None}
        held = {name: value for name, value in self.held.items() if name not in given}
        return replace(self, impact=_replaced(self.impact, given), held=held)


def paper_case() -> Case:
    """The paper's own case, for the beam models with the nodes that it takes."""
    grid = Discretisation(nodes=601)
    return Case("paper", "the paper's case", paper_impact(), grid, _LONGEST)


def case_of(study: Study) -> Case:
    """A study's base with its fixed values; of what it varies, the base has one value each."""
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    values = flatten(*base) | {"sphere_mass": base[0].sphere.total_mass}
    held = {name: values[name] for name in study.sampling.varied if name in values}
    return Case(study.name, str(study.path), *base, study.duration, held)


def _replaced(impact: Impact, values: dict[str, float | str]) -> Impact:
    changed: Impact = replace(impact, **values)  # type: ignore[arg-type]
    return changed
