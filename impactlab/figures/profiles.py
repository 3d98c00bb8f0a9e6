"""What the two figures of plastic strain share: which runs have any, and the beam's marks."""

from __future__ import annotations

import xarray as xr

from impactlab.figures import access, curves, labels
from impactlab.figures.access import design_dims, usable

STRAIN = "equivalent_plastic_strain"
LOWEST = 1e-3
"""Strains below this are not worth an axis, in %."""
PAPER_LIMIT = 0.2
"""The plastic strain that the paper compares with, in %."""


def applies(runs: xr.Dataset) -> bool:
    """Whether the study kept profiles."""
    return STRAIN in runs


def plastic(runs: xr.Dataset) -> xr.Dataset:
    """The runs without the velocities at which no run has a plastic strain; all if none has."""
    if "velocity" not in runs[STRAIN].dims:
        return runs
    some = _largest(runs) > 0
    kept = some.any([dim for dim in some.dims if dim != "velocity"])
    return runs.isel(velocity=kept.values.nonzero()[0]) if bool(kept.any()) else runs


def note(runs: xr.Dataset) -> str:
    """The choice, the velocities left out because the beam stays elastic there, what is missing."""
    parts = (
        curves.note(plastic(runs), STRAIN),
        _elastic(runs),
        access.missing_note(runs, [STRAIN]),
    )
    return " ".join(filter(None, parts))


def depth_marks(run: xr.Dataset) -> list[float]:
    """x one beam depth from mid-span, m; none where depth or span is not one number."""
    if run["beam_depth"].ndim or run["beam_span"].ndim:
        return []
    middle, depth = float(run["beam_span"]) / 2, float(run["beam_depth"])
    return [middle - depth, middle + depth]


def _elastic(runs: xr.Dataset) -> str:
    """Which velocities leave no plastic strain in any run, of those with a result."""
    largest = _largest(runs)
    if "velocity" not in largest.dims:
        return "" if bool((largest > 0).any()) else "No fibre yields in these runs."
    rest = [dim for dim in largest.dims if dim != "velocity"]
    none = (~(largest > 0)).all(rest) & largest.notnull().any(rest)
    if not bool(none.any()):
        return ""
    where = none.values.nonzero()[0].tolist()
    return f"No fibre yields at {labels.setting(runs['velocity'], where)}."


def _largest(runs: xr.Dataset) -> xr.DataArray:
    """The largest PEEQ of each run."""
    strain = usable(runs, STRAIN)
    return strain.max([dim for dim in strain.dims if dim not in design_dims(runs, strain.dims)])
