"""Contact force against indentation."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.labels import Display, display

TITLE = "Contact force against indentation"
_FORCE, _INDENTATION = "contact_force", "indentation"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept histories."""
    return _FORCE in runs and _INDENTATION in runs


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Contact force against indentation while in contact; each sub-impact is a loop of its "
        "own, and the area inside is the energy dissipated in the contact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a run, broken where sphere and beam are apart."""
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])

    def line(run: xr.Dataset) -> curves.Points:
        return loop(run, depth, force)

    figure, axes = curves.draw(runs, _FORCE, line)
    curves.label(
        axes, labels.axis("indentation", depth.symbol), labels.axis("contact force", force.symbol)
    )
    for ax in axes:
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        ax.set(xlim=(0.0, None), ylim=(0.0, None))
    return curves.finish(figure, runs, _FORCE)


def loop(run: xr.Dataset, depth: Display, force: Display) -> curves.Points:
    """Indentation and force of one run in display units, NaN where the two are apart."""
    values = run[_FORCE].values
    apart = ~_touching(values)
    return depth(run[_INDENTATION].where(~apart)), force(np.where(apart, np.nan, values))


def _touching(force: NDArray[np.float64]) -> NDArray[np.bool_]:
    """True in contact and one sample to either side, so that loops reach the axis."""
    inside = force > 0
    before, after = np.roll(inside, -1), np.roll(inside, 1)
    before[-1] = after[0] = False
    return inside | before | after
