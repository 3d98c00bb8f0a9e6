"""The table of checks: a new one is a new file and a line here."""

from __future__ import annotations

from typing import Protocol

from impactlab.verification import (
    contact_laws,
    half_space,
    infinite_beam,
    modal_series,
    observed_order,
    similarity,
    stronge_restitution,
    sub_impacts,
    time_reversal,
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
    contact_laws,
    modal_series,
    sub_impacts,
    infinite_beam,
    observed_order,
    time_reversal,
    similarity,
)
CATALOGUE: dict[str, CheckFile] = {
    str(vars(file)["__name__"]).rpartition(".")[2]: file for file in _FILES
}
"""Every check by name, in the order of the report."""
