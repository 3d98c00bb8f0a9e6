"""The command `impactlab witness` as users run it, on coarse meshes and for short durations."""

import signal
import subprocess
import sys
from functools import partial

import meshio
import pytest
import xarray as xr
from command_line import here
from PIL import Image

from impactlab.fem3d.plan import case_of
from impactlab.fem3d.solver import solve

COARSE = ("--element-size", "2 mm", "--duration", "0.05 ms")
FOLDER = "results/paper/witness_element-size-2-mm_duration-0.05-ms"
STUDY = """
title: Some
impact: {base: paper}
discretisation: {nodes: 21, points: 3}
duration: 0.05 ms
sampling: {method: grid, parameters: {velocity: [1, 2], contact: [hertz]}}
responses: [peak_force]
"""


@pytest.fixture
def undrawn(monkeypatch):
    """Skip the figures, which are slow."""
    monkeypatch.setattr("impactlab.fem3d.comparison.draw_witness", lambda *_: None)


@pytest.fixture
def impactlab(tmp_path, monkeypatch, capsys):
    """Run the command line in this process; return (exit code, output)."""
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "some.yaml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")

    def run(*args):
        code = here(*args)
        printed = capsys.readouterr()
        return code, printed.out + printed.err

    return run


def test_the_papers_case_is_solved_compared_drawn_and_kept(impactlab, tmp_path):
    code, said = impactlab("witness", *COARSE, "--workers", "1")
    assert code == 0, said
    folder = tmp_path / FOLDER
    solid = xr.load_dataset(folder / "witness.nc")
    alone = solve(case_of(None).impact, element_size=2e-3, duration=5e-5)
    assert solid["contact_force"].values.tolist() == alone["contact_force"].values.tolist()
    assert f"number_of_contacts{1:>18}" in said
    assert "missing (all models): the duration ends before the first contact does" in said
    read = meshio.read(folder / "witness.vtu")
    (stress,) = read.cell_data["von_mises_stress"]
    assert stress.ravel().tolist() == solid["von_mises_stress"].values.tolist()
    assert (folder / "figures" / "mesh.svg").exists()
    assert xr.load_dataset(folder / "beams.nc").sizes["beam_model"] == 3
    report = " ".join((folder / "report.html").read_text().split())
    assert "--contact stronge --element-size &#39;2 mm&#39;" in report
    assert "the duration ends before the first contact does" in report
    assert impactlab("index")[0] == 0
    listed = (tmp_path / "results" / "index.html").read_text()
    assert f'href="{folder.relative_to(tmp_path / "results").as_posix()}/report.html"' in listed
    assert (folder / "comparison.csv").read_text().startswith("response,units,model,value")


def test_a_study_gives_the_case_and_options_change_it(impactlab, tmp_path, undrawn):
    asked = ("studies/some.yaml", "--velocity", "3 m/s", "--output", "here")
    code, said = impactlab("witness", *asked, *COARSE, "--animate", "contact.gif")
    assert code == 0, said
    with Image.open("contact.gif") as moving:
        assert moving.n_frames > 10
    assert "<iframe" in (tmp_path / "here" / "report.html").read_text("utf-8")
    held = "some.yaml varies parameters of which this command takes one value: contact = stronge"
    assert held in said
    beams = xr.load_dataset(tmp_path / "here" / "beams.nc")
    assert beams["velocity"] == xr.load_dataset(tmp_path / "here" / "witness.nc")["velocity"] == 3
    assert beams["nodes"] == 21
    assert not (tmp_path / "results").exists()


def test_a_dry_run_tells_the_cost_and_leaves_nothing(impactlab, tmp_path):
    code, said = impactlab("witness", "studies/some.yaml", "--dry-run", "--workers", "3", *COARSE)
    assert code == 0
    for words in ("elements       10,134", "on 3 threads", "some.yaml, at 0.99 m/s"):
        assert words in said
    code, said = impactlab("witness", "--dry-run", "--element-size", "1 um")
    assert code == 0
    assert "exceeds the limit: the paper's case: --element-size 0.001 mm: about" in said
    assert [path.name for path in tmp_path.iterdir()] == ["studies"]


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--element-size", "1 um"], ["--element-size 0.001 mm", "of memory", "--force"]),
        (["--element-size", "3 kg"], ["--element-size = '3 kg'", "length"]),
        (["--element-size", "2 mm", "--duration", "1 h"], ["--duration 3.6e+06 ms", "--force"]),
        (["--patch", "50 mm"], ["patch", "to fit on beam and sphere"]),
        (["--velocity", "-1"], ["velocity", "above zero"]),
        (["--contact", "glue"], ["contact", "glue", "hertz"]),
        (["studies/none.yaml"], ["studies/none.yaml"]),
        (["--patch", "1 m", "--element-size", "0.2 mm"], ["patch", "to fit on beam and sphere"]),
        ([*COARSE, "--elastic"], ["--elastic", "--deck"]),
        ([*COARSE, "--deck", "nastran"], ["--deck nastran", "abaqus", "calculix"]),
        (["--dry-run", "--deck", "nastran"], ["--deck nastran", "abaqus", "calculix"]),
    ],
)
def test_mistakes_end_in_one_message_and_leave_no_answers(impactlab, tmp_path, args, words):
    code, said = impactlab("witness", *args)
    assert code == 1
    assert "Traceback" not in said
    for word in words:
        assert word in said, said
    assert not [path for path in tmp_path.glob("results/**/*") if path.is_file()]


def test_a_deck_is_written_and_nothing_solved(impactlab, tmp_path):
    code, said = impactlab("witness", *COARSE, "--deck", "calculix")
    assert code == 0, said
    file = f"{FOLDER}/calculix.inp"
    assert f"\n{file}\n" in said
    assert f"WARNING: {file}: CalculiX 2.20 crashes" in said
    assert "wall" not in said
    assert (tmp_path / file).read_text().startswith("*HEADING")
    assert "\n*PLASTIC" in (tmp_path / file).read_text()
    impactlab("witness", *COARSE, "--deck", "calculix", "--elastic")
    assert "\n*PLASTIC" not in (tmp_path / FOLDER / "calculix_elastic.inp").read_text()
    assert len(list((tmp_path / FOLDER).iterdir())) == 2


def test_a_contact_that_outgrows_the_patch_keeps_what_it_has(impactlab, tmp_path, undrawn):
    small = ("--patch", "2 mm", "--velocity", "9 m/s", "--output", "here")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "witness.nc").write_text("damaged")
    code, said = impactlab("witness", *COARSE, *small)
    assert code == 1
    assert "ERROR: --patch: at " in said
    assert "take patch = " in said
    assert "here holds what was computed until then" in said
    assert xr.load_dataset(tmp_path / "here" / "witness.nc")["peak_force"].isnull()


def test_what_was_broken_off_is_kept_but_not_in_place_of_a_whole_run(
    impactlab, tmp_path, undrawn, monkeypatch
):
    from impactlab.fem3d import comparison as package

    solve_on, solved = package.solve_on, []
    stopped = {"stopped": "an element was squeezed flat"}

    def whole(*args, **options):
        solved[:] = solved or [solve_on(*args, **options)]  # three times the same
        return solved[0].copy()

    def broken(*args, **options):
        return whole(*args, **options).assign_attrs(stopped)

    monkeypatch.setattr(package, "solve_on", broken)
    code, said = impactlab("witness", *COARSE)
    assert code == 1
    assert f"squeezed flat; {FOLDER} holds what was computed until then" in said
    assert xr.load_dataset(tmp_path / FOLDER / "witness.nc").attrs["stopped"] == stopped["stopped"]
    monkeypatch.setattr(package, "solve_on", whole)
    impactlab("witness", *COARSE)
    kept = (tmp_path / FOLDER / "witness.nc").read_bytes()
    monkeypatch.setattr(package, "solve_on", broken)
    _, said = impactlab("witness", *COARSE)
    assert f"{FOLDER}_stopped holds what was computed until then" in said
    assert (tmp_path / FOLDER / "witness.nc").read_bytes() == kept
    again = xr.load_dataset(tmp_path / f"{FOLDER}_stopped" / "witness.nc")
    assert again.attrs == again.attrs | stopped


def test_a_folder_that_cannot_be_written_to_is_told_before_anything_is_solved(
    impactlab, tmp_path, monkeypatch
):
    monkeypatch.setattr("impactlab.fem3d.comparison.solve_on", None)
    (tmp_path / "file").touch()
    code, said = impactlab("witness", *COARSE, "--output", "file/folder")
    assert code == 1
    assert "ERROR: --output file/folder: Not a directory: nothing was solved" in said


def test_ctrl_c_keeps_what_was_computed(tmp_path):
    command = [sys.executable, "-c", PRESSED, "witness", "--element-size", "2 mm"]
    # a shell starts its background jobs deaf to Ctrl-C, and these tests may run in one
    hear = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=300, preexec_fn=hear
    )
    assert done.returncode == 130, done.stderr
    assert "Traceback" not in done.stderr
    stopping, kept = done.stderr.splitlines()
    assert stopping.startswith("impactlab: stopping to keep what is computed")
    assert kept.startswith("WARNING: interrupted at ")
    folder = "results/paper/witness_element-size-2-mm"
    assert kept.endswith(f"{folder} holds what was computed until then")
    solid = xr.load_dataset(tmp_path / folder / "witness.nc")
    assert 1e-6 < solid["duration"] < 0.1e-3
    beams = xr.load_dataset(tmp_path / folder / "beams.nc")
    assert beams["duration"] == solid["duration"]


PRESSED = """
import os, signal
import impactlab.fem3d.comparison as comparison
from impactlab.cli import main
from impactlab.fem3d.solver.march import March
comparison.draw_witness = lambda *_: None
advance = March._advance
def pressed(self, end):
    advance(self, end)
    if end > 4e-5:
        os.kill(os.getpid(), signal.SIGINT)
March._advance = pressed
main()
"""
"""The command line, with Ctrl-C pressed once in the middle of a run."""
