"""Stored studies made up after the data contract: small, quick, of plausible size, not physics."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from made_runs import (
    ATTRIBUTES,
    answers,
    design_of,
    flags,
    indices,
    made_once,
    surrogates,
    with_answers,
    with_histories,
)

from impactlab.solver.contact import LAWS
from impactlab.solver.outputs import OUTSIDE_CONTACT_LAW
from impactlab.variables import RESPONSES, described
from impactlab.verification.finding import (
    CLOSED_FORM,
    Comparison,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Outcome,
)
from impactlab.verification.outcomes import packed


@made_once
def velocity_study():
    """Eight velocities by two contact laws, with histories and profiles."""
    varied = {
        "velocity": [0.25, 0.99, 2.0, 5.0, 7.5, 10.0, 15.0, 20.0],
        "contact": ["hertz", "stronge"],
    }
    design = design_of(varied, study="velocity", method="grid", histories=1, profiles=1)
    runs = with_histories(with_answers(design))
    return runs, xr.Dataset(attrs=runs.attrs)


@made_once
def laws_study():
    """Three velocities by eight contact laws, with histories; some runs beyond a law's range."""
    varied = {"velocity": [0.1, 1.0, 10.0], "contact": list(LAWS)}
    design = design_of(varied, study="laws", method="grid", histories=1, profiles=0)
    runs = with_histories(with_answers(design)).drop_vars("equivalent_plastic_strain")
    runs["status"].loc[{"velocity": 10.0, "contact": "kogut_etsion"}] = OUTSIDE_CONTACT_LAW
    return runs, xr.Dataset(attrs=runs.attrs)


@made_once
def shear_study():
    """Two velocities by four depths, with and without shear: changes of 0.3 to 19 %."""
    varied = {
        "velocity": [0.25, 5.0],
        "beam_depth": [0.01, 0.02, 0.04, 0.08],
        "beam_model": ["euler_bernoulli", "timoshenko"],
    }
    design = design_of(varied, study="shear", method="grid", histories=0, profiles=0)
    runs = with_answers(design)
    part = xr.where(runs["beam_model"] == "timoshenko", 0.3 * runs["beam_depth"], 0.0)
    runs["peak_force"] = runs["peak_force"] * (1.0 - part)
    runs["contact_duration"] = runs["contact_duration"] * (1.0 + 8.0 * part)
    return described(runs), xr.Dataset(attrs=runs.attrs)


@made_once
def material_study():
    """Yield stress by hardening by Young's modulus, responses alone."""
    varied = {
        "beam_yield_stress": [250e6, 345e6, 450e6, 600e6],
        "beam_isotropic_hardening_modulus": [0.0, 1e9, 2e9],
        "beam_youngs_modulus": [200e9, 210e9],
    }
    design = design_of(varied, study="material", method="grid", histories=0, profiles=0)
    runs = with_answers(design.assign_coords(velocity=10.0))
    return runs, xr.Dataset(attrs=runs.attrs)


@made_once
def discretisation_study():
    """Nodes by points by rule at two velocities, with the verdicts of both convergences."""
    varied = {
        "velocity": [0.99, 15.0],
        "nodes": [101, 201, 401],
        "points": [3, 5, 9, 17],
        "rule": ["lobatto", "legendre", "layers"],
    }
    design = design_of(varied, study="discretisation", method="grid", histories=0, profiles=0)
    runs = with_answers(design)
    stacked = runs[list(RESPONSES)].to_array("response")
    strains = stacked["response"] == "peak_plastic_strain"
    endless = answers(design.assign_coords(nodes=1e9 + 0.0 * design["nodes"]))
    limit = xr.Dataset(endless).to_array("response").isel(nodes=-1, drop=True)
    finest, most = (0.0 * stacked.isel({dim: -1}, drop=True) for dim in ("nodes", "points"))
    names = ("converged", "not_yet_converged", "divergent")
    analysis = xr.Dataset(
        {
            "nodes_observed_order": finest + 2.0,
            "nodes_extrapolated": limit.where(~strains),
            "nodes_gci": finest + 1e-3,
            "nodes_uncertainty": finest + 2e-3,
            "nodes_behaviour": flags(finest + 2 * strains, "monotone", "stalled", "divergent"),
            "nodes_verdict": flags(finest + 2 * strains, *names),
            "nodes_summary": flags(2 * strains, *names),
            "points_error": abs(stacked / stacked.isel(points=-1, drop=True) - 1.0),
            "points_verdict": flags(most + strains, *names),
            "points_needed": most + 5.0,
            "points_uncertainty": most + 3e-3,
            "points_summary": flags(strains, *names),
        },
        attrs=runs.attrs,
    )
    return runs, analysis


@made_once
def time_step_study():
    """Courant by scheme by nodes: errors of second order in the time step about each limit."""
    varied = {"courant": [0.2, 0.4, 0.8], "scheme": ["leapfrog", "modal"], "nodes": [101, 201]}
    design = design_of(varied, study="time_step", method="grid", histories=0, profiles=0)
    runs = with_answers(design)
    limit = runs[list(RESPONSES)].to_array("response").isel(courant=0, drop=True)
    for name in RESPONSES:
        runs[name] = runs[name] * (1.0 + 1e-3 * runs["courant"] ** 2)
    names = ("converged", "divergent")
    analysis = xr.Dataset(
        {
            "time_step_observed_order": 0.0 * limit + 2.0,
            "time_step_extrapolated": limit,
            "time_step_uncertainty": 0.0 * limit + 1e-4,
            "time_step_verdict": flags(xr.zeros_like(limit), *names),
            "time_step_summary": flags(xr.zeros_like(limit[:, 0, 0]), *names),
        },
        attrs=runs.attrs,
    )
    return described(runs), analysis


@made_once
def sobol_study():
    """A sample of 256 runs in four parameters; number_of_contacts is constant."""
    random = np.random.default_rng(1)
    ranges = {
        "velocity": (1.0, 20.0),
        "beam_yield_stress": (250e6, 450e6),
        "beam_youngs_modulus": (200e9, 220e9),
        "sphere_radius": (0.03, 0.04),
    }
    varied: dict[str, Any] = {"run": np.arange(256)}
    for name, (low, high) in ranges.items():
        attrs = {"distribution": "uniform", "low": low, "high": high}
        varied[name] = ("run", random.uniform(low, high, 256), attrs)
    settings = {"base_samples": 32, "second_order": 1, "seed": 7, "histories": 0, "profiles": 0}
    runs = with_answers(design_of(varied, study="sobol", method="sobol", **settings))
    return runs, indices(runs, list(ranges)).assign(surrogates(runs))


@pytest.fixture
def failing():
    """A function that makes the runs at an index diverge: every variable NaN, status 1."""

    def fail(runs, where):
        broken = runs.copy(deep=True)
        for name, array in broken.data_vars.items():
            array[where] = 1 if name == "status" else np.nan
        return broken

    return fail


@pytest.fixture
def outcomes():
    """A check that passed, one with curves that failed in part, an error, and one of nothing."""
    good = Comparisons("at 1 m/s").relative("peak force", "N", 21064.7892, 21064.7221, 1e-4)
    good.absolute("deflection", "m", 1.2003e-3, 1.2e-3, 2e-6)
    good[:] = map(CLOSED_FORM.applied, good)
    good += [Comparison("curvature", "at 1 m/s", "m-1", 0.03, 0.031, 0.032, 0.1, "of the peak")]
    values = {f"case {i}": 100.0 + 0.01 * i for i in range(15)}
    values |= {"slightly off": 102.0, "far off": 300.0, "diverged": np.nan}
    bad: list[Comparison] = []
    for where, value in values.items():
        bad += Comparisons(where).relative("force", "N", value, 100.0, 0.01)
    time, nodes = np.linspace(0.0, 1e-3, 40), np.array([51.0, 101.0, 201.0])
    force = 2e4 * np.sin(3e3 * time)
    panels = [
        CurvePanel(
            "force at 1 m/s",
            ("time", "s"),
            ("contact force", "N"),
            [Curve("201 nodes", time, force), Curve("series", time, 1.01 * force, True)],
        ),
        CurvePanel(
            "error",
            ("nodes", "1"),
            ("error of the contact force over its largest value", "1"),
            [Curve("force", nodes, 5 / nodes**2), Curve("second order", nodes, 8 / nodes**2, True)],
            log=True,
        ),
    ]
    return [
        Outcome(
            "good",
            "A good check",
            "Hertz 1881",
            0.25,
            Finding(good),
            reference="closed form",
            basis="rounding",
        ),
        Outcome("bad", "A bad check", "a series & more", 1.5, Finding(bad, panels)),
        Outcome("broken", "A broken check", "a book", 0.5, Finding(()), "ValueError: <no> (a.py)"),
        Outcome("void", "A check of nothing", "nowhere", 0.0, Finding(())),
    ]


@pytest.fixture
def findings(outcomes):
    """The outcomes as findings.nc holds them."""
    given = ATTRIBUTES | {"study": "verification", "title": "The verification"}
    return packed(outcomes).assign_attrs(given | {"kernels_sha256": "1" * 64})
