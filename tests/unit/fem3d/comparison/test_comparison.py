"""Responses of all models side by side."""

import csv

import numpy as np
import pytest
from made_solid import RESPONSES, beam_models, solid

from impactlab.fem3d.comparison.comparison import compared
from impactlab.fem3d.comparison.run import write_csv
from impactlab.variables import STATUS_FLAGS

MODELS = ["solid", "euler_bernoulli", "timoshenko", "spring_mass"]


def test_differences_are_relative_to_the_3d_model():
    found = compared(solid(), beam_models())
    assert found["model"].values.tolist() == MODELS
    assert found["response"].values.tolist() == list(RESPONSES)
    force = found.sel(response="peak_force")
    assert force["value"].values[0] == 11e3
    own = beam_models()["peak_force"].values
    assert force["value"].values[1:].tolist() == own.tolist()
    assert force["difference"].values[1:] == pytest.approx((own - 11e3) / 11e3)
    assert np.isnan(force["difference"].values[0])
    assert force["units"].item() == "N"


@pytest.mark.parametrize("name", ["peak_plastic_strain", "number_of_contacts"])
def test_what_is_not_the_same_quantity_is_not_compared(name):
    found = compared(solid(), beam_models()).sel(response=name)
    assert np.isfinite(found["value"]).all()
    assert np.isnan(found["difference"]).all()


def test_nothing_is_compared_with_zero():
    found = compared(solid(), beam_models()).sel(response="remote_plastic_strain")
    assert (found["value"] == 0.0).all()
    assert np.isnan(found["difference"]).all()


def test_a_value_that_its_status_takes_away_is_missing():
    growing = np.int32(STATUS_FLAGS["indentation_still_growing"][0])
    found = compared(solid().assign(status=growing), beam_models())
    assert np.isnan(found["value"].sel(response="peak_force", model="solid"))
    assert found["value"].sel(response="contact_duration", model="solid") == 0.2e-3


def test_the_file_has_a_row_a_number_and_says_why_one_is_missing(tmp_path):
    found = compared(solid(), beam_models())
    write_csv(found, tmp_path / "comparison.csv")
    with (tmp_path / "comparison.csv").open(newline="") as file:
        rows = {(row["response"], row["model"]): row for row in csv.DictReader(file)}
    assert len(rows) == 4 * len(RESPONSES)
    row = rows["peak_force", "timoshenko"]
    assert float(row["value"]) == pytest.approx(found["value"].values[0, 2], rel=1e-8)
    assert float(row["difference_percent"]) == pytest.approx(100 * found["difference"].values[0, 2])
    missing = rows["maximum_deflection", "solid"]
    assert missing["value"] == missing["difference_percent"] == ""
    assert "largest deflection falls on the end" in missing["missing_because"]
