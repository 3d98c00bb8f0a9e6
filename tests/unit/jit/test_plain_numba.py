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
    """And so do they where a private part is missing, which is named.

    The parts are some that numba itself needs no more once it is imported.
    """
    (total, *private), _ = printed(SUM, tmp_path)
    assert private == ["False", "KernelCache"]
    plain, messages = printed(SUM, tmp_path / "none", IMPACTLAB_PLAIN_NUMBA="1")
    assert plain == [total, "True", "NullCache"]
    assert not messages
    assert not (tmp_path / "none").exists()
    for part in ("core.options.DefaultOptions._nrt", "core.compiler.CompileResult._rebuild"):
        assert part in jit._PRIVATE
        lacking, messages = printed(f"import numba\ndel numba.{part}\n{SUM}", tmp_path)
        assert lacking == plain
        assert part.rpartition(".")[2] in messages
