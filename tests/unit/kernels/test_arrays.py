"""What is lent stays alive until the loan ends."""

import subprocess
import sys

import numba
import pytest

PROGRAM = """
from dataclasses import replace
import impactlab as il
from impactlab.simulate import case_table, solve
impact, grid = il.paper_impact(1.0), il.Discretisation(nodes=200_001, points=3)
impact = replace(impact, beam_model={model!r})
grid = replace(grid, scheme={scheme!r})
answers = solve(case_table(impact, grid, duration=2e-8))
print(answers.responses["status"][0])
"""


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="plain Python lends nothing")
@pytest.mark.parametrize(
    ("model", "scheme"), [("euler_bernoulli", "semi_implicit"), ("timoshenko", "leapfrog")]
)
def test_large_arrays_are_not_freed_while_the_beam_moves(model, scheme):
    """Freed arrays of this size leave the process's memory: touching them ends it."""
    program = PROGRAM.format(model=model, scheme=scheme)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
