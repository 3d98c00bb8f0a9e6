"""Cautions about the results of a study, and notes on its physics."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count, responses, usable
from impactlab.report.indices import numerical_warnings
from impactlab.solver.contact import CONTACT_LAWS, LAWS
from impactlab.variables import MARKS, WARNINGS

_UNCONVERGED = "Somewhere in the grid, these responses have not converged in {}"
_JUDGED = {
    "nodes_summary": _UNCONVERGED.format("nodes"),
    "time_step_summary": _UNCONVERGED.format("the time step"),
    "element_size_summary": _UNCONVERGED.format("the element size"),
    "points_summary": _UNCONVERGED.format("integration points"),
    "sensitivity_verdict": (
        "The sensitivity indices of these responses are not usable as they stand"
    ),
}
_ENERGY_LIMIT = 1e-3
"""Largest energy imbalance, relative to the initial kinetic energy, of a run without suspicion."""


def cautions(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return sentences, the gravest first; none when there is nothing to warn of."""
    return [
        *_failures(runs, analysis),
        *_verdicts(runs, analysis),
        *_reliance(runs, analysis),
        *_values(runs),
    ]


def _failures(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """Yield sentences on an analysis of other runs, failed runs, and laws beyond their range."""
    solved = runs.attrs.get("created")
    if analysis.attrs.get("created", solved) != solved:
        yield (
            "The analysis does not belong to these runs: it was made from runs that were solved at "
            "another time. The verdicts and indices below may be wrong; repeat the analysis "
            "(impactlab analyse)."
        )
    if failed := int(access.failed(runs).sum()):
        yield (
            f"{failed} of {count(runs)} runs failed: each lacks at least one response and is left "
            "out of the figures and tables of that response. The failed runs are listed below with "
            "the reason."
        )
    if "status" not in runs or "contact" not in runs.coords:
        return
    beyond = (runs["status"] & MARKS["outside_contact_law"][0]) != 0
    for law in np.unique(runs["contact"].values).tolist():
        if number := int((beyond & (runs["contact"] == law)).sum()):
            yield (
                f"{number} of {count(runs)} runs went beyond the range of the contact law "
                f"“{law}”, which holds for {CONTACT_LAWS[law].holds}. Their responses are kept, "
                "but they are extrapolated."
            )


def _verdicts(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """Yield one sentence per kind of verdict and flag, with the responses that it is about."""
    for variable, text in _JUDGED.items():
        flags: dict[str, list[str]] = defaultdict(list)
        for name in responses(runs):
            verdict = access.verdict(analysis, variable, name)
            if verdict and not verdict.sound:
                meaning = f": {verdict.meaning}" if verdict.meaning else ""
                flags[f"{verdict.words}{meaning}"].append(labels.response(name))
        for flag, names in flags.items():
            yield f"{text}: {labels.listing(names)} ({flag})."


def _reliance(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """Yield sentences on numbers that rest on a surrogate or on the discretisation."""
    if "imputed_share" in analysis and bool((analysis["imputed_share"] > 0).any()):
        worst = labels.percent(float(analysis["imputed_share"].max()))
        yield (
            "A surrogate fitted to the successful runs supplied the values of failed runs, up to "
            f"{worst} of the runs per response; the indices of these responses depend on it."
        )
    if number := len(numerical_warnings(runs, analysis)):
        yield (
            "Some indices are smaller than the change that the numerical error could cause; see "
            f"“Numerical uncertainty” ({labels.counted(number, 'warning')})."
        )
    strain = "peak_plastic_strain"
    if strain not in runs or access.verdict(analysis, "nodes_summary", strain):
        return
    if bool((usable(runs, strain) > 0).any()):  # hardening does not make it converge
        yield (
            "The peak plastic strain depends on the number of nodes, which this study does not "
            "vary: compare it between runs, but do not treat it as a converged value."
        )


def _values(runs: xr.Dataset) -> Iterator[str]:
    """Yield sentences on numbers that physics or numerics should not give, and on remarks."""
    if "energy_error" in runs:
        error = usable(runs, "energy_error")
        if number := int((error > _ENERGY_LIMIT).sum()):
            worst = labels.number(float(np.nanmax(error.values)), digits=2)
            yield (
                f"The energy balance is off by more than {labels.number(_ENERGY_LIMIT)} of the "
                f"initial kinetic energy in {number} of {count(runs)} runs (largest: {worst})."
            )
    if "restitution" in runs and (number := int((usable(runs, "restitution") > 1).sum())):
        yield f"The coefficient of restitution is above 1 in {number} of {count(runs)} runs."
    for bit, text in WARNINGS.values() if "remarks" in runs else ():
        if number := int(((runs["remarks"] & bit) != 0).sum()):
            yield f"In {number} of {count(runs)} runs {text}."


def notes(runs: xr.Dataset) -> list[str]:
    """Return the texts that matter for these runs, in the order of NOTES."""
    return [text for applies, text in NOTES if applies(runs)]


def _holds(runs: xr.Dataset, name: str, values: list[Any]) -> bool:
    """Return whether a parameter has one of these values in some run."""
    return name in runs.coords and bool(runs[name].isin(values).any())


def _about(law: str) -> str:
    """Return the flaws of a contact law and what about it is unconfirmed."""
    about = CONTACT_LAWS[law]
    parts = [f"Some runs use the contact law “{law}” ({about.title}).", about.flaws]
    if "energy" in about.flaws:
        parts.append(
            "This comes from the law, not from the solver; the energy balance accounts for it."
        )
    if about.unconfirmed:
        parts.append(f"The following is not confirmed: {about.unconfirmed}.")
    return " ".join(filter(None, parts))


_AT_THE_END = ("rebound_velocity", "restitution", "impulse", "permanent_indentation")
NOTES: tuple[tuple[Callable[[xr.Dataset], bool], str], ...] = (
    (
        lambda runs: "contact_duration" in runs,
        "One impact consists of several sub-impacts: contact ends and begins again. The contact "
        "duration is that of the first contact; the total contact time adds up all contacts within "
        "the simulated time.",
    ),
    (
        lambda runs: any(name in runs for name in _AT_THE_END),
        "Rebound velocity, restitution, impulse and permanent indentation refer to the last "
        "contact within the simulated time and do not include a later contact.",
    ),
    *(
        (partial(_holds, name="contact", values=[law]), _about(law))
        for law in LAWS
        if CONTACT_LAWS[law].flaws or CONTACT_LAWS[law].unconfirmed
    ),
    (
        lambda runs: "peak_plastic_strain" in runs,
        "In a perfectly plastic section the peak plastic strain (PEEQ) at mid-span does not "
        "converge as the nodes get closer: with 3 Lobatto points it doubles with each halving of "
        "the spacing, with 5 it still grows, and with 9 or more it grows slowly.",
    ),
    (
        lambda runs: _holds(runs, "scheme", ["semi_implicit"]),
        "The semi-implicit scheme takes time steps of half the time that a bar wave needs to cross "
        "one spacing: with many nodes they are longer than those of leapfrog, with few they are "
        "shorter. It converges to the same answers, with errors of about the same size for the "
        "same nodes. Do not compare the peak plastic strain of a perfectly plastic beam between "
        "the two schemes, because it does not converge.",
    ),
    (
        lambda runs: _holds(runs, "points", [2, 3]) and _holds(runs, "rule", ["lobatto"]),
        "Few Lobatto points change the beam itself: 2 points make it 3 times too stiff, and "
        "with 3 points its full plastic moment equals the yield moment.",
    ),
)
"""Every note: a test whether it matters for given runs, and its text."""
