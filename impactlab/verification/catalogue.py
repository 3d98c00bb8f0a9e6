"""The table of checks: a new one is a new file and a line here."""

from __future__ import annotations

from typing import Protocol

from impactlab.verification import (
    balances,
    half_space,
    infinite_beam,
    modal_series,
    moment_curvature,
    observed_order,
    rigid_beam,
    rigid_plastic_mode,
    schemes,
    similarity,
    slender_limit,
    spring_mass,
    static_collapse,
    static_deflection,
    stronge_restitution,
    sub_impacts,
    time_reversal,
    timoshenko_beam,
)
from impactlab.verification.finding import Finding


class CheckFile(Protocol):
    """What a check's file offers. SOURCE: where the independent values come from."""

    TITLE: str
    SOURCE: str

    def check(self) -> Finding:
        """Run the solver and the independent solution."""
        ...


_FILES: tuple[CheckFile, ...] = (
    half_space,
    stronge_restitution,
    modal_series,
    sub_impacts,
    infinite_beam,
    observed_order,
    schemes,
    time_reversal,
    similarity,
    moment_curvature,
    static_deflection,
    static_collapse,
    rigid_plastic_mode,
    timoshenko_beam,
    slender_limit,
    spring_mass,
    rigid_beam,
    balances,
)
CATALOGUE: dict[str, CheckFile] = {
    str(vars(file)["__name__"]).rpartition(".")[2]: file for file in _FILES
}
"""Every check by name, in the order of the report."""
