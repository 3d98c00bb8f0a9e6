"""The table of checks. A new check is a `Check` in one file and one line here."""

from __future__ import annotations

from impactlab.verification import (
    beam_limits,
    contact,
    energy,
    lumped,
    modal_series,
    observed_order,
    plasticity,
    schemes,
    static,
    sub_impacts,
    symmetry,
)
from impactlab.verification.finding import Check, Outcome

_CHECKS = (
    contact.HALF_SPACE,
    contact.STRONGE_RESTITUTION,
    contact.CONTACT_LAWS,
    modal_series.MODAL_SERIES,
    sub_impacts.SUB_IMPACTS,
    beam_limits.INFINITE_BEAM,
    observed_order.OBSERVED_ORDER,
    schemes.SCHEMES_IN_TIME,
    symmetry.TIME_REVERSAL,
    symmetry.SIMILARITY,
    plasticity.MOMENT_CURVATURE,
    static.STATIC_DEFLECTION,
    static.STATIC_COLLAPSE,
    plasticity.RIGID_PLASTIC_MODE,
    modal_series.TIMOSHENKO_BEAM,
    beam_limits.SLENDER_LIMIT,
    lumped.SPRING_MASS,
    lumped.RIGID_BEAM,
    energy.BALANCES,
)
CATALOGUE: dict[str, Check] = {check.name: check for check in _CHECKS}
"""Every check by name, in the order of the report."""


def run(name: str) -> Outcome:
    """Run a check of the catalogue."""
    return CATALOGUE[name].run()
