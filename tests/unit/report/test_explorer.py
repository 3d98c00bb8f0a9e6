"""The page of sliders, used in a browser: its numbers are those of `impactlab predict`."""

import shlex
from typing import Any

import command_line
import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.surrogate import analysis, packed
from impactlab.files import write_netcdf
from impactlab.methods.distributions import distribution_of
from impactlab.report.study import write_report
from impactlab.variables import described

DISTRIBUTIONS: dict[str, dict[str, Any]] = {
    "velocity": {"distribution": "log_uniform", "low": 0.5, "high": 20.0},
    "beam_depth": {"distribution": "triangular", "low": 0.0264, "mode": 0.0275, "high": 0.0292},
    "beam_yield_stress": {  # what is left of its upper tail
        "distribution": "truncated_normal",
        "mean": 60e6,
        "standard_deviation": 40e6,
        "low": 280e6,
        "high": 500e6,
    },
    "beam_youngs_modulus": {"distribution": "normal", "mean": 210e9, "standard_deviation": 4e9},
    "sphere_radius": {
        "distribution": "lognormal",
        "median": 0.035,
        "geometric_standard_deviation": 1.04,
    },
    "beam_density": {"distribution": "uniform", "low": 7700.0, "high": 7900.0},
}


@pytest.fixture(scope="module")
def sample():
    """Runs of every distribution: smooth answers, one across zero, one constant."""
    unit = np.random.default_rng(4).uniform(size=(600, len(DISTRIBUTIONS)))
    pairs = enumerate(DISTRIBUTIONS.items())
    varied = {
        name: ("run", distribution_of(given).quantile(unit[:, at]), given)
        for at, (name, given) in pairs
    }
    runs = xr.Dataset(coords=varied | {"run": np.arange(len(unit))})
    depth, stress = runs["beam_depth"] / 0.0278, runs["beam_yield_stress"] / 345e6
    smooth = runs["velocity"] ** 0.3 * depth**1.5 + (runs["sphere_radius"] / 0.035) ** 2
    smooth = smooth + 0.3 * runs["beam_youngs_modulus"] / 210e9 * runs["beam_density"] / 7800
    runs["peak_force"] = 3e4 * smooth * stress
    rough = 0.02 * np.sin(300 * depth)
    runs["rebound_velocity"] = stress - 0.9 + 0.1 * depth * np.log(runs["velocity"]) + rough
    runs["restitution"] = 0.5 + 0 * depth
    runs["status"] = "run", np.zeros(len(unit), np.int32)
    attrs = {"study": "made", "title": "Made <up>", "study_text": "title: Made", "method": "delta"}
    attrs |= {"varied": list(DISTRIBUTIONS), "seed": 1, "confidence": 0.95}
    attrs["responses"] = ["peak_force", "rebound_velocity", "restitution"]
    runs = described(runs.assign_attrs(attrs))
    return runs, analysis(runs).assign_attrs(attrs)


@pytest.fixture
def folder(sample, tmp_path):
    """A folder with surrogate.nc, report and explorer."""
    (tmp_path / "captions.json").write_text("{}")
    write_report(*sample, tmp_path, tmp_path / "report.html")
    surrogates = packed(*sample)
    assert surrogates is not None
    write_netcdf(surrogates, tmp_path / "surrogate.nc", "surrogate")
    return tmp_path


@pytest.fixture
def explorer(visit, folder):
    """The page, reached from its report; it must ask for no other."""
    with visit((folder / "report.html").as_uri(), 1300) as (page, asked):
        page.click("text=The explorer")
        yield page
    assert asked == [(folder / name).as_uri() for name in ("report.html", "report_explorer.html")]


def move(page, name, share):
    """Move a slider to a share of its way."""
    page.locator(f"#{name}-slider").evaluate(
        "(e, x) => { e.value = Math.round(e.max * x); e.dispatchEvent(new Event('input')) }", share
    )


def shown(page, response):
    return str(page.locator(f"#response-{response} output").inner_text())


def predicted(page, folder):
    """Cells of the table that the command on the page prints, by response."""
    command = shlex.split(page.locator("#command").inner_text())
    assert command[:3] == ["impactlab", "predict", str(folder / "surrogate.nc")]
    table = command_line.done(*command[1:], cwd=folder).stdout
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in table.splitlines()]
    return {row[0]: row[1:] for row in rows if row}


@pytest.mark.chromium
def test_moved_sliders_show_what_predict_prints(explorer, folder, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    rng, seen = np.random.default_rng(5), set()
    for shares in [np.zeros(6), np.ones(6), *rng.uniform(size=(5, 6))]:
        for name, share in zip(DISTRIBUTIONS, shares, strict=True):
            move(explorer, name, share)
        table = predicted(explorer, folder)
        assert table.pop("restitution") == ["none", "–", "–", "constant"]
        for name, (value, error, q2, verdict) in table.items():
            rest = "" if verdict == "usable" else f", {verdict}"
            assert shown(explorer, name) == f"{value} ± {error}{rest}"
            assert f"Q² = {q2}" in explorer.locator(f"#response-{name}").inner_text()
            seen.add(verdict.partition(":")[0])
    assert seen == {"usable", "imprecise", "extrapolated"}


@pytest.mark.chromium
def test_the_command_is_for_the_folder_of_the_project(sample, folder, visit, monkeypatch):
    monkeypatch.chdir(folder.parent)
    write_report(*sample, folder, folder / "report.html")
    with visit((folder / "report_explorer.html").as_uri(), 1300) as (page, _):
        command = shlex.split(page.locator("#command").inner_text())
        assert command[2] == f"{folder.name}/surrogate.nc"
        page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        page.click("#copy")
        page.get_by_text("Copied", exact=True).wait_for()
        assert shlex.split(page.evaluate("navigator.clipboard.readText()")) == command
        move(page, "velocity", 0.3)
        assert page.locator("#copy").inner_text() == "Copy"


@pytest.mark.chromium
def test_the_address_keeps_the_values_until_they_are_reset(folder, visit):
    with visit((folder / "report_explorer.html").as_uri(), 1300) as (page, _):
        opened = shown(page, "peak_force")
        move(page, "velocity", 0.2)
        page.fill("#beam_depth", "28.05")
        page.select_option("#against", label=page.inner_text("label[for=sphere_radius]"))
        chosen = shown(page, "peak_force")
        assert chosen != opened
        page.wait_for_url("**&against=sphere_radius")
        page.reload()
        assert shown(page, "peak_force") == chosen
        assert page.input_value("#beam_depth") == "28.05"
        assert "Radius of the sphere" in str(page.text_content("#response-peak_force svg"))
        page.click("#reset")
        assert shown(page, "peak_force") == opened
        page.reload()
        assert shown(page, "peak_force") == opened


@pytest.mark.chromium
def test_the_page_opens_with_precise_numbers(sample, folder, visit):
    """Here one response is zero at the medians."""
    runs, _ = sample
    median = distribution_of(DISTRIBUTIONS["beam_depth"]).quantile(np.array([0.5])).item()
    depth = runs["beam_depth"] - median
    made = 1e3 * depth + 1e-3 * np.sin(1e6 * depth)
    runs = runs.assign(rebound_velocity=made.assign_attrs(runs["rebound_velocity"].attrs))
    write_report(runs, analysis(runs).assign_attrs(runs.attrs), folder, folder / "report.html")
    with visit((folder / "report_explorer.html").as_uri(), 1300) as (page, _):
        assert shown(page, "rebound_velocity").endswith(" m/s")
        page.fill("#beam_depth", f"{1e3 * median:.4f}")
        assert "zero lies within the error" in shown(page, "rebound_velocity")


@pytest.mark.chromium
def test_no_number_outside_the_range(explorer, folder):
    before = shown(explorer, "peak_force")
    for text in ("29.3", "26.3", ""):
        explorer.fill("#beam_depth", text)
        assert "none" in shown(explorer, "peak_force")
        assert explorer.locator("svg *").count() == 0
        assert explorer.locator("#command").inner_text() == ""
        assert "trained from 26.4 to 29.2 mm" in explorer.inner_text("#beam_depth-refusal")
    explorer.fill("#beam_depth", "29.2")
    assert explorer.inner_text("#beam_depth-refusal") == ""
    assert shown(explorer, "peak_force") != before
    explorer.locator("#beam_depth-slider").press("ArrowRight")
    assert explorer.input_value("#beam_depth") == "29.2", "the slider left its range"


@pytest.mark.chromium
def test_the_curve_passes_through_the_number_and_follows_the_choice(explorer):
    path = "#response-peak_force path"  # solid, or dashed where it is extrapolated
    point = "#response-peak_force .point"
    for name in ("velocity", "sphere_radius"):
        explorer.select_option("#against", label=explorer.inner_text(f"label[for={name}]"))
        move(explorer, name, 0.75)
        place = [explorer.get_attribute(point, key) for key in ("cx", "cy")]
        assert ",".join(map(str, place)) in "".join(
            each.get_attribute("d") for each in explorer.locator(path).all()
        )


@pytest.mark.chromium
@pytest.mark.parametrize("width", [420, 1300])
def test_nothing_is_wider_than_the_window(explorer, width):
    explorer.set_viewport_size({"width": width, "height": 900})
    assert explorer.evaluate("document.documentElement.scrollWidth") <= width
    slider, curve = explorer.locator("#velocity-slider"), explorer.locator("svg").first
    slider.scroll_into_view_if_needed()
    both = [each.bounding_box() for each in (slider, curve)]
    assert all(0 <= box["y"] < 900 for box in both), "slider and curve are not seen together"


def test_what_is_refused_is_named_with_the_reason(folder, page):
    explorer = page((folder / "report_explorer.html").read_text("utf-8"))
    assert "Restitution : the response does not vary: there is none." in explorer.text
    assert [section["id"] for section in explorer.named("section")] == [
        "response-peak_force",
        "response-rebound_velocity",
        "refused",
    ]


def test_without_a_good_surrogate_there_is_no_page(sample, folder):
    runs, found = sample
    poor = found.assign(surrogate_verdict=found["surrogate_verdict"].where(False, 1))
    write_report(runs, poor, folder, folder / "report.html")
    assert not (folder / "report_explorer.html").exists(), "that of another report is left"
    assert "explorer" not in (folder / "report.html").read_text("utf-8")
