"""Equivalent plastic strain over the depth at mid-span."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import curves, labels, profiles, scales, style
from impactlab.figures.labels import display
from impactlab.figures.profiles import LOWEST, STRAIN

TITLE = "Equivalent plastic strain over the depth"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept profiles."""
    return profiles.applies(runs)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Equivalent plastic strain (PEEQ) over the depth in the section that it is largest in, at "
        f"the end of the run; a marker is an integration point; "
        f"zeros have no place on the logarithmic axis. {profiles.note(runs)}"
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a run, the depth downwards as in the beam."""
    kept = profiles.plastic(runs)
    strain, depth = display(kept[STRAIN]), display(kept["z"])

    def line(run: xr.Dataset) -> curves.Points:
        section = run[STRAIN].isel(x=int(np.argmax(run[STRAIN].max("z").fillna(-1.0).values)))
        return scales.positive(strain(section)), depth(section["z"])

    figure, axes = curves.draw(kept, STRAIN, line, markers=True)
    curves.label(
        axes,
        labels.axis("PEEQ", strain.symbol),
        labels.axis("distance below the axis", depth.symbol),
    )
    for ax in axes:
        values = [value for line in ax.lines for value in np.asarray(line.get_xdata())]
        if np.isfinite(values).any():
            limits = LOWEST, 2.0 * float(np.nanmax(values))
            scales.logarithmic(ax, "x", limits)
            ax.set_xlim(limits)
        elif ax.lines:
            style.remark(ax, "no plastic strain")
        scales.linear(ax, "y")
    axes[0].set_ylim(*sorted(axes[0].get_ylim(), reverse=True))
    return curves.finish(figure, kept, STRAIN)
