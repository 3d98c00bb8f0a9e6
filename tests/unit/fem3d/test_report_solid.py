"""The 3-D model's answers beside those of the beam models, on a terminal."""

from __future__ import annotations

import numpy as np
import pytest
import witnesses
import xarray as xr

from impactlab.fem3d.comparison.terminal import print_comparison
from impactlab.fem3d.study.report import sections

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


def test_effects_have_their_uncertainty_in_per_cent():
    """Planted: each answer is uncertain by 1.25 % / 1.01; an effect by the sum of its answers."""
    (section,) = sections(*witnesses.taken_apart())
    force = [row[1].text for row in section.tables[0].rows]
    assert force == ["−6.7 % ± 2.3 %", "+2 % ± 2.5 %", "−11 % ± 4.4 %", "−15 % ± 2.1 %"]
