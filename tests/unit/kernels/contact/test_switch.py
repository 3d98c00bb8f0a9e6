"""A law's number leads to its function."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from impactlab.kernels.contact import LAWS
from impactlab.kernels.contact.switch import curve

ARGS = (2e-4, 115e9, 0.035, 345e6, 0.3)


@pytest.mark.parametrize("law", LAWS)
def test_a_number_gives_the_law_of_that_name(law):
    module = import_module(f"impactlab.kernels.contact.{law}")
    assert curve(LAWS.index(law), *ARGS) == module.curve(*ARGS)


def test_laws_differ():
    curves = [curve(number, *ARGS) for number in range(len(LAWS))]
    assert len(set(curves)) == len(LAWS)


@pytest.mark.parametrize("number", [-1, len(LAWS)])
def test_an_unknown_number_gives_no_force(number):
    assert np.isnan(curve(number, *ARGS)[:3]).all()
