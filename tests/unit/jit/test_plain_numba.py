"""Without numba's private parts: the same bits, compiled by every process."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from impactlab import jit

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

SUM = """
import numpy as np
from pathlib import Path
from impactlab.jit import Compiler

compiler = Compiler(Path("sources"))

@compiler.decorator(fastmath=True, inline=True)
def total(x):
    y = 0.0
    for i in range(x.size):
        y += x[i] * x[i]
    return y

@compiler.decorator()
def norm(x):
    return np.sqrt(total(x))

print(norm(np.linspace(0.1, 1.7, 1001)).hex(), compiler.folder is None, type(norm._cache).__name__)
"""
IMPACT = """
import hashlib
import impactlab as il
run = il.simulate(
    il.paper_impact(20.0), il.Discretisation(nodes=41, points=9), duration=1e-3, samples=101
)
assert run.plastic_dissipation > 0
print(hashlib.sha256(b"".join(run[name].values.tobytes() for name in run.variables)).hexdigest())
"""


def printed(program, cache, **settings):
    """Return the words that a process with this program prints, and its messages."""
    root = str(Path(jit.__file__).parents[1])
    environment = os.environ | {"PYTHONPATH": root, "NUMBA_CACHE_DIR": str(cache)} | settings
    process = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True
    )
    assert process.returncode == 0, process.stderr
    return process.stdout.split(), process.stderr


def test_public_options_alone_give_the_same_bits(tmp_path):
    (total, *private), _ = printed(SUM, tmp_path)
    assert private == ["False", "KernelCache"]
    (plain_total, *plain), messages = printed(SUM, tmp_path / "none", IMPACTLAB_PLAIN_NUMBA="1")
    assert plain == ["True", "NullCache"]
    assert plain_total == total
    assert not messages
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    "part", ["core.options.DefaultOptions._nrt", "core.compiler.CompileResult._rebuild"]
)
def test_a_missing_private_part_is_named_and_not_needed(part, tmp_path):
    """These are parts that numba itself needs no more once it is imported."""
    assert part in jit._PRIVATE
    (total, *plain), messages = printed(f"import numba\ndel numba.{part}\n{SUM}", tmp_path)
    assert plain == ["True", "NullCache"]
    assert part.rpartition(".")[2] in messages
    assert total == printed(SUM, tmp_path)[0][0]


@pytest.mark.long
def test_an_impact_has_the_same_bits(tmp_path):
    """Beam and contact yield; a kernel loaded from the cache, and one compiled in its process."""
    plain, _ = printed(IMPACT, tmp_path, IMPACTLAB_PLAIN_NUMBA="1")
    assert printed(IMPACT, tmp_path)[0] == plain
