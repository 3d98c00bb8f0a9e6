"""Made-up runs and analyses in the form of stored ones: of plausible size, not physics."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import flatten
from impactlab.variables import RESPONSES, described

ATTRIBUTES = {
    "description": "Made up for the tests.",
    "study_text": "base: paper\n",
    "study_sha256": "0" * 64,
    "created": "2000-01-01T00:00:00+00:00",
    "versions": "impactlab 0.1.0, numpy 2.0.0, python 3.11.7",
    "source_revision": "0123456789ab",
    "processor": "a processor, 2 cores",
}


def made_once(build: Callable[[], tuple[xr.Dataset, xr.Dataset]]) -> Any:
    """Make a fixture: a study that is made once per process, and copied for each test."""
    made = cache(build)
    return pytest.fixture(name=build.__name__)(
        lambda: tuple(each.copy(deep=True) for each in made())
    )


def _fixed(varied: Mapping[str, Any]) -> dict[str, Any]:
    values = flatten(paper_impact(), Discretisation())
    return {name: value for name, value in values.items() if name not in varied} | {
        "duration": 4e-3
    }


def design_of(varied: Mapping[str, Any], **attrs: Any) -> xr.Dataset:
    """Return a dataset of coordinates with the attributes of a design."""
    names = [name for name in varied if name != "run"]
    given = {"varied": names, "responses": list(RESPONSES), "history_samples": 400} | ATTRIBUTES
    title = f"The {attrs['study']} study"
    return xr.Dataset(coords={**varied, **_fixed(varied)}, attrs=given | {"title": title} | attrs)


FEW = ["peak_force", "peak_plastic_strain", "impulse", "number_of_contacts"]


def few(study: tuple[xr.Dataset, xr.Dataset], *further: str) -> tuple[xr.Dataset, xr.Dataset]:
    """Return a study with few responses, whose report is quicker than that of all 17."""
    runs, analysis = study
    names = [*FEW, *further]
    others = [name for name in runs.attrs["responses"] if name not in names]
    runs = runs.drop_vars(others).assign_attrs(responses=names)
    return runs, analysis.sel(response=names) if "response" in analysis.dims else analysis


def answers(design: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return every response, smooth in velocity, yield stress, modulus and nodes, in SI.

    A response without a line of its own follows the base.
    """
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
    found = dict.fromkeys(RESPONSES, base) | {
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


def with_answers(design: xr.Dataset) -> xr.Dataset:
    """Return the runs of a design, with every response and no failures."""
    found = answers(design)
    status = xr.zeros_like(found["peak_force"], dtype=np.int32)
    return described(design.assign(found | {"status": status}))


def with_histories(runs: xr.Dataset) -> xr.Dataset:
    """Add a pulse and a smaller one after a gap, and PEEQ around mid-span."""
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


def flags(codes: xr.DataArray, *names: str) -> xr.DataArray:
    """Return verdicts with CF flags; the first is the sound one."""
    attrs = {
        "flag_values": np.arange(len(names), dtype=np.int8),
        "flag_meanings": " ".join(names),
        "sound_flags": names[0],
        "flag_descriptions": "\n".join(f"{name}: meaning of {name}" for name in names),
    }
    return codes.astype(np.int8).assign_attrs(attrs)


def indices(runs: xr.Dataset, parameters: list[str]) -> xr.Dataset:
    """Return indices: 71 % from the velocity, 12 % from the yield stress, noise below zero."""
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
        "sensitivity_verdict": flags(verdict, "usable", "constant", "failed_runs"),
    }
    coords: dict[str, Any] = {"response": list(RESPONSES)}
    coords |= {"parameter": parameters, "other_parameter": parameters}
    long_names = [runs[name].attrs["long_name"] for name in parameters]
    coords["parameter_long_name"] = ("parameter", long_names)
    return xr.Dataset(variables, coords, runs.attrs)


def surrogates(runs: xr.Dataset) -> dict[str, Any]:
    """Return tests on every fifth run, 1 % off, but of the constant response."""
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
        "surrogate_q2_low": ("response", np.where(constant, np.nan, 0.98)),
        "surrogate_rmse": ("response", np.where(constant, np.nan, 0.01)),
        "surrogate_verdict": flags(verdict, "usable", "constant", "poor"),
    }
