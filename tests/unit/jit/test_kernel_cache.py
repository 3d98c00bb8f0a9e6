"""Compiled kernels on disk: shared by processes and checkouts, and sound whatever happens."""

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numba
import pytest

import impactlab.jit
from impactlab.jit import _read
from impactlab.solver import jit

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

TRIPLE = """
from few_kernels.jit import compiled

@compiled
def triple(x):
    return 3.0 * x
"""
TIMES = """
from few_kernels.jit import compiled

def times(factor):
    @compiled
    def multiplied(x):
        return factor * x
    return multiplied

double, six_times = times(2.0), times(6.0)

@compiled
def triple(x):
    return double(0.5 * x) + six_times(x)
"""
CALL = """
from few_kernels.triple import triple
print(triple(2.0), len(triple.stats.cache_hits))
"""


class Kernel:
    """A compiled function, of which only the cache is needed."""

    def __init__(self, cache):
        self._cache = cache


Start = Callable[..., "subprocess.Popen[str]"]


def checkout(folder):
    """A package with one kernel, in `folder`."""
    package = folder / "few_kernels"
    package.mkdir(parents=True)
    shutil.copy(jit.__file__, package)
    (package / "__init__.py").touch()
    (package / "triple.py").write_text(TRIPLE)
    return folder


@pytest.fixture
def call(tmp_path):
    """Start a process that calls the kernel and prints its result and the cache hits."""
    here = checkout(tmp_path / "here")

    def start(folder=here, **settings):
        path = os.pathsep.join([str(folder), *filter(None, sys.path)])
        env = os.environ | {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.Popen(
            [sys.executable, "-c", CALL],
            env=env | settings,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return start


def printed(process):
    out, errors = process.communicate(timeout=600)
    assert process.returncode == 0, errors
    return out.split(), errors


@pytest.mark.chaos
def test_processes_that_compile_at_once_leave_a_sound_cache(call):
    started = [call() for _ in range(3)]
    assert {printed(process)[0][0] for process in started} == {"6.0"}
    assert printed(call())[0] == ["6.0", "1"]


def test_another_checkout_finds_the_kernels_and_another_processor_compiles_its_own(call, tmp_path):
    assert printed(call())[0] == ["6.0", "0"]
    assert printed(call(checkout(tmp_path / "elsewhere")))[0] == ["6.0", "1"]
    assert printed(call(NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES=""))[0] == ["6.0", "0"]
    assert printed(call())[0] == ["6.0", "1"]


def test_functions_made_by_one_function_are_not_confused(call, tmp_path):
    """Each answers for itself, compiled and from the cache; they are kept with their callers."""
    (tmp_path / "here" / "few_kernels" / "triple.py").write_text(TIMES)
    for hits in "0", "1":
        assert printed(call())[0] == ["14.0", hits]


def test_without_a_folder_kernels_run_and_leave_nothing_behind(call, tmp_path):
    out, errors = printed(call(NUMBA_CACHE_DIR="/dev/null"))
    assert out == ["6.0", "0"]
    assert "compiled kernels cannot be kept in /dev/null/kernels-" in errors
    assert not list(tmp_path.rglob("*.nbi"))
    assert not list(tmp_path.rglob("*.kernel"))


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "shorter than its checksum": lambda content: content[:20],
    "truncated": lambda content: content[: len(content) // 2],
    "garbled": lambda content: bytes(reversed(content)),
    "a bit flipped in the code": lambda content: (
        content[:-100] + bytes([content[-100] ^ 1]) + content[-99:]
    ),
    "a bit flipped in the checksum": lambda content: bytes([content[0] ^ 1]) + content[1:],
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_no_damage_passes_for_a_kernel(damage, tmp_path):
    content = bytes(range(256))
    kernel, other = tmp_path / "a.kernel", tmp_path / "b.kernel"
    for file in (kernel, other):
        file.write_bytes(hashlib.sha256(content).digest() + content)
    assert _read(other) == content
    kernel.write_bytes(DAMAGE[damage](kernel.read_bytes()))
    assert _read(kernel) is None
    assert not list(tmp_path.iterdir())


@pytest.mark.chaos
def test_a_damaged_kernel_is_removed_reported_and_compiled_again(call, tmp_path):
    assert printed(call())[0] == ["6.0", "0"]
    (file,) = (tmp_path / "cache").rglob("*.kernel")
    file.write_bytes(DAMAGE["a bit flipped in the code"](file.read_bytes()))
    out, errors = printed(call())
    assert out == ["6.0", "0"]
    assert errors.splitlines() == [
        f"damaged compiled kernels in {file.parent} are removed and compiled again"
    ]
    assert printed(call()) == (["6.0", "1"], "")


@pytest.mark.chaos
def test_a_write_that_fails_half_way_leaves_nothing(call, tmp_path):
    """The limit on file size stops it in the middle, as a full disk would."""
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))"
    (tmp_path / "here" / "few_kernels" / "__init__.py").write_text(limit)
    out, errors = printed(call())
    assert out == ["6.0", "0"]
    assert "could not be kept" in errors
    assert not list((tmp_path / "cache").rglob("*.kernel*"))


@pytest.mark.chaos
def test_a_file_half_written_by_a_killed_process_is_not_read(call, tmp_path):
    assert printed(call())[0] == ["6.0", "0"]
    (file,) = (tmp_path / "cache").rglob("*.kernel")
    file.rename(file.with_name(f"{file.name}.{32 * 'a'}"))
    assert printed(call()) == (["6.0", "0"], "")
    assert printed(call()) == (["6.0", "1"], "")


SOLVE = """
import hashlib
import impactlab as il
from impactlab.simulate import run_dataset
from impactlab.solver.kernels import kernel_of
grid = il.Discretisation(nodes=21, points=5)
run = run_dataset(il.paper_impact(20.0), grid, duration=1e-3)
assert run.plastic_dissipation > 0
bits = b"".join(run[name].values.tobytes() for name in sorted(run.variables))
print(hashlib.sha256(bits).hexdigest(), len(kernel_of(0, 0).stats.cache_hits))
"""


@pytest.mark.long
def test_every_process_has_the_same_bits(tmp_path):
    """The first, one that starts at once, a second checkout, and one with numba's public options.

    Beam and contact yield. The last compiles for itself; of the others one does.
    """
    package = Path(jit.__file__).parents[1]
    roots = [package.parent, tmp_path / "checkout"]
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(package, roots[1] / package.name, ignore=ignored)

    def start(root, **settings):
        env = os.environ | {"PYTHONPATH": str(root), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.Popen(
            [sys.executable, "-c", SOLVE],
            cwd=tmp_path,
            env=env | settings,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    started = [start(root) for root in roots]
    out = [printed(process)[0] for process in started]
    (file,) = (tmp_path / "cache").rglob("*.kernels.euler_bernoulli-*.kernel")
    compiled_once = file.stat().st_mtime_ns
    out.append(printed(start(roots[1]))[0])
    assert file.stat().st_mtime_ns == compiled_once
    assert out == [[out[0][0], "1"]] * 3
    assert printed(start(roots[0], IMPACTLAB_PLAIN_NUMBA="1"))[0] == [out[0][0], "0"]


def test_kernels_of_one_call_are_compiled_together(tmp_path, monkeypatch):
    """One process per processor, none for what is in the cache, and none the second time."""
    caches = [impactlab.jit.KernelCache(tmp_path, f"kernel_{number}") for number in range(5)]
    content = b"compiled"
    (tmp_path / "kernel_0-abc.kernel").write_bytes(hashlib.sha256(content).digest() + content)
    programs = {Kernel(cache): f"call({cache.name})" for cache in caches}
    started = []

    def run(command, env, **options):
        started.append((env["IMPACTLAB_COMPILES"].split(), command[-1].splitlines()[1:]))
        return subprocess.CompletedProcess(command, 0, stderr="")

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    impactlab.jit.precompile(programs)
    impactlab.jit.precompile(programs)
    names = [["kernel_1", "kernel_3"], ["kernel_2", "kernel_4"]]
    assert sorted(started) == [(group, [f"call({name})" for name in group]) for group in names]


def test_a_process_that_dies_compiling_is_reported(tmp_path, caplog):
    kernel = Kernel(impactlab.jit.KernelCache(tmp_path, "kernel"))
    impactlab.jit.precompile({kernel: "import os; os._exit(3)"})
    (record,) = [r for r in caplog.records if r.levelname == "WARNING"]
    assert "(kernel) failed with exit code 3" in record.getMessage()


def test_compiling_is_announced_once_by_all_processes(tmp_path, capsys, monkeypatch):
    """Again after the kernels are gone, or after a while."""
    for _ in range(7):
        impactlab.jit._announce(tmp_path)
    assert capsys.readouterr().err.count("compiling kernels") == 1
    impactlab.jit.discard(tmp_path)
    impactlab.jit._announce(tmp_path)
    assert capsys.readouterr().err.count("compiling kernels") == 1
    monkeypatch.setattr(impactlab.jit, "_QUIET", 0.0)
    impactlab.jit._announce(tmp_path)
    assert capsys.readouterr().err.count("compiling kernels") == 1


def test_a_setting_that_numba_refuses_is_named():
    done = subprocess.run(
        [sys.executable, "-m", "impactlab", "simulate", "--velocity", "5"],
        env=os.environ | {"NUMBA_NUM_THREADS": "0"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith("ERROR: numba refuses a setting of the environment")
    assert "NUMBA_NUM_THREADS=0" in line
