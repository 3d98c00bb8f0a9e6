"""The table of checks. A new check is a function marked `@check` and one line here."""

from __future__ import annotations

from impactlab.verification import (
    beam_limits,
    contact,
    energy,
    local_contact,
    modal_series,
    plasticity,
    schemes,
    strain_rate,
    symmetry,
)
from impactlab.verification.finding import Check

_CHECKS = (
    contact.half_space,
    contact.stronge_restitution,
    contact.contact_laws,
    modal_series.modal_series,
    modal_series.sub_impacts,
    beam_limits.infinite_beam,
    schemes.observed_order,
    schemes.schemes,
    symmetry.time_reversal,
    symmetry.similarity,
    plasticity.moment_curvature,
    plasticity.static_deflection,
    plasticity.static_collapse,
    plasticity.rigid_plastic_mode,
    plasticity.fibre_elements,
    modal_series.timoshenko_beam,
    beam_limits.slender_limit,
    contact.spring_mass,
    contact.rigid_beam,
    local_contact.contact_patch,
    strain_rate.strain_rate,
    local_contact.contact_compliance,
    local_contact.strip,
    local_contact.contact_prestress,
    energy.balances,
)
CATALOGUE: dict[str, Check] = {check.name: check for check in _CHECKS}
"""Every check by name, in the order of the report."""
