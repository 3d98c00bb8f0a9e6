"""Responses of all models side by side: in a table, in files, and on a terminal."""

import csv
from pathlib import Path

import meshio
import numpy as np
import pytest
import xarray as xr
from made_solid import RESPONSES, beam_models, solid

from impactlab.fem3d import comparison
from impactlab.fem3d.comparison import compared, print_comparison, write_csv, write_vtu
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
    # nothing is compared with zero
    found = compared(solid(), beam_models()).sel(response="remote_plastic_strain")
    assert (found["value"] == 0.0).all()
    assert np.isnan(found["difference"]).all()
    # a value that its status takes away is missing
    growing = np.int32(STATUS_FLAGS["indentation_still_growing"][0])
    found = compared(solid().assign(status=growing), beam_models())
    assert np.isnan(found["value"].sel(response="peak_force", model="solid"))
    assert found["value"].sel(response="contact_duration", model="solid") == 0.2e-3


@pytest.mark.parametrize("name", ["peak_plastic_strain", "number_of_contacts"])
def test_what_is_not_the_same_quantity_is_not_compared(name):
    found = compared(solid(), beam_models()).sel(response=name)
    assert np.isfinite(found["value"]).all()
    assert np.isnan(found["difference"]).all()


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


def test_another_program_reads_mesh_and_fields(tmp_path):
    given = solid()
    write_vtu(given, tmp_path / "witness.vtu")
    read = meshio.read(tmp_path / "witness.vtu")
    assert read.points.tolist() == given["node_position"].values.tolist()
    (cells,) = read.cells
    assert cells.type == "hexahedron"
    assert cells.data.tolist() == given["element_nodes"].values.tolist()
    for name in ("equivalent_plastic_strain", "von_mises_stress", "body", "fully_integrated"):
        (values,) = read.cell_data[name]
        assert values.ravel().tolist() == given[name].values.tolist(), name
    assert read.point_data["displacement"].tolist() == given["displacement"].values.tolist()
    assert np.ptp(read.points[:, 0]) == pytest.approx(0.39)
    assert [path.name for path in tmp_path.iterdir()] == ["witness.vtu"]


def test_a_failed_write_is_told_and_leaves_the_old_file_and_no_rubbish(tmp_path, monkeypatch):
    path = tmp_path / "witness.vtu"
    write_vtu(solid(), path)
    before = path.read_bytes()

    def full(file, *args, **fields):
        Path(f"{file}.vtu").write_text("half of i")
        raise OSError("No space left on device")

    monkeypatch.setattr(comparison, "unstructuredGridToVTK", full)
    with pytest.raises(OSError, match=r"witness\.vtu: could not be written .* are free"):
        write_vtu(solid(), path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["witness.vtu"]


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
    strains = ("sphere_plastic_strain", "one_point_plastic_strain")
    print_comparison(found, xr.Dataset(dict.fromkeys(strains, 0.0)))
    head, _, row, *_ = capsys.readouterr().out.splitlines()
    assert head.split() == ["response", "3-D", "Euler-Bernoulli", "Timoshenko", "Spring-Mass"]
    assert row.split()[2:] == ["0.06973", "0.09238", "+32%", "0.09359", "-4.2%", "0.1126", "+132%"]
