"""Contact laws side by side: force against indentation, a panel a velocity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, curves, force_indentation, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Plan, plan
from impactlab.figures.labels import display

TITLE = "Contact force against indentation under each contact law"
_FORCE, _INDENTATION = "contact_force", "indentation"
_COLUMNS = 2


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether histories were kept of several contact laws at several velocities."""
    kept = _FORCE in runs and _INDENTATION in runs
    return kept and all(runs[_FORCE].sizes.get(dim, 0) > 1 for dim in ("contact", "velocity"))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Contact force against indentation while in contact, each panel on scales of its own; the "
        "area inside a loop is the energy dissipated in the contact. "
        f"{_plan(runs).note(runs)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a contact law, broken where sphere and beam are apart."""
    selected, valid = _plan(runs), runs.assign({_FORCE: usable(runs, _FORCE)})
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    count = len(selected.panels)
    figure, axes = style.panels(count, columns=min(count, _COLUMNS), height=58)
    for ax, panel in zip(axes, selected.panels, strict=True):
        ax.set_title(f"At {panel.label}", loc="left")
        for curve in selected.curves:
            run = valid.isel(selected.runs(panel, curve))
            x, y = force_indentation.loop(run, depth, force)
            if np.isfinite(y).any():
                ax.plot(x, y, label=curve.label or "_only", **curves.look(curve))
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        if ax.lines:
            ax.set(xlim=(0.0, None), ylim=(0.0, None))
        else:
            style.remark(ax, "no finite values")
    figure.supxlabel(labels.axis("indentation", depth.symbol))
    figure.supylabel(labels.axis("contact force", force.symbol))
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _plan(runs: xr.Dataset) -> Plan:
    return plan(runs, _FORCE, panel="velocity", prefer=["contact"])
