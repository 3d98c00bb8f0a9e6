from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from impactlab.figures.labels import display


@pytest.mark.parametrize(
    ("units", "values", "shown", "symbol"),
    [
        ("N", [0.0, 52e3], 52.0, "kN"),
        ("N", [0.0, 12.0], 12.0, "N"),
        ("s", [4e-4], 0.4, "ms"),
        ("s", [5e-5], 50.0, "µs"),
        ("m", [0.78], 780.0, "mm"),
        ("m", [3e-5], 30.0, "µm"),
        ("Pa", [345e6], 345.0, "MPa"),
        ("Pa", [210e9], 210.0, "GPa"),
        ("m s-1", [5.0], 5.0, "m/s"),
        ("1", [0.4], 0.4, ""),
        ("furlong", [3.0], 3.0, "furlong"),
    ],
)
def test_value_and_symbol_agree(units: str, values: list[float], shown: float, symbol: str) -> None:
    found = display(xr.DataArray(values, attrs={"units": units}, name="quantity"))
    assert found.symbol == symbol
    assert found(values)[-1] == pytest.approx(shown)


def test_plastic_strain_is_in_percent() -> None:
    found = display(xr.DataArray([0.002], attrs={"units": "1"}, name="peak_plastic_strain"))
    assert (found.symbol, float(found(0.002))) == ("%", pytest.approx(0.2))


def test_missing_values_do_not_choose_the_unit() -> None:
    assert display(xr.DataArray([np.nan, 2e3], attrs={"units": "N"})).symbol == "kN"
    assert display(xr.DataArray([np.nan], attrs={"units": "N"})).symbol == "N"
