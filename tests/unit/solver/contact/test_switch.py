"""A law's number leads to its function."""

from importlib import import_module

import numpy as np
import pytest

from impactlab.solver.contact import LAWS
from impactlab.solver.contact.switch import curve

ARGS = (2e-4, 115e9, 0.035, 345e6, 0.3)


@pytest.mark.parametrize("law", LAWS)
def test_a_number_gives_the_law_of_that_name(law):
    module = import_module(f"impactlab.solver.contact.{law}")
    assert curve(LAWS.index(law), *ARGS) == module.curve(*ARGS)


@pytest.mark.parametrize("number", [-1, len(LAWS)])
def test_an_unknown_number_gives_no_force(number):
    assert np.isnan(curve(number, *ARGS)[:3]).all()
