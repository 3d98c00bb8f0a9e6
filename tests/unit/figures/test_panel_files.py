"""Each panel as a file of its own, for papers."""

import matplotlib
import pytest
from command_line import called
from PIL import Image

from impactlab.figures import style
from impactlab.figures.draw import draw_all, draw_panels
from impactlab.figures.single_runs import plastic_strain_depth

PANELS = {"contact_duration", "parameter_effects_peak_force", "parameter_effects_contact_duration"}


@pytest.fixture
def study(velocity_study):
    runs, analysis = velocity_study
    return runs[["peak_force", "contact_duration", "status"]], analysis


def _draw(study, folder, width, look="plain"):
    def write(*arguments, **options):
        return draw_panels(*arguments, **options, width=width, look=look)

    return draw_all(*study, folder, write)


@pytest.mark.parametrize(("look", "width"), [("plain", style.SINGLE), ("nature", style.DOUBLE)])
def test_every_panel_is_a_file_of_the_width_asked_for(study, tmp_path, width, look):
    before = dict(matplotlib.rcParams)
    written = _draw(study, tmp_path, width, look)
    expected = {f"{name}_{width:g}mm.{kind}" for name in PANELS for kind in ("svg", "png", "pdf")}
    assert {path.name for path in written} == expected
    for path in tmp_path.glob("*.png"):
        with Image.open(path) as image:
            columns, rows = image.size
        assert columns / 300 * 25.4 == pytest.approx(width, abs=0.1)
        assert rows / 300 * 25.4 <= style.PAGE
    assert dict(matplotlib.rcParams) == before


def test_the_same_panels_have_the_same_bytes_and_styles_differ(study, tmp_path):
    study = study[0].drop_vars("peak_force"), study[1]
    files = [
        {path.name: path.read_bytes() for path in _draw(study, tmp_path / folder, 85.0, look)}
        for folder, look in (("again", "plain"), *((look, look) for look in style.SHEETS))
    ]
    name = "contact_duration_85mm.svg"
    assert files[0] == files[1 + list(style.SHEETS).index("plain")]
    assert len({made[name] for made in files}) == len(style.SHEETS)


def test_a_panel_alone_keeps_the_axes_that_it_shares(velocity_study):
    with style.alone(1, style.SINGLE) as panel:
        (axes,) = plastic_strain_depth.plot(*velocity_study).axes
    assert panel.count == 2
    low, high = axes.get_ylim()
    assert low > high, "the depth points downwards in every panel"
    assert axes.get_ylabel()
    assert any(label.get_visible() for label in axes.get_yticklabels())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--width", "30 mm"], ["--width", "80 to 183 mm"]),
        (["--width", "3 s"], ["--width", "3 s"]),
        (["--style", "natur"], ["--style", "nature"]),
    ],
)
def test_a_width_or_style_that_is_not_offered_is_refused(options, words, tmp_path):
    ended = called("figures", "runs.nc", *options, cwd=tmp_path)
    assert ended.returncode != 0
    for word in words:
        assert word in ended.stderr
