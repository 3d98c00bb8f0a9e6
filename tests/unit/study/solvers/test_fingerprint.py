"""Functions that give other answers have another fingerprint, the same ones the same."""

import functools
import math

import numpy as np
import pytest

from impactlab.study.solvers.fingerprint import fingerprint


def power(run, exponent=1):
    return run.impulse**exponent


def inner(factor):
    def scaled(run):
        return factor * helper(run)

    return scaled


def helper(run):
    return math.sqrt(run.impulse)


def other(run):
    return math.sin(run.impulse)


@pytest.mark.parametrize(
    ("one", "another"),
    [
        (inner(1.0), inner(2.0)),
        (lambda run: run.impulse, lambda run: run.restitution),
        (lambda run: run.impulse + 1, lambda run: run.impulse + 2),
        (functools.partial(power, exponent=1), functools.partial(power, exponent=2)),
        (lambda run, power=1: run.impulse**power, lambda run, power=2: run.impulse**power),
        (lambda run: np.sin(run.impulse), lambda run: np.cos(run.impulse)),
        (lambda run: helper(run), lambda run: other(run)),
        (lambda run: run.impulse in {1, 2}, lambda run: run.impulse in {1, 3}),
    ],
)
def test_functions_that_differ_have_fingerprints_that_differ(one, another):
    assert fingerprint(one) == fingerprint(one)
    assert fingerprint(one) != fingerprint(another)


def test_a_changed_helper_changes_the_fingerprint(monkeypatch):
    before = fingerprint(inner(1.0))
    monkeypatch.setitem(globals(), "helper", other)
    assert fingerprint(inner(1.0)) != before
