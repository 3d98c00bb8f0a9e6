"""Figures as files: pictures, data, captions, style and scales."""

import csv
import json
import threading
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from impactlab.figures import catalogue, data, scales, style
from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.draw import draw_all, save
from impactlab.files import read_netcdf, replaced


@pytest.fixture
def study(velocity_study):
    runs, analysis = velocity_study
    kept = ["contact_duration", "contact_force", "status"]
    return runs[kept].isel(velocity=[0, 3, 7], time=slice(None, None, 8)), analysis


def test_writes_what_applies_with_captions_and_removes_what_no_longer_does(study, tmp_path):
    runs, analysis = study
    folder = tmp_path / "new" / "figures"
    names = ["first_contact", "force_history", "contact_duration", "parameter_effects"]
    written = draw_all(runs, analysis, folder)
    expected = [f"{name}.{kind}" for name in names for kind in ("svg", "png", "csv", "nc")]
    assert [path.name for path in written] == [*expected, "captions.json"]
    assert sorted(path.name for path in folder.iterdir()) == sorted([*expected, "captions.json"])
    captions = json.loads(written[-1].read_text("utf-8"))
    assert list(captions) == names
    assert captions["force_history"]["title"] == CATALOGUE["force_history"].title
    assert "0.25" in captions["force_history"]["caption"]
    other = folder / "mine.png"
    other.touch()
    draw_all(runs.drop_vars("contact_force"), analysis, folder)
    assert not list(folder.glob("force_history.*"))
    assert (folder / "contact_duration.svg").exists()
    assert other.exists()


def test_a_figure_that_fails_is_named_and_leaves_the_old_files(study, tmp_path, monkeypatch):
    def broken(runs, analysis):
        raise RuntimeError("no ink")

    duration = CATALOGUE["contact_duration"]
    monkeypatch.setattr(catalogue, "ANSWERS", (duration,))
    draw_all(*study, tmp_path)
    before = (tmp_path / "contact_duration.svg").read_bytes()
    monkeypatch.setattr(catalogue, "ANSWERS", (replace(duration, plot=broken),))
    with pytest.raises(RuntimeError, match="no ink") as caught:
        draw_all(*study, tmp_path)
    assert any("contact_duration of study velocity" in note for note in caught.value.__notes__)
    assert (tmp_path / "contact_duration.svg").read_bytes() == before
    assert not list(tmp_path.glob(".*"))


def test_files_are_whole_or_as_they_were(tmp_path):
    path = tmp_path / "file"
    path.write_text("old")

    def half():
        with replaced(path) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_png_has_300_dots_an_inch_and_svg_no_date(study, tmp_path):
    svg, png = save(CATALOGUE["contact_duration"].plot(*study), tmp_path, "figure")
    width = int.from_bytes(png.read_bytes()[16:20], "big")
    assert width == pytest.approx(style.SINGLE / 25.4 * 300, abs=1)
    text = svg.read_text("utf-8")
    assert "<dc:date>" not in text
    assert "<text" not in text  # paths: the same look with any fonts
    # the style does not leak
    before = dict(matplotlib.rcParams)
    CATALOGUE["contact_duration"].plot(*study)
    assert dict(matplotlib.rcParams) == before
    # the users own style does not get in
    plain = save(CATALOGUE["contact_duration"].plot(*study), tmp_path, "a")[0].read_bytes()
    with matplotlib.rc_context({"font.size": 30, "axes.facecolor": "pink", "text.color": "red"}):
        other = save(CATALOGUE["contact_duration"].plot(*study), tmp_path, "b")[0].read_bytes()
    assert other == plain


def test_the_same_data_give_the_same_bytes_in_any_thread(study, tmp_path, monkeypatch):
    shown = CATALOGUE["force_history"], CATALOGUE["contact_duration"]
    monkeypatch.setattr(catalogue, "ANSWERS", shown)
    folders = [tmp_path / str(i) for i in range(2)]
    threads = [threading.Thread(target=draw_all, args=(*study, folder)) for folder in folders]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    one, two = (sorted(folder.iterdir()) for folder in folders)
    assert len(one) == 9
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]


def made_figure():
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


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_point_that_is_drawn_and_no_guide(tmp_path):
    path, _ = data.save(made_figure(), tmp_path, "made_figure")
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
    # netcdf holds the same
    paths = data.save(made_figure(), tmp_path, "made_figure")
    stored = read_netcdf(paths[1], "figure")
    assert stored["x"].values.tolist() == [float(row["x"]) for row in rows(paths[0])]
    assert stored["points"].values.tolist() == [2, 2, 2]
    assert stored["curve_label"].values.tolist() == ["one", "", "first"]
    # a figure without curves leaves no files
    data.save(made_figure(), tmp_path, "made_figure")
    assert data.save(Figure(), tmp_path, "made_figure") == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ([1.0, 100.0], "log"),
        ([1.0, 10.0], "linear"),
        ([0.0, 100.0], "linear"),
        ([-1.0, 100.0], "linear"),
        ([np.nan, 1.0, 100.0], "log"),
        ([], "linear"),
    ],
)
def test_wide_positive_ranges_are_logarithmic(values, scale):
    axes = Figure().subplots()
    scales.fit(axes, "y", values)
    assert axes.get_yscale() == scale
    assert axes.get_xscale() == "linear"


def test_short_logarithmic_axes_still_have_labels():
    axes = Figure().subplots()
    axes.plot([1, 2], [0.24, 0.55])
    scales.logarithmic(axes, "y", [0.24, 0.55])
    axes.figure.draw_without_rendering()
    low, high = axes.get_ylim()
    shown = [
        label.get_text()
        for label, at in zip(axes.get_yticklabels(), axes.get_yticks(), strict=True)
        if low <= at <= high
    ]
    assert shown == ["0.25", "0.3", "0.4", "0.5"]


def test_titles_wrapped_to_fit_are_one_line_in_words_and_data(study, tmp_path):
    """Line breaks would end the text in the source of a page."""
    figure = CATALOGUE["force_history"].plot(*study)
    for axes in figure.axes:
        axes.set_title("a long\nname", loc="left")
    data.save(figure, tmp_path, "figure")
    with (tmp_path / "figure.csv").open(newline="") as file:
        assert {row["panel"] for row in csv.DictReader(file)} == {"a long name"}
    assert data.alt(figure).startswith("a long name: ")
    assert "\n" not in data.alt(figure)
