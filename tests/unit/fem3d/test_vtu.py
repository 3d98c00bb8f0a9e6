"""A mesh with its fields as others read it: meshio, which did not write it."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from made_solid import solid

from impactlab.fem3d.comparison import run
from impactlab.fem3d.comparison.run import write_vtu


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

    monkeypatch.setattr(run, "unstructuredGridToVTK", full)
    with pytest.raises(OSError, match=r"witness\.vtu: could not be written .* are free"):
        write_vtu(solid(), path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["witness.vtu"]
