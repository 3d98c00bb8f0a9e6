"""The command line as tests call it: in a process of its own, or in theirs."""

import contextlib
import io
import logging
import subprocess
import sys
from unittest.mock import patch

import pytest

from impactlab.cli import main

SMALL = """
title: Small
description: For a test.
impact: {base: paper}
discretisation: {nodes: 21, points: 3}
duration: 1 ms
sampling:
  method: grid
  parameters:
    velocity: [0.5, 1.0, 2.0]
    nodes: [11, 21, 41]
responses: [peak_force, contact_duration]
"""
CHECKS = """
title: Checks
checks: [half_space]
"""


def process(*args, cwd, said="", env=None, python=()):
    """`impactlab ...` from beginning to end; python: options of the interpreter."""
    command = [sys.executable, *python, "-m", "impactlab", *map(str, args)]
    return subprocess.run(
        command, cwd=cwd, input=said, env=env, capture_output=True, text=True, timeout=300
    )


def succeeded(*args, cwd, **options):
    """Run `process`, which must succeed."""
    done = process(*args, cwd=cwd, **options)
    assert done.returncode == 0, done.stderr
    return done


def here(*args):
    """Exit code of `impactlab ...` in this process, which a test can watch and alter."""
    argv = ["impactlab", *map(str, args)]
    with patch.object(sys, "argv", argv), pytest.raises(SystemExit) as ended:
        main()
    logging.getLogger("impactlab").handlers.clear()
    return ended.value.code or 0


def called(*args, cwd, said=""):
    """Run the command in this process, which saves seconds of imports."""
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd),
        patch.object(sys, "stdin", io.StringIO(said)),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        code = here(*args)
    return subprocess.CompletedProcess(args, code, out.getvalue(), err.getvalue())


def done(*args, cwd):
    """Run `called`, which must succeed."""
    ended = called(*args, cwd=cwd)
    assert ended.returncode == 0, ended.stderr
    return ended
