"""Which responses the statements on convergence are tested on, and for which velocities."""

from __future__ import annotations

from collections.abc import Iterator

from impactlab.paper.statements.claim import Data

MOTION = ("peak_force", "contact_duration", "maximum_indentation", "maximum_deflection")
"""Responses that the paper's histories show."""
STRAIN = ("peak_plastic_strain", "remote_plastic_strain")
"""Responses of plastic strain, which converge in their own way or not at all."""
VELOCITIES = (0.99, 15.0)
"""Without and with yielding fibres, m/s."""


def cases(data: Data, study: str) -> Iterator[tuple[float, str, tuple[str, ...]]]:
    """(velocity, what the group is, its responses); strains only where any fibre yields."""
    for velocity in VELOCITIES:
        yield velocity, "force and motion", MOTION
        if _yields(data, study, velocity):
            yield velocity, "plastic strain (PEEQ)", STRAIN


def _yields(data: Data, study: str, velocity: float) -> bool:
    """Whether any run of the study at this velocity has a plastic strain, or none was solved."""
    if study not in data or "peak_plastic_strain" not in data[study]:
        return True
    strains = data[study]["peak_plastic_strain"]
    return bool((strains.where(strains["velocity"] == velocity) > 0).any())
