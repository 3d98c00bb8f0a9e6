"""Moving pictures of one impact."""

import base64
import html
import json
import re
import shutil
from importlib.util import find_spec
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

import impactlab as il
from impactlab.cli.results import _selected
from impactlab.figures import animation as animations
from impactlab.figures.animation import with_fields
from impactlab.variables import FIELDS, RESPONSES

GRID = il.Discretisation(nodes=41, points=7)
IMPACT = il.paper_impact(15.0)


@pytest.fixture(scope="module")
def run():
    return il.simulate(IMPACT, GRID, duration="6 ms", frames=12)


@pytest.fixture(scope="module")
def moving(run):
    return il.plot.animate(run)


@pytest.fixture(scope="module")
def drawn(moving):
    """The figure without what moves, and all frames."""
    return list(moving._drawn())


def test_frames_show_the_fields_of_the_run(run, moving, drawn):
    assert len(drawn) == 1 + moving.frames == 13
    beam, zone, contact, _ = moving._figure.axes
    (line, *_, ball), (guide, marker) = beam.lines, contact.lines[1:]
    (mesh,) = zone.collections
    for frame in (0, 5, 11):
        moving._update(frame)
        at = run.isel(field_time=frame)
        np.testing.assert_array_equal(line.get_ydata(), 1e3 * at["deflection_over_time"])
        time = at["field_time"].item()
        displacement = run["sphere_displacement"].interp(time=time).item()
        assert ball.get_ydata()[0] == pytest.approx(1e3 * displacement, abs=1e-12)
        assert guide.get_xdata()[0] == pytest.approx(1e3 * time)
        force = run["contact_force"].interp(time=time).item()
        assert marker.get_ydata()[0] == pytest.approx(1e-3 * force, abs=1e-12)
        strain = at["equivalent_plastic_strain_over_time"].values.T
        shown = mesh.get_array()
        np.testing.assert_array_equal(np.ma.getmaskarray(shown), strain < 1e-5)
        np.testing.assert_allclose(shown.compressed(), 100 * strain[strain >= 1e-5], rtol=1e-14)
    end = run["equivalent_plastic_strain"].values.T
    np.testing.assert_allclose(mesh.get_array().max(), 100 * end.max(), rtol=1e-14)
    low, high = sorted(beam.get_ylim())
    assert low < 1e3 * run["deflection_over_time"].min() < 1e3 * run["deflection_over_time"].max()
    assert 1e3 * run["deflection_over_time"].max() < high


def test_a_gif_plays_all_frames(moving, tmp_path):
    path = moving.save(tmp_path / "new" / "a.gif")
    with Image.open(path) as image:
        assert (image.n_frames, image.size, image.info["duration"]) == (12, (720, 520), 40)
        first = np.asarray(image.convert("RGB"))
        image.seek(11)
        assert (np.asarray(image.convert("RGB")) != first).mean() > 0.003


def test_a_page_needs_no_other_file_and_shows_each_frame(moving, drawn, tmp_path):
    page = moving.save(tmp_path / "a.html").read_text("utf-8")
    assert not re.search(r"https?:|@import|src=\"(?!data:)|href|{{", page)
    assert len(page) < 12 * 15_000  # 3 MB of 200 frames
    still = re.search(r"base64,([^\"]+)\"", page)[1]
    pictures = json.loads(re.search(r"const frames = (\[.*?\]), times", page)[1])
    times = json.loads(re.search(r"times = (\[.*?\]);", page)[1])
    assert (len(pictures), len(times)) == (12, 12)
    assert (times[0], times[-1]) == ("0.000 ms", "6.000 ms")
    under = Image.open(BytesIO(base64.b64decode(still))).convert("RGBA")
    for number in (0, 6, 11):
        over = Image.open(BytesIO(base64.b64decode(pictures[number]))).convert("RGBA")
        shown = np.asarray(Image.alpha_composite(under, over).convert("RGB"), int)
        assert np.abs(shown - drawn[1 + number]).mean() < 0.5  # of 255: colours of a palette


def test_a_video_has_all_frames(moving, tmp_path, monkeypatch):
    if find_spec("imageio_ffmpeg"):
        import imageio_ffmpeg

        path = moving.save(tmp_path / "a.mp4")
        assert imageio_ffmpeg.count_frames_and_secs(str(path))[0] == 12
    elif shutil.which("ffmpeg"):
        assert moving.save(tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"
    monkeypatch.setattr(animations, "find_spec", lambda name: None)
    monkeypatch.setattr(animations.shutil, "which", lambda name: None)
    with pytest.raises(OSError, match=r"MP4 needs ffmpeg: .*impactlab\[video\]"):
        moving.save(tmp_path / "b.mp4")
    with pytest.raises(ValueError, match=r"is written as MP4 or GIF or HTML"):
        moving.save(tmp_path / "b.avi")
    assert not [path for path in tmp_path.iterdir() if "b." in path.name]


def test_notebooks_play_it_apart_from_their_page(moving):
    frame = moving._repr_html_()
    assert frame.startswith('<iframe srcdoc="&lt;!DOCTYPE html')
    assert frame.count("<") == 2


def test_a_beam_that_yields_nowhere_is_said_to(tmp_path):
    run = il.simulate(il.paper_impact(0.3), GRID, duration="12 ms", frames=3)
    zone = il.plot.animate(run)._figure.axes[1]
    assert [text.get_text() for text in zone.texts] == ["no plastic strain"]


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_a_stored_run_is_solved_again_with_its_own_parameters():
    varied = {"velocity": [5.0, 15.0], "contact": ["mjg", "stronge"], "beam_depth": [0.03]}
    impact = il.corrected_impact(1.0)
    runs = il.simulate_many(impact, GRID, duration="12 ms", varied=varied, combine="product")
    with pytest.raises(ValueError, match="several runs, on contact: select one"):
        with_fields(_selected(runs, {"velocity": "1500 cm/s"}), 5)
    single = _selected(runs, {"velocity": "1500 cm/s", "contact": "stronge"})
    fields = with_fields(single, 5)
    assert FIELDS.keys() <= fields.keys()
    for name in RESPONSES:
        np.testing.assert_array_equal(fields[name], single[name])
    assert with_fields(fields, 3) is fields
    for values, message in (
        ({"velocty": "5"}, "velocty: unknown parameter; did you mean 'velocity'"),
        ({"velocity": "6"}, "no run has it: choose from 5.0 and 15.0"),
        ({"contact": "glue"}, "no run has it: choose from mjg and stronge"),
    ):
        with pytest.raises(ValueError, match=message):
            _selected(runs, values)
    with pytest.raises(ValueError, match="expected an impact"):
        with_fields(single.drop_vars("velocity"), 5)


def test_a_study_of_one_run_with_profiles_moves_in_its_report(tmp_path, monkeypatch):
    monkeypatch.setattr(animations, "_FRAMES", 4)

    def study(*velocities):
        return il.Study(
            title="One impact",
            impact=IMPACT,
            discretisation=GRID,
            duration="12 ms",
            responses=["peak_force"],
            store={"profiles": True},
            sampling=il.Grid(parameters={"velocity": velocities}),
            name="one",
            results=tmp_path,
        )

    file = tmp_path / "one" / "figures" / "animation.html"
    study(5.0).run(workers=1)
    page = study(5.0).report().read_text("utf-8")
    moving = html.unescape(re.search(r"<iframe [^>]*srcdoc=\"([^\"]*)\"", page)[1])
    assert moving == file.read_text("utf-8")
    assert "Impact at 5 m/s" in moving
    assert "<script" not in page
    study(5.0, 6.0).run(workers=1, replace=True)
    assert "<iframe" not in study(5.0, 6.0).report().read_text("utf-8")
    assert not file.exists()
