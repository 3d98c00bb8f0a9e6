"""The 3-D model's answers beside those of the beam models, on a terminal."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from impactlab.fem3d.comparison.terminal import print_comparison

MODELS = ["solid", "euler_bernoulli", "timoshenko", "spring_mass"]


@pytest.fixture
def found():
    """A response with five digits in every model, and differences above and below a tenth."""
    values = np.array([[69.73e-6, 92.38e-6, 93.59e-6, 0.1126e-3]])
    return xr.Dataset(
        {
            "value": (("response", "model"), values),
            "difference": (("response", "model"), [[np.nan, 0.3249, -0.0421, 1.321]]),
            "units": ("response", ["s"]),
            "status": ("model", np.zeros(4, int)),
        },
        coords={"response": ["time_of_peak_force"], "model": MODELS},
    )


def test_the_table_fits_a_terminal(found, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    print_comparison(found)
    head, _, row, *_ = capsys.readouterr().out.splitlines()
    assert head.split() == ["response", "3-D", "Euler-Bernoulli", "Timoshenko", "Spring-Mass"]
    assert row.split()[2:] == ["0.06973", "0.09238", "+32%", "0.09359", "-4.2%", "0.1126", "+132%"]
