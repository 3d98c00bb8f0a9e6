"""Which runs are missing from an answer, and why: a gap is always counted and explained."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import xarray as xr

from impactlab.figures.reading import words
from impactlab.figures.reading.contents import SAMPLED, count, responses, usable
from impactlab.variables import FAILED, reasons

UNEXPLAINED = "no reason is recorded"


def absent(array: xr.DataArray) -> xr.DataArray:
    """True for each run (design dimensions) in which the variable has no finite value."""
    within = [dim for dim in array.dims if dim in SAMPLED]
    present = xr.apply_ufunc(np.isfinite, array)
    return xr.DataArray(~present.any(within))


def failed(runs: xr.Dataset) -> xr.DataArray:
    """True for each run whose status says that it failed, or that misses a response.

    Returns bool on the design dimensions.
    """
    marks = [absent(usable(runs, name)) for name in responses(runs)]
    if "status" in runs:
        marks.append((runs["status"] & FAILED) != 0)
    if not marks:
        return xr.DataArray(False)
    return xr.concat(marks, "mark", coords="minimal", compat="override").any("mark")


def causes(runs: xr.Dataset, mask: xr.DataArray) -> Counter[str]:
    """How many of the marked runs there are, by reason; mask: bool on the design dimensions."""
    if "status" not in runs:
        return Counter({UNEXPLAINED: int(mask.sum())}) if bool(mask.any()) else Counter()
    status, chosen = xr.broadcast(runs["status"], mask)
    bits, counts = np.unique(status.values[chosen.values], return_counts=True)
    found: Counter[str] = Counter()
    for bit, number in zip(bits.tolist(), counts.tolist(), strict=True):
        found["; ".join(reasons(int(bit))) or UNEXPLAINED] += number
    return found


def note(runs: xr.Dataset, variables: Sequence[str]) -> str:
    """A caption's sentence on the runs that lack one of the variables; "" when none does."""
    held = [absent(usable(runs, name)) for name in variables if name in runs]
    mask = xr.concat(held, "variable").any("variable") if held else xr.DataArray(False)
    if not bool(mask.any()):
        return ""
    found = [f"{number} × “{why}”" for why, number in causes(runs, mask).items()]
    total = int(mask.sum())
    verb = "is" if total == 1 else "are"
    where = "here" if len(held) == 1 else "in one panel or more"
    return f"{total} of {count(runs)} runs {verb} missing {where}: {words.listing(found)}."
