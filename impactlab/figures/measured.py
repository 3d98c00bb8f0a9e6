"""Measurements over curves: points with bars, from the comparison that an analysis holds."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from impactlab.analysis.measurements import COVERAGE, Agreement
from impactlab.figures.labels import Display

_LOOK: dict[str, Any] = {
    "color": "black",
    "linestyle": "",
    "marker": "D",
    "markersize": 3.0,
    "markerfacecolor": "white",
    "elinewidth": 0.8,
    "capsize": 2.0,
    "zorder": 5.0,
}


LABELS = {False: "measured", True: "another model"}
"""Words of a legend, by whether the values are simulated."""


def selected(analysis: xr.Dataset, name: str, along: str) -> xr.Dataset:
    """Return the measurements of a response that state `along`, in its order, each of them once.

    Measurements of another impact than the study's are left out.
    """
    if "compared_quantity" not in analysis:
        return xr.Dataset(coords={"comparison": []})
    quantity, verdict = (analysis[f"compared_{key}"] for key in ("quantity", "verdict"))
    own = (quantity == name) & (verdict != Agreement.OTHER_IMPACT)
    kept = analysis[[key for key in analysis if str(key).startswith("compared_")]]
    kept = kept.isel(comparison=np.flatnonzero(own.values))
    stated = [json.loads(text).get(along) for text in kept["compared_conditions"].values.tolist()]
    numbers = [value if isinstance(value, int | float) else np.nan for value in stated]
    keys = [
        (x, *(kept[f"compared_{key}"].values[at] for key in ("measured", "uncertainty", "source")))
        for at, x in enumerate(numbers)
    ]
    once = [at for at, key in enumerate(keys) if key not in keys[:at] and np.isfinite(key[0])]
    once.sort(key=numbers.__getitem__)
    return kept.isel(comparison=once).assign_coords(
        along=("comparison", [numbers[i] for i in once])
    )


def add(ax: Axes, analysis: xr.Dataset, name: str, along: str, x: Display, y: Display) -> None:
    """Draw the measurements of a response over the parameter `along`, with expanded uncertainty."""
    found = selected(analysis, name, along)
    for simulated, label in LABELS.items():
        if not found.sizes["comparison"]:
            return
        here = found.isel(comparison=found["compared_simulated"].values == simulated)
        if here.sizes["comparison"]:
            value, bar = (here[f"compared_{key}"].values for key in ("measured", "uncertainty"))
            ax.errorbar(x(here["along"].values), y(value), y(bar), label=label, **_LOOK)


def note(analysis: xr.Dataset, names: list[str], along: str) -> str:
    """Return a caption's sentence on the measurements drawn; "" without any."""
    found = [selected(analysis, name, along) for name in names]
    sources = [s for one in found if one.sizes["comparison"] for s in one["compared_source"].values]
    if not sources:
        return ""
    listed = "; ".join(dict.fromkeys(map(str, sources)))
    return f"Diamonds with expanded uncertainties (k = {COVERAGE:g}): {listed}."
