"""What is the same in all runs of a study, for captions that stand alone."""

from __future__ import annotations

import xarray as xr

from impactlab.figures.reading import words

_TOLD = (
    "velocity",
    "contact",
    "beam_model",
    "sphere_radius",
    "beam_span",
    "beam_width",
    "beam_depth",
    "beam_yield_stress",
    "nodes",
    "points",
    "rule",
    "scheme",
    "courant",
    "duration",
)
"""In the order of telling; the rest of the paper's case is in its tables."""


def note(runs: xr.Dataset) -> str:
    """A sentence on the parameters that one value holds for all runs, numerics included."""
    single = [name for name in _TOLD if name in runs.coords and runs[name].size == 1]
    flat = {name: runs[name].variable.values.reshape(1) for name in single}
    told = [
        words.setting(xr.DataArray(values, dims="one", name=name, attrs=runs[name].attrs), [0])
        for name, values in flat.items()
    ]
    return f"In all runs: {'; '.join(told)}." if told else ""
