"""Compiled kernels: cached, never stale, and the same numbers as plain Python."""

import importlib.util
import inspect
import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numba
import pytest

import impactlab as il
from impactlab.solver import jit
from impactlab.solver.contact import LAWS
from impactlab.variables import RESPONSES

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

KERNELS = Path(jit.__file__).parent


@pytest.fixture
def tree(tmp_path):
    """A copy of the kernels' sources."""
    return Path(shutil.copytree(KERNELS, tmp_path / "kernels"))


def hash_of(tree):
    """Return the hash that a process with these sources has."""
    spec = importlib.util.spec_from_file_location("copied_jit", tree / "jit.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.SOURCES_HASH


def test_a_copy_of_the_sources_has_the_same_hash(tree):
    assert hash_of(tree) == jit.SOURCES_HASH
    # bytecode beside the sources does not count
    (tree / "__pycache__").mkdir(exist_ok=True)
    (tree / "__pycache__" / "fibre.cpython-311.pyc").write_bytes(b"other")
    assert hash_of(tree) == jit.SOURCES_HASH
    # a new and a renamed source are another hash
    (tree / "contact" / "thornton.py").write_text("")
    added = hash_of(tree)
    (tree / "contact" / "thornton.py").rename(tree / "contact" / "brake.py")
    assert len({jit.SOURCES_HASH, added, hash_of(tree)}) == 3


@pytest.mark.parametrize("source", ["section.py", "contact/stronge.py", "__init__.py"])
def test_another_number_in_any_source_is_another_hash(tree, source):
    with (tree / source).open("a") as file:
        file.write("\n_ANOTHER = 1\n")
    assert hash_of(tree) != jit.SOURCES_HASH


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_a_changed_callee_in_another_file_is_compiled_anew(tmp_path, monkeypatch):
    """numba's own cache would go on with the old one; unchanged sources are not compiled again."""
    package, cache = tmp_path / "few_kernels", tmp_path / "cache"
    package.mkdir()
    shutil.copy(KERNELS / "jit.py", package)
    (package / "__init__.py").touch()
    (package / "caller.py").write_text(CALLER)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def run(stiffness):
        """(force, taken from the cache) as a new process would have them."""
        (package / "callee.py").write_text(CALLEE.format(stiffness))
        for name in [name for name in sys.modules if name.startswith("few_kernels")]:
            monkeypatch.delitem(sys.modules, name)
        force = import_module("few_kernels.caller").force
        return force(2.0), len(force.stats.cache_hits) == 1

    assert run(3.0) == (6.0, False)
    assert run(3.0) == (6.0, True)
    assert run(4.0) == (8.0, False)
    assert len(list(cache.glob("kernels-*"))) == 2


CALLER = """
from few_kernels.callee import stiffness
from few_kernels.jit import compiled

@compiled
def force(x):
    return stiffness() * x
"""
CALLEE = """
from few_kernels.jit import compiled

@compiled
def stiffness():
    return {}
"""


def bent():
    """Return a beam that yields, under all laws, and a grid."""
    return [il.paper_impact(20.0, law) for law in LAWS], il.Discretisation(nodes=11, points=5), 1e-3


def stretched():
    """Return one that stretches, too."""
    impact = replace(il.paper_impact(20.0), beam_model="von_karman")
    return [impact], il.Discretisation(nodes=7, points=5), 4e-5


def responses(impacts, grid, duration):
    """Return those of each impact, and its deflection in the end."""
    runs = [il.simulate(impact, grid, duration=duration) for impact in impacts]
    return [
        {name: run[name].item() for name in (*RESPONSES, "status")}
        | {"w": run.midspan_deflection.values[-1].item()}
        for run in runs
    ]


PLAIN = f"""
import json
from dataclasses import replace
import impactlab as il
from impactlab.variables import RESPONSES
from impactlab.solver.contact import LAWS

{inspect.getsource(bent)}
{inspect.getsource(stretched)}
{inspect.getsource(responses)}
"""


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
@pytest.mark.parametrize("case", [bent, pytest.param(stretched, marks=pytest.mark.slow)])
def test_plain_python_gives_the_same_responses(case):
    result = subprocess.run(
        [sys.executable, "-c", f"{PLAIN}\nprint(json.dumps(responses(*{case.__name__}())))"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    runs = responses(*case())
    assert all((run["plastic_dissipation"] > 0) is (case is bent) for run in runs)
    for compiled, plain in zip(runs, json.loads(result.stdout), strict=True):
        error = compiled.pop("energy_error")  # a difference, already relative
        assert plain.pop("energy_error") == pytest.approx(error, abs=1e-12)
        assert plain == pytest.approx(compiled, rel=1e-12, nan_ok=True)
