"""Units as papers print them: force in kN, time in ms, lengths in mm or µm, strain in %."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

_STEPS: dict[str, tuple[tuple[float, float, str], ...]] = {
    "N": ((100.0, 1e-3, "kN"), (0.0, 1.0, "N")),
    "s": ((1e-4, 1e3, "ms"), (0.0, 1e6, "µs")),
    "m": ((1e-3, 1e3, "mm"), (0.0, 1e6, "µm")),
    "Pa": ((1e10, 1e-9, "GPa"), (0.0, 1e-6, "MPa")),
    "J": ((0.1, 1.0, "J"), (0.0, 1e3, "mJ")),
    "m s-1": ((0.0, 1.0, "m/s"),),
    "m s-2": ((0.0, 1.0, "m/s²"),),
    "m-1": ((0.0, 1.0, "1/m"),),
    "N m": ((1e3, 1e-3, "kN m"), (0.0, 1.0, "N m")),
    "kg m-3": ((0.0, 1.0, "kg/m³"),),
    "1": ((0.0, 1.0, ""),),
}
"""By `units` attribute: (smallest magnitude, factor from SI, symbol), the largest step first."""


@dataclass(frozen=True)
class Display:
    """How to show a quantity: multiply SI values by `scale` and write `symbol` ("" for numbers)."""

    scale: float
    symbol: str

    def __call__(self, values: ArrayLike) -> NDArray[np.float64]:
        """SI values in display units, the same shape."""
        return np.asarray(values, dtype=float) * self.scale


def display(array: xr.DataArray) -> Display:
    """The display unit for a variable, from its `units` attribute and its largest magnitude.

    A plastic strain is shown in %; a unit that is not in the table is shown as it is stored.
    """
    if "plastic_strain" in str(array.name):
        return Display(100.0, "%")
    units = str(array.attrs.get("units", "1"))
    largest = _largest(array.values)
    for smallest, scale, symbol in _STEPS.get(units, ((0.0, 1.0, units),)):
        if largest >= smallest:
            return Display(scale, symbol)
    return Display(1.0, units)


def _largest(values: Any) -> float:
    if values.dtype.kind not in "if":
        return 0.0
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0
