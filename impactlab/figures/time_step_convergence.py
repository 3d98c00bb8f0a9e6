"""Convergence of the responses as the time step shrinks at fixed nodes."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, labels, refinement, style

TITLE = "Convergence in the time step"
_AXIS = refinement.Refined("time_step", "courant", ("scheme", "nodes", "velocity"))


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the grid has at least three values of courant."""
    return _AXIS.applies(runs)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "The nodes of a curve stay the same: its limit is the answer of these nodes. "
        f"{refinement.CAPTION} {_AXIS.plan(runs).note(runs)} "
        f"{access.missing_note(runs, _AXIS.names(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    label = labels.axis(labels.parameter("courant"), "")
    return refinement.draw(runs, analysis, _AXIS, runs["courant"].values.astype(float), label)
