"""The table of checks. A new check is a function marked `@check` in the module of its subject."""

from impactlab.verification import (
    beam_limits,
    energy,
    local_contact,
    modal_series,
    plasticity,
    rate_dependence,
    schemes,
    symmetry,
    waveless,
)
from impactlab.verification.finding import Check

_CONTACT = waveless, local_contact
_BEAM = modal_series, beam_limits, plasticity, rate_dependence
_WHOLE = schemes, symmetry, energy
CATALOGUE: dict[str, Check] = {
    entry.name: entry
    for module in (*_CONTACT, *_BEAM, *_WHOLE)
    for entry in vars(module).values()
    if isinstance(entry, Check)
}
"""Every check by name, in the order of the report."""
