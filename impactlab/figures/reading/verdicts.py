"""Verdicts of the analysis, from their CF flags."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.figures.reading.contents import known


@dataclass(frozen=True)
class Verdict:
    """One flag. words: its name in words; sound: it needs no warning; meaning: a sentence or "".

    value: the number that stands for it.
    """

    flag: str
    sound: bool
    meaning: str = ""
    value: int = -1

    @property
    def words(self) -> str:
        """The flag's name as text."""
        return self.flag.replace("_", " ")


def verdict(analysis: xr.Dataset, variable: str, response: str) -> Verdict | None:
    """A response's verdict; None where the analysis gives none.

    variable: one on `response` alone, with CF flag_values and flag_meanings, and with
    sound_flags and flag_descriptions ("flag: sentence", a line each).
    """
    if variable not in analysis or not known(analysis, response):
        return None
    return _read(analysis[variable], int(analysis[variable].sel(response=response)))


def occurring(flags: xr.DataArray) -> list[Verdict]:
    """Every flag that occurs in a variable of CF flags, by rising value."""
    return [_read(flags, int(value)) for value in np.unique(flags.values)]


def _read(array: xr.DataArray, value: int) -> Verdict:
    names = dict(zip(_integers(array), str(array.attrs["flag_meanings"]).split(), strict=True))
    flag = names.get(value, "unknown")
    sound = str(array.attrs.get("sound_flags", "converged usable")).split()
    return Verdict(flag, flag in sound, _descriptions(array).get(flag, ""), value)


def confidence(analysis: xr.Dataset) -> str:
    """Of the intervals of the indices, as text: "95 %"."""
    found = (
        array.attrs["confidence"]
        for name, array in analysis.data_vars.items()
        if str(name).endswith("_interval") and "confidence" in array.attrs
    )
    level = next(found, analysis.attrs.get("confidence", 0.95))
    return f"{100 * float(level):.4g} %"


def _integers(array: xr.DataArray) -> list[int]:
    return [int(flag) for flag in np.atleast_1d(array.attrs["flag_values"])]


def _descriptions(array: xr.DataArray) -> dict[str, str]:
    lines = str(array.attrs.get("flag_descriptions", "")).splitlines()
    return {line.partition(": ")[0]: line.partition(": ")[2] for line in lines}
