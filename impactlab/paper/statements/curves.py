"""A response against the velocity, with its uncertainty at each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impactlab.paper.statements.claim import Data, UnknownError
from impactlab.paper.statements.evidence import number, runs_of

Floats = NDArray[np.float64]
_ACRONYMS = {"mjg": "MJG"}
BEAM = "euler_bernoulli"
"""The paper's beam, among `beam_model`."""


@dataclass(frozen=True)
class Curve:
    """velocity (m/s, rising), value and uncertainty (SI): all of shape (velocities,)."""

    velocity: Floats
    value: Floats
    uncertainty: Floats

    @property
    def low(self) -> Floats:
        """The smallest values that the uncertainty allows."""
        return self.value - self.uncertainty

    @property
    def high(self) -> Floats:
        """The largest values that the uncertainty allows."""
        return self.value + self.uncertainty


def laws(data: Data, study: str) -> list[str]:
    """The contact laws of a study; just "any" where it is not solved, to be judged as such."""
    if study not in data or "contact" not in data[study].dims:
        return ["any"]
    return [str(law) for law in data[study]["contact"].values]


def named(law: str) -> str:
    """A case of a contact law, in words."""
    return f"{_ACRONYMS.get(law) or law.replace('_', '-').title()} contact"


def against_velocity(data: Data, study: str, response: str, **where: Any) -> Curve:
    """A response over the velocities of a study, on the paper's beam unless `where` says else.

    Raises UnknownError where a run or an uncertainty is missing, naming the velocity.
    """
    runs = runs_of(data, study)
    if "beam_model" in runs.dims:
        where = {"beam_model": BEAM} | where
    speeds = np.sort(runs["velocity"].values.astype(float))
    found = [_at(runs, response, float(speed), where) for speed in speeds]
    values, widths = np.array(found).T
    return Curve(speeds, values, widths)


def _at(runs: Any, response: str, speed: float, where: dict[str, Any]) -> tuple[float, float]:
    try:
        entry = number(runs, response, velocity=speed, **where)
    except UnknownError as reason:
        raise UnknownError(f"at {speed:g} m/s {reason}") from None
    if np.isnan(entry.uncertainty):
        raise UnknownError(f"at {speed:g} m/s there are fewer than three grids")
    return entry.value, entry.uncertainty
