"""Kratos is imported late, and its absence is reported in one line."""

import subprocess
import sys

import pytest

from impactlab.fem3d import kratos


@pytest.mark.parametrize(
    "missing", ["KratosMultiphysics", "KratosMultiphysics.ConstitutiveLawsApplication"]
)
def test_what_is_missing_is_told(missing, monkeypatch, mesh, impact):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(kratos.KratosMissingError, match=r"pip install 'impactlab\[kratos\]'"):
        kratos.solve_on(mesh, impact, duration=1e-5)


def test_nothing_imports_it_beforehand():
    code = "import impactlab.fem3d.kratos, sys; print('KratosMultiphysics' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.mark.parametrize("wrong", [{"duration": 0.0}, {"time_step": -1e-6}, {"penalty": 0.0}])
def test_numbers_that_make_no_sense_are_refused(wrong, mesh, impact):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        kratos.solve_on(mesh, impact, **({"duration": 1e-5} | wrong))
