"""Parts of a study: each solved by itself, and merged into the runs of one process, to the bit."""

import shutil

import numpy as np
import pytest
import xarray as xr
from command_line import called, done

from impactlab.files import read_netcdf
from impactlab.study import parts
from impactlab.study.shard import Block, Piece, pieces_of

RANGES = "{distribution: uniform, low: -3.14, high: 3.14}"
FUNCTION = f"""
title: Closed form
function: ishigami
sampling:
  method: sobol
  base_samples: 64
  parameters: {{x1: {RANGES}, x2: {RANGES}, x3: {RANGES}}}
"""
GRID = """
title: Grid
impact: {base: paper}
discretisation: {points: 3}
duration: 0.3 ms
sampling:
  method: grid
  parameters:
    velocity: [0.5, 1, 2, 4]
    contact: [hertz, mjg]
    nodes: [11, 21, 31]
responses: [peak_force, impulse]
store: {histories: true, samples: 7}
"""
WORDS = """
title: Words
impact: {base: paper}
discretisation: {nodes: 11, points: 3}
duration: 0.3 ms
sampling:
  method: delta
  samples: 120
  parameters:
    velocity: {distribution: uniform, low: 1, high: 2}
    contact: {distribution: choice, values: [hertz, mjg, brake]}
responses: [peak_force]
"""
STRIKES = """
title: Strikes
impact: {base: paper, contact: finite_element}
discretisation: {nodes: 11, points: 3, scheme: modal}
duration: 12 ms
sampling: {method: grid, parameters: {velocity: [0.5, 1, 2, 3], strikes: [3, 1, 5]}}
responses: [peak_force]
"""
SPHERES = """
title: Spheres
impact: {base: paper, further_spheres: [{strike_position: 0.3, velocity: 2 m/s}]}
discretisation: {nodes: 11, points: 3}
duration: 0.3 ms
sampling: {method: grid, parameters: {velocity: [0.5, 1, 2], gravity: [0, 1, 2, 3]}}
responses: [peak_force]
store: {histories: true, samples: 7}
"""
STUDIES = {
    "function": FUNCTION,
    "grid": GRID,
    "words": WORDS,
    "strikes": STRIKES,
    "spheres": SPHERES,
}
RUNS = "results/{0}/runs.nc"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "studies").mkdir()
    for name, text in STUDIES.items():
        (tmp_path / "studies" / f"{name}.yaml").write_text(text)
    return tmp_path


def solve(folder, name, *numbers, of=5, to=()):
    for number in numbers:
        done("run", f"studies/{name}.yaml", "--part", f"{number}/{of}", *to, cwd=folder)


def merge(folder, name, *options):
    return called("merge", f"studies/{name}.yaml", *options, cwd=folder)


def blocks(folder, name):
    return sorted((folder / "results" / name / "parts").glob("*/*.npz"))


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES)
def test_merged_parts_are_the_runs_of_one_process(folder, name, monkeypatch):
    """The same values, attributes and digests; in blocks of a few runs, read 10 at a time."""
    done("run", f"studies/{name}.yaml", cwd=folder)
    alone = read_netcdf(folder / RUNS.format(name), "runs")
    shutil.rmtree(folder / "results")
    monkeypatch.setattr(parts, "_RUNS", 50 if name == "function" else 7)
    monkeypatch.setattr(parts, "block_rows", lambda shape: 10)
    solve(folder, name, 3, 1, 2, of=3)
    assert merge(folder, name).returncode == 0
    together = read_netcdf(folder / RUNS.format(name), "runs")
    assert together.identical(alone.assign_attrs(together.attrs))
    varying = {"created", "history"}
    assert {k: str(v) for k, v in together.attrs.items() if k not in varying} == {
        k: str(v) for k, v in alone.attrs.items() if k not in varying
    }
    assert [*together.variables] == [*alone.variables]


def test_missing_and_damaged_parts_are_named_and_solved_again(folder):
    refused = merge(folder, "function")
    assert refused.returncode == 1
    assert "holds no solved runs of this study" in refused.stderr
    solve(folder, "function", *range(1, 13), of=12)
    ours = {path.name: path for path in blocks(folder, "function")}
    for lost in ("0-42", "128-170", "170-213", "213-256"):
        ours[f"{lost}-of-12.npz"].unlink()
    damaged = ours["298-341-of-12.npz"]
    damaged.write_bytes(damaged.read_bytes()[:-100])
    refused = merge(folder, "function")
    assert refused.returncode == 1
    assert f"{damaged.name} is damaged" in refused.stderr
    assert "5 of 12 parts are not complete (213 of 512 runs are missing)" in refused.stderr
    assert "start them again, as --array=1,4-6,8, then merge" in refused.stderr
    assert not (folder / RUNS.format("function")).exists()
    solve(folder, "function", 1, 4, 5, 6, 8, of=12)
    assert merge(folder, "function").returncode == 0


def test_a_finished_part_ends_at_once_and_a_broken_one_goes_on(folder, monkeypatch):
    monkeypatch.setattr(parts, "_RUNS", 10)
    solve(folder, "function", 2)
    whole = blocks(folder, "function")
    again = done("run", "studies/function.yaml", "--part", "2/5", cwd=folder)
    assert "part 2 of 5: runs 103 to 204, 102 of them solved before" in again.stderr
    times = {path: path.stat().st_mtime_ns for path in whole}
    whole[3].unlink()
    again = done("run", "studies/function.yaml", "--part", "2/5", cwd=folder)
    assert "92 of them solved before" in again.stderr
    assert blocks(folder, "function") == whole
    changed = [path for path in whole if path.stat().st_mtime_ns != times[path]]
    assert changed == [whole[3]]


def test_other_cuts_fit_together(folder):
    """Two of five parts, the same runs in three parts, and the rest: no run comes twice."""
    solve(folder, "function", 1, 4)
    solve(folder, "function", 1, 2, 3, of=3)
    assert merge(folder, "function").returncode == 0
    runs = read_netcdf(folder / RUNS.format("function"), "runs")
    assert np.array_equal(runs["run"], np.arange(512))


def test_one_process_takes_what_parts_have_solved(folder):
    solve(folder, "grid", 1, 2)
    said = done("run", "studies/grid.yaml", cwd=folder).stderr
    assert "24 runs, 9 of them solved before" in said


def test_other_texts_and_kernels_have_files_of_their_own(folder):
    solve(folder, "grid", *range(1, 6))
    study = folder / "studies" / "grid.yaml"
    study.write_text(GRID.replace("title: Grid", "title: Another"))
    assert merge(folder, "grid").returncode == 0
    assert "need every shard" in done("clean", cwd=folder).stdout
    study.write_text(GRID.replace("velocity: [0.5", "velocity: [0.6"))
    assert "holds no solved runs" in merge(folder, "grid").stderr
    done("clean", "--yes", cwd=folder)
    assert not blocks(folder, "grid")


def test_from_a_design_and_with_an_automatic_discretisation(folder):
    done("design", "studies/words.yaml", cwd=folder)
    for number in (1, 2):
        done("run", "results/words", "--part", f"{number}/2", cwd=folder)
    done("merge", "results/words", cwd=folder)
    runs = read_netcdf(folder / RUNS.format("words"), "runs")
    assert runs.attrs["study_file"] == "../../studies/words.yaml"
    study = folder / "studies" / "auto.yaml"
    study.write_text(GRID.replace("{points: 3}", "auto").replace("    nodes: [11, 21, 31]\n", ""))
    for command in (("run", "studies/auto.yaml", "--part", "1/2"), ("merge", "studies/auto.yaml")):
        refused = called(*command, cwd=folder)
        assert refused.returncode == 1
        assert "impactlab recommend studies/auto.yaml" in refused.stderr


@pytest.mark.parametrize("part", ["0/4", "5/4", "1", "a/b", "1/0", "-1/4"])
def test_wrong_parts_are_refused(folder, part):
    refused = called("run", "studies/grid.yaml", f"--part={part}", cwd=folder)
    assert refused.returncode == 1
    assert "write NUMBER/PARTS" in refused.stderr


def test_what_parts_cannot_do_is_refused(folder):
    refused = called("run", "studies/grid.yaml", "--part", "1/2", "--processes", cwd=folder)
    assert "--part: goes with" in refused.stderr
    refused = called("run", "studies/grid.yaml", "--to", "elsewhere", cwd=folder)
    assert "--part: goes with" in refused.stderr
    growing = FUNCTION + "  until: {interval: 0.1, runs: 4000}\n"
    (folder / "studies" / "function.yaml").write_text(growing)
    refused = called("run", "studies/function.yaml", "--part", "1/2", cwd=folder)
    assert "sampling.until: lets the sample grow" in refused.stderr


def test_pieces_cover_each_run_once():
    a, b, c = Block(0, 4, 2), Block(2, 3, 5), Block(3, 8, 3)
    assert list(pieces_of([c, b, a], 0, 9)) == [
        Piece(0, 4, a),
        Piece(4, 8, c),
        Piece(8, 9, None),
    ]
    assert list(pieces_of([b], 0, 3)) == [Piece(0, 2, None), Piece(2, 3, b)]


@pytest.mark.parametrize("kind", ["memory://runs", "s3://parts/runs"])
def test_an_object_store_takes_the_blocks(folder, kind, request):
    if kind.startswith("s3"):
        request.getfixturevalue("object_store")
    solve(folder, "words", 1, 2, to=("--to", kind), of=2)
    assert not blocks(folder, "words")
    assert merge(folder, "words", "--from", kind).returncode == 0
    there = xr.load_dataset(folder / RUNS.format("words"))
    solve(folder, "words", 1, 2, of=2)
    assert merge(folder, "words").returncode == 0
    assert xr.load_dataset(folder / RUNS.format("words")).equals(there)


@pytest.fixture
def object_store(monkeypatch):
    """A server of S3 on the loopback with the bucket `parts`."""
    s3fs = pytest.importorskip("s3fs")
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "testing")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    s3fs.S3FileSystem.clear_instance_cache()
    s3fs.S3FileSystem().mkdir("parts")
    yield
    s3fs.S3FileSystem.clear_instance_cache()
    server.stop()


def test_an_object_store_out_of_reach_is_one_line(folder):
    refused = called("run", "studies/words.yaml", "--part", "1/2", "--to", "odd://x", cwd=folder)
    assert refused.returncode == 1
    assert "odd://x: cannot be reached" in refused.stderr
