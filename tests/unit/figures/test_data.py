from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import data, style


def figure() -> Figure:
    fig, (left, right) = style.panels(2, columns=2, height=50)
    left.set_title("Curves", loc="left")
    left.set(xlabel="Time (ms)", ylabel="Force (kN)")
    left.plot([0.0, 1.0, 2.0], [1.0, np.nan, 3.0], label="one")
    left.plot([0.0, 1.0], [5.0, 6.0], label="_only")
    left.axhline(0.2, label="_guide")
    right.set_title("Bars", loc="left")
    right.set_xlabel("Share (–)")
    right.barh([0.0, 1.0], [0.5, -0.25], label="first")
    return fig


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_point_that_is_drawn_and_no_guide(tmp_path: Path) -> None:
    path, _ = data.save(figure(), tmp_path, "figure")
    found = rows(path)
    curve = [row for row in found if row["curve"] == "one"]
    assert [(row["x"], row["y"]) for row in curve] == [("0", "1"), ("2", "3")]
    assert {row["panel"] for row in curve} == {"Curves"}
    assert curve[0]["x_label"] == "Time (ms)"
    assert curve[0]["y_label"] == "Force (kN)"
    assert [(r["x"], r["y"]) for r in found if r["curve"] == "" and r["panel"] == "Curves"] == [
        ("0", "5"),
        ("1", "6"),
    ]
    assert [(float(r["x"]), float(r["y"])) for r in found if r["panel"] == "Bars"] == [
        (0.5, 0.0),
        (-0.25, 1.0),
    ]
    assert len(found) == 6


def test_netcdf_holds_the_same(tmp_path: Path) -> None:
    paths = data.save(figure(), tmp_path, "figure")
    stored = xr.load_dataset(paths[1])
    assert stored["x"].values.tolist() == [float(row["x"]) for row in rows(paths[0])]
    assert stored["points"].values.tolist() == [2, 2, 2]
    assert stored["curve_label"].values.tolist() == ["one", "", "first"]


def test_a_figure_without_curves_leaves_no_files(tmp_path: Path) -> None:
    data.save(figure(), tmp_path, "figure")
    assert data.save(Figure(), tmp_path, "figure") == []
    assert list(tmp_path.iterdir()) == []


def test_bars_upwards(tmp_path: Path) -> None:
    fig, (ax,) = style.panels(1, columns=1, height=50)
    ax.hist([0.5, 1.5, 1.6], bins=[0.0, 1.0, 2.0])
    (drawn,) = data.drawn(fig)
    assert drawn.x.tolist() == [0.5, 1.5]
    assert drawn.y.tolist() == pytest.approx([1.0, 2.0])
