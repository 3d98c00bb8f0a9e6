"""The figure of a design: the best objective over the probability, with the designs confirmed."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import labels, style


@style.paper
def sizing(result: xr.Dataset) -> Figure:
    """Draw the front with its interval, and each design tried with that of its probability."""
    figure, (ax,) = style.panels(1, columns=1, height=62)
    unit = labels.display(result["tried_objective"])
    tried = result.isel(estimate=np.isfinite(result["tried_probability"].values))
    middle = tried["tried_probability"].values
    ends = [middle - tried["tried_low"].values, tried["tried_high"].values - middle]
    front = unit(result["front_objective"].transpose("bound", "front").values)
    if front.size:
        x = result["front"].values
        best: Any = {"color": style.COLOURS[0], "linewidth": 0}
        ax.fill_between(x, front[1], front[2], alpha=0.25, label="its interval", **best)
        ax.plot(x, front[0], color=style.COLOURS[0], label="best for a probability")
    ax.errorbar(
        middle, unit(tried["tried_objective"].values), xerr=ends, fmt="o", markersize=3.5,
        color="0.25", capsize=2, label="confirmed by runs",
    )  # fmt: skip
    chosen: Any = {"marker": "D", "linestyle": "none", "color": style.COLOURS[1], "markersize": 5}
    value = unit(result["objective"].values[0])
    ax.plot(result["probability"].values[:1], [value], label="chosen", **chosen)
    ax.axvline(float(result.attrs["wanted"]), color="0.4", linestyle=":", label="wanted at most")
    ax.set_xscale("log")
    ax.set_xlabel(labels.wrapped_axis(str(result["tried_probability"].attrs["long_name"]), ""))
    ax.set_ylabel(labels.axis(str(result["objective"].attrs["long_name"]), unit.symbol))
    style.legend(figure)
    return style.finish(figure)
