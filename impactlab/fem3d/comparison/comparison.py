"""Each response of the 3-D model beside those of the beam models."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.study.netcdf import whole
from impactlab.variables import RESPONSES, UNLIKE, attributes, reasons, status_bits

SOLID = "solid"
"""The 3-D model's name among the beam models."""
COUNTS = ("number_of_contacts",)
_NUMBER = 8
_HEAD = ("response", "units", "model", "value", "difference_percent", "missing_because")


def compared(solid: xr.Dataset, beams: xr.Dataset) -> xr.Dataset:
    """`value` and `difference` on (response, model), `status` on (model).

    value: in SI units, as `units` (response) has them; NaN where a model gives none, and `status`
    says why. difference: relative to the 3-D model's value; NaN for responses that are UNLIKE and
    for COUNTS.
    """
    names = [name for name in RESPONSES if name in solid]
    models = [SOLID, *beams["beam_model"].values.tolist()]
    value = np.array([[*_held(solid, name), *_held(beams, name)] for name in names])
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = value / value[:, :1] - 1.0
    difference[~np.isfinite(difference)] = np.nan
    difference[:, 0] = np.nan
    difference[[name in UNLIKE or name in COUNTS for name in names]] = np.nan
    status = [*np.atleast_1d(solid["status"]), *beams["status"].values]
    return xr.Dataset(
        {
            "value": (("response", "model"), value),
            "difference": (("response", "model"), difference),
            "status": ("model", np.array(status, dtype=np.int32)),
        },
        coords={
            "response": names,
            "model": models,
            "units": ("response", [attributes(name)["units"] for name in names]),
        },
    )


def _held(runs: xr.Dataset, name: str) -> list[float]:
    """A response of each run, NaN where the status says that it does not hold."""
    sound = (runs["status"] & status_bits([name])) == 0
    values: list[float] = np.atleast_1d(runs[name].where(sound).values).astype(float).tolist()
    return values


def write_csv(found: xr.Dataset, path: Path) -> None:
    """A row a response and model, in SI units; whole or not at all. Raises OSError, see whole."""
    with (
        whole(path, found["value"].size * len(_HEAD) * _NUMBER) as unfinished,
        unfinished.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_HEAD)
        for at in np.ndindex(found["value"].shape):
            writer.writerow(_row(found.isel(response=at[0], model=at[1])))


def _row(one: xr.Dataset) -> list[str]:
    value, difference = one["value"].item(), one["difference"].item()
    why = "; ".join(reasons(one["status"].item())) if np.isnan(value) else ""
    name, units, model = (str(one[key].item()) for key in ("response", "units", "model"))
    share = "" if np.isnan(difference) else f"{100.0 * difference:.6g}"
    return [name, units, model, "" if np.isnan(value) else f"{value:.9g}", share, why]
