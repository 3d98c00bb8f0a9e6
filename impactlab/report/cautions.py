"""What to know before using the numbers: failures, unsound verdicts, suspicious values."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count, responses, usable
from impactlab.report import numerical
from impactlab.solver.contact.about import ABOUT
from impactlab.variables import MARKS, REMARKS

_JUDGED = {
    "nodes_summary": "Not converged in nodes somewhere in the grid",
    "time_step_summary": "Not converged in the time step somewhere in the grid",
    "element_size_summary": "Not converged in the element size somewhere in the grid",
    "points_summary": "Not converged in integration points somewhere in the grid",
    "sensitivity_verdict": "Sensitivity indices not usable as they stand",
}
ENERGY_LIMIT = 1e-3
"""Energy imbalance, relative to the initial kinetic energy, from which on a run is suspicious."""


def cautions(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Sentences, the gravest first; none when there is nothing to warn of."""
    found = (
        _stale(runs, analysis),
        _failures(runs),
        _outside(runs),
        _verdicts(runs, analysis),
        _imputed(runs, analysis),
        _numerical(runs, analysis),
        _strain(runs, analysis),
        _values(runs),
        _remarks(runs),
    )
    return [sentence for sentences in found for sentence in sentences]


def _stale(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """An analysis carries the attributes of its runs, the time of solving among them."""
    if analysis.attrs.get("created", runs.attrs.get("created")) != runs.attrs.get("created"):
        yield (
            "The analysis is not of these runs: it was made from runs solved at another time. "
            "Verdicts and indices here may be wrong; make the analysis again (impactlab analyse)."
        )


def _failures(runs: xr.Dataset) -> Iterator[str]:
    if failed := int(access.failed(runs).sum()):
        yield (
            f"{failed} of {count(runs)} runs failed: they miss at least one response, and are left "
            "out of figures and tables of what they miss. They are listed below with the reason."
        )


def _outside(runs: xr.Dataset) -> Iterator[str]:
    """One sentence for each contact law that was taken beyond its range."""
    if "status" not in runs or "contact" not in runs.coords:
        return
    beyond = (runs["status"] & MARKS["outside_contact_law"][0]) != 0
    for law in np.unique(runs["contact"].values).tolist():
        if number := int((beyond & (runs["contact"] == law)).sum()):
            yield (
                f"{number} of {count(runs)} runs went beyond the range of the contact law “{law}”: "
                f"it holds for {ABOUT[law].holds}. Their responses are kept, but extrapolated."
            )


def _verdicts(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """One sentence for each kind of verdict and flag, with the responses that it is about."""
    for variable, text in _JUDGED.items():
        flags: dict[str, list[str]] = defaultdict(list)
        for name in responses(runs):
            verdict = access.verdict(analysis, variable, name)
            if verdict and not verdict.sound:
                meaning = f": {verdict.meaning}" if verdict.meaning else ""
                flags[f"{verdict.words}{meaning}"].append(labels.response(name))
        for flag, names in flags.items():
            yield f"{text} — {labels.listing(names)} ({flag})."


def _imputed(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """A surrogate in the place of failed runs."""
    if "imputed_share" in analysis and bool((analysis["imputed_share"] > 0).any()):
        worst = labels.number(100 * float(analysis["imputed_share"].max()), 2)
        yield (
            f"Values of failed runs, up to {worst} % of the runs of a response, come from a "
            "surrogate fitted to the good ones: the indices rest on it there."
        )


def _numerical(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """Indices that the discretisation could have made."""
    if number := len(numerical.warnings(runs, analysis)):
        yield (
            "Some indices are below what the numerical error could change, see “Numerical "
            f"uncertainty” ({labels.counted(number, 'warning')} there)."
        )


def _strain(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """PEEQ without a verdict of its own, which it needs with hardening, too."""
    name = "peak_plastic_strain"
    if name not in runs or access.verdict(analysis, "nodes_summary", name):
        return
    if bool((usable(runs, name) > 0).any()):
        yield (
            "The peak plastic strain depends on the number of nodes, and this study does not vary "
            "them: compare it between runs, but do not take it for a converged value."
        )


def _values(runs: xr.Dataset) -> Iterator[str]:
    """Numbers that physics or numerics should not give."""
    if "energy_error" in runs:
        error = usable(runs, "energy_error")
        if number := int((error > ENERGY_LIMIT).sum()):
            worst = labels.number(float(np.nanmax(error.values)), digits=2)
            yield (
                f"The energy balance is off by more than {labels.number(ENERGY_LIMIT)} of the "
                f"initial kinetic energy in {number} of {count(runs)} runs (largest: {worst})."
            )
    if "restitution" in runs and (number := int((usable(runs, "restitution") > 1).sum())):
        yield f"The coefficient of restitution is above 1 in {number} of {count(runs)} runs."


def _remarks(runs: xr.Dataset) -> Iterator[str]:
    """What the runs say of themselves."""
    if "remarks" not in runs:
        return
    for bit, text in REMARKS.values():
        if number := int(((runs["remarks"] & bit) != 0).sum()):
            yield f"In {number} of {count(runs)} runs {text}."
