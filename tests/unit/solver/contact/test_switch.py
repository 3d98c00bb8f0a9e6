"""A law's number leads to its function."""

import os
import subprocess
import sys
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


FORCES = """
import numpy as np
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, Pair, load
from impactlab.solver.contact.switch import damping

for law in range(len(LAWS)):
    contact = np.zeros(2, CONTACT)
    for i in range(2):
        load(contact[i], Pair(law, 1e11, 0.03, 3e8, 0.3), (1e-5, 1e-4)[i])
    print(contact["F_m"], contact["delta_r"], damping(law, 1e3, 1e-4, 1.0, 1e11, 0.03, 3e8, 0.3))
"""


@pytest.mark.long
def test_each_law_is_itself_when_loaded_from_the_cache(tmp_path):
    """numba mixes up functions made in a loop when it finds them in its cache."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    said = [
        subprocess.run(
            [sys.executable, "-c", FORCES],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for _ in range(2)
    ]
    assert said[0] == said[1]
    assert "nan" not in said[0]
    assert len(set(said[0].splitlines())) == len(LAWS)
