"""Stored studies made up after the data contract: small, quick, of plausible size, not physics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.dataset import RESPONSES, described
from impactlab.kernels.contact import LAWS
from impactlab.kernels.status import OUTSIDE_CONTACT_LAW
from impactlab.model.discretisation import Discretisation
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import flatten
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, absolute, relative
from impactlab.verification.outcome import Outcome
from impactlab.verification.stored import packed

Study = tuple[xr.Dataset, xr.Dataset]
ATTRIBUTES = {
    "description": "Made up for the tests.",
    "study_text": "base: paper\n",
    "study_sha256": "0" * 64,
    "created": "2000-01-01T00:00:00+00:00",
    "versions": "impactlab 0.1.0, numpy 2.0.0, python 3.11.7",
    "source_revision": "0123456789ab",
    "processor": "a processor, 2 cores",
}


def _fixed(varied: Mapping[str, Any]) -> dict[str, Any]:
    values = flatten(paper_impact(), Discretisation())
    return {name: value for name, value in values.items() if name not in varied} | {
        "duration": 4e-3
    }


def _design(varied: Mapping[str, Any], **attrs: Any) -> xr.Dataset:
    """A dataset of coordinates with the contract's attributes."""
    names = [name for name in varied if name != "run"]
    given = {"varied": names, "responses": list(RESPONSES), "history_samples": 400} | ATTRIBUTES
    title = f"The {attrs['study']} study"
    return xr.Dataset(coords={**varied, **_fixed(varied)}, attrs=given | {"title": title} | attrs)


def _answers(design: xr.Dataset) -> dict[str, xr.DataArray]:
    """Every response, smooth in velocity, yield stress, modulus and nodes, in SI."""
    whole = xr.DataArray(np.empty(tuple(design.sizes.values())), dims=tuple(design.sizes))
    velocity = design["velocity"]
    size = (design["beam_yield_stress"] / 345e6) ** 0.1 * (design["beam_youngs_modulus"] / 210e9)
    rule = xr.where(design["rule"] == "lobatto", 0.5, 0.0) + xr.where(
        design["rule"] == "layers", 2.0, 0.1
    )
    error = 1.0 + (300.0 + 20.0 * velocity) / design["nodes"] ** 2.0 / design["points"]
    error = error * (1.0 + rule / design["points"] ** 3.0)
    error = error * (1.0 + 1e-11 * design["beam_isotropic_hardening_modulus"])
    softer = xr.where(design["contact"] == "hertz", 1.2, 1.0)
    base = velocity * size * error * softer
    plastic = (base - 5.0).clip(min=0.0) * 1e-3
    found = {
        "peak_force": 8e3 * base,
        "time_of_peak_force": 1.5e-4 * base**-0.2,
        "contact_duration": 4e-4 * base**-0.2,
        "number_of_contacts": 0.0 * base + 2.0,
        "total_contact_time": 6e-4 * base**-0.1,
        "maximum_indentation": 3e-5 * base**0.8,
        "permanent_indentation": 1e-5 * base**0.9,
        "maximum_deflection": 4e-4 * base,
        "impulse": 1.8 * base,
        "rebound_velocity": 0.4 * base**0.75,
        "restitution": 0.4 * base**-0.25,
        "peak_plastic_strain": plastic * design["nodes"] / 201.0,
        "remote_plastic_strain": 0.1 * plastic,
        "plastic_zone_length": 2.0 * plastic,
        "contact_dissipation": 0.2 * base**2,
        "plastic_dissipation": 0.01 * plastic,
        "energy_error": 2e-5 * base / base,
    }
    return {
        name: array.broadcast_like(whole).transpose(*design.sizes) for name, array in found.items()
    }


def _with_answers(design: xr.Dataset) -> xr.Dataset:
    answers = _answers(design)
    status = xr.zeros_like(answers["peak_force"], dtype=np.int32)
    return described(design.assign(answers | {"status": status}))


def _with_histories(runs: xr.Dataset) -> xr.Dataset:
    """A pulse and a smaller one after a gap; PEEQ around mid-span."""
    time = xr.DataArray(np.linspace(0.0, 4e-3, 401), dims="time")
    x = xr.DataArray(np.linspace(0.0, 0.78, 201), dims="x")
    z = xr.DataArray(np.linspace(-0.0139, 0.0139, 9), dims="z")
    phase = time / runs["contact_duration"]
    pulse = np.sin(np.pi * phase).where(phase < 1.0, 0.0)
    second = 0.4 * np.sin(np.pi * (phase - 2.0)).where((phase > 2.0) & (phase < 3.0), 0.0)
    force = runs["peak_force"] * (pulse + second).clip(min=0.0)
    indentation = runs["maximum_indentation"] * (force / runs["peak_force"]) ** 0.6
    indentation = indentation - 1e-5 * (force == 0) * (time > 0)
    bump = np.exp(-((abs(x - 0.39) / 0.02) ** 0.9)) * (z / 0.0139) ** 2
    strain = runs["peak_plastic_strain"] * bump.where(bump > 1e-4, 0.0)
    order = (*runs["status"].dims, "time")
    fields = {
        "contact_force": force.transpose(*order),
        "indentation": indentation.transpose(*order),
        "midspan_deflection": (runs["maximum_deflection"] * np.sin(300.0 * time)).transpose(*order),
        "sphere_displacement": (runs["velocity"] * time).broadcast_like(force).transpose(*order),
        "equivalent_plastic_strain": strain.transpose(*runs["status"].dims, "x", "z"),
    }
    return described(runs.assign(fields).assign_coords(time=time, x=x, z=z))


def _flags(codes: xr.DataArray, *names: str) -> xr.DataArray:
    """Verdicts with CF flags; the first is the sound one."""
    attrs = {
        "flag_values": np.arange(len(names), dtype=np.int8),
        "flag_meanings": " ".join(names),
        "sound_flags": names[0],
        "flag_descriptions": "\n".join(f"{name}: meaning of {name}" for name in names),
    }
    return codes.astype(np.int8).assign_attrs(attrs)


@pytest.fixture
def velocity_study() -> Study:
    """Eight velocities by two contact laws, with histories and profiles."""
    varied = {
        "velocity": [0.25, 0.99, 2.0, 5.0, 7.5, 10.0, 15.0, 20.0],
        "contact": ["hertz", "stronge"],
    }
    design = _design(varied, study="velocity", method="grid", histories=1, profiles=1)
    runs = _with_histories(_with_answers(design))
    return runs, xr.Dataset(attrs=runs.attrs)


@pytest.fixture
def laws_study() -> Study:
    """Three velocities by eight contact laws, with histories; some runs beyond a law's range."""
    varied = {"velocity": [0.1, 1.0, 10.0], "contact": list(LAWS)}
    design = _design(varied, study="laws", method="grid", histories=1, profiles=0)
    runs = _with_histories(_with_answers(design)).drop_vars("equivalent_plastic_strain")
    runs["status"].loc[{"velocity": 10.0, "contact": "kogut_etsion"}] = OUTSIDE_CONTACT_LAW
    return runs, xr.Dataset(attrs=runs.attrs)


@pytest.fixture
def shear_study() -> Study:
    """Two velocities by four depths, with and without shear: changes of 0.3 to 19 %."""
    varied = {
        "velocity": [0.25, 5.0],
        "beam_depth": [0.01, 0.02, 0.04, 0.08],
        "beam_model": ["euler_bernoulli", "timoshenko"],
    }
    design = _design(varied, study="shear", method="grid", histories=0, profiles=0)
    runs = _with_answers(design)
    part = xr.where(runs["beam_model"] == "timoshenko", 0.3 * runs["beam_depth"], 0.0)
    runs["peak_force"] = runs["peak_force"] * (1.0 - part)
    runs["contact_duration"] = runs["contact_duration"] * (1.0 + 8.0 * part)
    return described(runs), xr.Dataset(attrs=runs.attrs)


@pytest.fixture
def material_study() -> Study:
    """Yield stress by hardening by Young's modulus, responses alone."""
    varied = {
        "beam_yield_stress": [250e6, 345e6, 450e6, 600e6],
        "beam_isotropic_hardening_modulus": [0.0, 1e9, 2e9],
        "beam_youngs_modulus": [200e9, 210e9],
    }
    design = _design(varied, study="material", method="grid", histories=0, profiles=0)
    runs = _with_answers(design.assign_coords(velocity=10.0))
    return runs, xr.Dataset(attrs=runs.attrs)


@pytest.fixture
def discretisation_study() -> Study:
    """Nodes by points by rule at two velocities, with the verdicts of both convergences."""
    varied = {
        "velocity": [0.99, 15.0],
        "nodes": [101, 201, 401],
        "points": [3, 5, 9, 17],
        "rule": ["lobatto", "legendre", "layers"],
    }
    design = _design(varied, study="discretisation", method="grid", histories=0, profiles=0)
    runs = _with_answers(design)
    stacked = runs[list(RESPONSES)].to_array("response")
    strains = stacked["response"] == "peak_plastic_strain"
    endless = _answers(design.assign_coords(nodes=1e9 + 0.0 * design["nodes"]))
    limit = xr.Dataset(endless).to_array("response").isel(nodes=-1, drop=True)
    finest, most = (0.0 * stacked.isel({dim: -1}, drop=True) for dim in ("nodes", "points"))
    names = ("converged", "not_yet_converged", "divergent")
    analysis = xr.Dataset(
        {
            "nodes_observed_order": finest + 2.0,
            "nodes_extrapolated": limit.where(~strains),
            "nodes_gci": finest + 1e-3,
            "nodes_uncertainty": finest + 2e-3,
            "nodes_behaviour": _flags(finest + 2 * strains, "monotone", "stalled", "divergent"),
            "nodes_verdict": _flags(finest + 2 * strains, *names),
            "nodes_summary": _flags(2 * strains, *names),
            "points_error": abs(stacked / stacked.isel(points=-1, drop=True) - 1.0),
            "points_verdict": _flags(most + strains, *names),
            "points_needed": most + 5.0,
            "points_summary": _flags(strains, *names),
        },
        attrs=runs.attrs,
    )
    return runs, analysis


@pytest.fixture
def time_step_study() -> Study:
    """Courant by scheme by nodes: errors of second order in the time step about each limit."""
    varied = {
        "courant": [0.2, 0.4, 0.8],
        "scheme": ["leapfrog", "semi_implicit"],
        "nodes": [101, 201],
    }
    design = _design(varied, study="time_step", method="grid", histories=0, profiles=0)
    runs = _with_answers(design)
    limit = runs[list(RESPONSES)].to_array("response").isel(courant=0, drop=True)
    for name in RESPONSES:
        runs[name] = runs[name] * (1.0 + 1e-3 * runs["courant"] ** 2)
    names = ("converged", "divergent")
    analysis = xr.Dataset(
        {
            "time_step_observed_order": 0.0 * limit + 2.0,
            "time_step_extrapolated": limit,
            "time_step_uncertainty": 0.0 * limit + 1e-4,
            "time_step_summary": _flags(xr.zeros_like(limit[:, 0, 0]), *names),
        },
        attrs=runs.attrs,
    )
    return described(runs), analysis


@pytest.fixture
def sobol_study() -> Study:
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
    runs = _with_answers(_design(varied, study="sobol", method="sobol", **settings))
    return runs, _indices(runs, list(ranges)).assign(_surrogates(runs))


def _indices(runs: xr.Dataset, parameters: list[str]) -> xr.Dataset:
    """71 % from the velocity, 12 % from the yield stress, a little noise below zero."""
    count = len(RESPONSES)
    first = np.tile([0.71, 0.12, -0.01, 0.005], (count, 1))
    total = np.tile([0.80, 0.19, 0.02, 0.01], (count, 1))
    second = np.full((count, 4, 4), np.nan)
    second[:, 0, 1], second[:, 0, 2], second[:, 0, 3] = 0.07, -0.01, 0.004
    second[:, 1, 2], second[:, 1, 3], second[:, 2, 3] = 0.01, 0.002, -0.003
    constant = np.array([name == "number_of_contacts" for name in RESPONSES])
    first[constant] = total[constant] = second[constant] = np.nan
    pair = ("response", "parameter", "other_parameter")
    verdict = xr.DataArray(constant, dims="response")
    variables: dict[str, Any] = {
        "first_order": (pair[:2], first),
        "first_order_interval": (pair[:2], np.full_like(first, 0.03)),
        "total_order": (pair[:2], total),
        "total_order_interval": (pair[:2], np.full_like(total, 0.04)),
        "second_order": (pair, second),
        "second_order_interval": (pair, np.full_like(second, 0.02)),
        "sensitivity_verdict": _flags(verdict, "usable", "constant", "failed_runs"),
    }
    coords = {"response": list(RESPONSES), "parameter": parameters, "other_parameter": parameters}
    return xr.Dataset(variables, coords, runs.attrs)


def _surrogates(runs: xr.Dataset) -> dict[str, Any]:
    """Tests on every fifth run, 1 % off; none of the constant response."""
    constant = xr.DataArray([name == "number_of_contacts" for name in RESPONSES], dims="response")
    tested = runs[list(RESPONSES)].isel(run=slice(0, None, 5)).to_array("response")
    off = 1.0 + 0.01 * (-1.0) ** tested["run"]
    verdict = constant.astype(int)
    return {
        "surrogate_held_out": (
            ("response", "held_out"),
            (tested * off).where(~constant).transpose("response", "run").values,
        ),
        "held_out": tested["run"].values,
        "surrogate_q2": ("response", np.where(constant, np.nan, 0.9876)),
        "surrogate_verdict": _flags(verdict, "usable", "constant", "poor"),
    }


@pytest.fixture
def failing() -> Callable[[xr.Dataset, dict[str, int]], xr.Dataset]:
    """A function that makes the runs at an index diverge: every variable NaN, status 1."""

    def fail(runs: xr.Dataset, where: dict[str, int]) -> xr.Dataset:
        broken = runs.copy(deep=True)
        for name, array in broken.data_vars.items():
            array[where] = 1 if name == "status" else np.nan
        return broken

    return fail


@pytest.fixture
def outcomes() -> list[Outcome]:
    """A check that passed, one with curves that failed in part, an error, and one of nothing."""
    good = [
        relative("peak force", "at 1 m/s", "N", 21064.7892, 21064.7221, 1e-4),
        absolute("deflection", "at 1 m/s", "m", 1.2003e-3, 1.2e-3, 2e-6),
        Comparison("curvature", "at 1 m/s", "m-1", 0.03, 0.031, 0.032, 0.1, "of the peak"),
    ]
    bad = [relative("force", f"case {i}", "N", 100.0 + 0.01 * i, 100.0, 0.01) for i in range(15)]
    bad += [relative("force", "slightly off", "N", 102.0, 100.0, 0.01)]
    bad += [relative("force", "far off", "N", 300.0, 100.0, 0.01)]
    bad += [relative("force", "diverged", "N", np.nan, 100.0, 0.01)]
    time, nodes = np.linspace(0.0, 1e-3, 40), np.array([51.0, 101.0, 201.0])
    force = 2e4 * np.sin(3e3 * time)
    panels = [
        Panel(
            "force at 1 m/s",
            ("time", "s"),
            ("contact force", "N"),
            [Curve("201 nodes", time, force), Curve("series", time, 1.01 * force, True)],
        ),
        Panel(
            "error",
            ("nodes", "1"),
            ("error of the contact force over its largest value", "1"),
            [Curve("force", nodes, 5 / nodes**2), Curve("second order", nodes, 8 / nodes**2, True)],
            log=True,
        ),
    ]
    return [
        Outcome("good", "A good check", "Hertz 1881", 0.25, Finding(good)),
        Outcome("bad", "A bad check", "a series & more", 1.5, Finding(bad, panels)),
        Outcome("broken", "A broken check", "a book", 0.5, Finding(()), "ValueError: <no> (a.py)"),
        Outcome("void", "A check of nothing", "nowhere", 0.0, Finding(())),
    ]


@pytest.fixture
def findings(outcomes: list[Outcome]) -> xr.Dataset:
    """The outcomes as findings.nc holds them."""
    given = ATTRIBUTES | {"study": "verification", "title": "The verification"}
    return packed(outcomes).assign_attrs(given | {"kernels_sha256": "1" * 64})
