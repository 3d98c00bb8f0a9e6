"""Cautions about the results of a study, and notes on its physics."""

from collections.abc import Iterator
from functools import reduce
from operator import and_

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count, responses, usable
from impactlab.law_texts import OWN, law_texts
from impactlab.methods.distributions import CHOICE
from impactlab.report.distribution import regime_doubt
from impactlab.solver import FLOW_LAWS
from impactlab.solver.contact import LAWS
from impactlab.variables import MARKS, OUTSIDE_DATA, WARNINGS, of_function

_OF_THE_CONTACT = {"peak_force", "maximum_indentation", "permanent_indentation"}
_ENERGY_LIMIT = 1e-3
"""Largest energy imbalance, relative to the initial kinetic energy, of a run without suspicion."""


def cautions(runs: xr.Dataset) -> Iterator[str]:
    """Yield what holds for a study as a whole; what one response is about stands beside it."""
    if "status" in runs and "contact" in runs.coords and not of_function(runs):
        beyond = (runs["status"] & MARKS["outside_contact_law"][0]) != 0
        for law in np.unique(runs["contact"].values).tolist():
            if number := int((beyond & (runs["contact"] == law)).sum()):
                holds_for = law_texts(runs["contact"], law)["holds_for"]
                yield (
                    f"{number} of {count(runs)} runs went beyond the range of the contact law "
                    f"“{law}”, which holds for {holds_for}. Their responses are "
                    "kept, but they are extrapolated."
                )
    for name in access.varied(runs):
        levels = (
            set(runs[name].values.flat) if runs[name].attrs.get("distribution") == CHOICE else ()
        )
        for word in np.atleast_1d(runs[name].attrs["values"]) if levels else ():
            if word not in levels:
                yield (
                    f"No run draws “{word}” for the {labels.parameter(runs[name])}, so rare is it "
                    "by its weight: what it does is in none of these numbers."
                )
    for bit, text in WARNINGS.values() if "remarks" in runs else ():
        if number := int(((runs["remarks"] & bit) != 0).sum()):
            yield f"In {number} of {count(runs)} runs {text}."


def endings(runs: xr.Dataset) -> str:
    """Return how many runs failed, and how many merely lack a response; "" where none does."""
    gaps = [access.absent(runs, name) for name in responses(runs)]
    empty = reduce(and_, gaps) if gaps else access.failed(runs)
    failed, lacking = int(empty.sum()), int((access.failed(runs) & ~empty).sum())
    counts = [f"{failed:,} failed"] * bool(failed)
    counts += [f"{lacking:,} without an answer"] * bool(lacking)
    return ", ".join(counts)


def beside(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> str:
    """Return what makes the values of one response doubtful; "" where nothing does."""
    if of_function(runs):
        return regime_doubt(runs, name)
    values, verdict = usable(runs, name), access.verdict(analysis, "nodes_summary", name)
    if name == "energy_error" and (number := int((values > _ENERGY_LIMIT).sum())):
        return f"above {labels.number(_ENERGY_LIMIT)} in {labels.counted(number, 'run')}"
    if name == "restitution" and (number := int((values > 1).sum())):
        return f"above 1 in {labels.counted(number, 'run')}"
    remarks = runs["remarks"] if "remarks" in runs else np.zeros(1, int)
    outside = int(((remarks & OUTSIDE_DATA) != 0).sum())
    if outside and name in _OF_THE_CONTACT:
        return f"inputs outside the contact law's data in {labels.counted(outside, 'run')}"
    if name == "peak_plastic_strain" and not verdict and bool((values > 0).any()):
        return "depends on the number of nodes, which this study does not vary"  # nor converges
    return regime_doubt(runs, name)


_LAST_CONTACT = {"rebound_velocity", "restitution", "impulse", "permanent_indentation"}


def notes(runs: xr.Dataset) -> Iterator[str]:
    """Yield the notes on the physics that matter for these runs."""
    if of_function(runs):
        return
    used = {
        name: set(runs[name].values.flat) if name in runs.coords else set()
        for name in ("contact", "beam_flow_law", "scheme", "points", "rule")
    }
    if "contact_duration" in runs:
        yield (
            "One impact consists of several sub-impacts: contact ends and begins again. The "
            "contact duration is that of the first contact; the total contact time adds up all "
            "contacts within the simulated time."
        )
    if not _LAST_CONTACT.isdisjoint(runs.variables):
        yield (
            "Rebound velocity, restitution, impulse and permanent indentation refer to the last "
            "contact within the simulated time and do not include a later contact."
        )
    for law in sorted(used["contact"], key=lambda law: (law not in LAWS, [*LAWS, law].index(law))):
        about = law_texts(runs["contact"], law)
        if about["flaws"] or about["unconfirmed"] or about[OWN]:
            source = (
                "This comes from the law, not from the solver; the energy balance accounts for it."
            )
            parts = [
                f"Some runs use the contact law “{law}” ({about['title'] or law}).",
                f"The law is {about[OWN]}." * bool(about[OWN]),
                about["flaws"],
                source * ("energy" in about["flaws"]),
                f"The following is not confirmed: {about['unconfirmed']}."
                * bool(about["unconfirmed"]),
            ]
            yield " ".join(filter(None, parts))
    for law in sorted(used["beam_flow_law"].difference(FLOW_LAWS)):
        origin = law_texts(runs["beam_flow_law"], law)[OWN]
        yield (
            f"Some runs use the flow law “{law}” for the beam's fibres. The law is {origin}. The "
            "contact knows the yield stress alone: neither its hardening nor its rate."
        )
    if "peak_plastic_strain" in runs:
        yield (
            "In a perfectly plastic section the peak plastic strain (PEEQ) under the sphere does "
            "not converge as the nodes get closer: with 3 Lobatto points it doubles with each "
            "halving of the spacing, with 5 it still grows, and with 9 or more it grows slowly."
        )
    if "modal" in used["scheme"]:
        yield (
            "The modal scheme moves the beam in its modes and takes time steps of the "
            "time that a bar wave needs to cross one spacing. It converges to the same answers as "
            "leapfrog with far fewer nodes, except for the peak plastic strain of a perfectly "
            "plastic beam, which does not converge: do not compare it between schemes."
        )
    if used["points"] & {2, 3} and "lobatto" in used["rule"]:
        yield (
            "Few Lobatto points change the beam itself: 2 points make it 3 times too stiff, and "
            "with 3 points its full plastic moment equals the yield moment."
        )
