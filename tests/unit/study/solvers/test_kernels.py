"""A study's runs need no kernel but those compiled before them."""

import itertools

import numpy as np
import pytest

from impactlab.solve import compile_kernels
from impactlab.solver import BEAM_MODELS, SCHEMES, WAVE_MODELS
from impactlab.solver.contact import LAWS
from impactlab.solver.kernels import is_extended, kernel_of, step_counter
from impactlab.study.solvers import kernels

OPTIONS = [
    *({"contact": law} for law in LAWS),
    {"load": "contact_patch"},
    {"beam_rate_coefficient": 3200.0},
    {"beam_rate_sensitivity": 0.01},
    {"contact_compliance": "strip"},
    {"contact_prestress": "bending"},
    {"mass_damping": 10.0},
    {"foundation_stiffness": 1e6},
]


@pytest.mark.parametrize("option", OPTIONS, ids=lambda option: "{}".format(*option.values()))
def test_a_study_compiles_the_kernels_of_its_runs(option, small_design, monkeypatch):
    design = small_design(1.0).assign_coords({"beam_model": "timoshenko"} | option)
    compiled = []
    monkeypatch.setattr(kernels, "compile_kernels", lambda *kinds: compiled.append(kinds))
    kernels.prepare(design)
    needed = is_extended(kernels.cases(design, np.array([0, 1]))).tolist()
    assert compiled == [(["timoshenko"], ["leapfrog"], sorted(set(needed)), [False], [(0, 0)])]


def test_what_the_base_needs_may_vary(small_design):
    """An elastic end has no base without its spring."""
    design = small_design(1.0, varied=["velocity", "nodes", "stiffness_right"])
    design = design.assign_coords({"support_right": "elastic", "stiffness_right": [1e6, 3e6]})
    cases = kernels.cases(design, np.arange(4))
    assert sorted(set(cases["stiffness_right"])) == [1e6, 3e6]


def test_compiling_all_leaves_no_kernel_out(monkeypatch):
    programs = {}
    monkeypatch.setitem(compile_kernels.__globals__, "precompile", programs.update)
    compile_kernels(several=(False, True))
    kinds = itertools.product(range(len(BEAM_MODELS)), range(len(SCHEMES)), (False, True))
    of_spheres = itertools.product(map(BEAM_MODELS.index, WAVE_MODELS), range(len(SCHEMES)))
    several = {kernel_of(*kind, several=True) for kind in of_spheres}
    assert set(programs) == {*map(kernel_of, *zip(*kinds, strict=True))} | several | {
        step_counter()
    }
