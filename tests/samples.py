"""Sample studies made up after the data contract, with every variable that an analysis may give."""

from typing import Any

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import flatten
from impactlab.variables import RESPONSES, STATUS_FLAGS, described

RANGES = {
    "velocity": (5.0, 15.0),
    "beam_yield_stress": (270e6, 420e6),
    "beam_isotropic_hardening_modulus": (0.0, 3e9),
    "beam_kinematic_hardening_modulus": (0.0, 3e9),
    "beam_youngs_modulus": (190e9, 230e9),
    "beam_depth": (26.4e-3, 29.2e-3),
    "beam_width": (57e-3, 63e-3),
    "sphere_radius": (33e-3, 37e-3),
    "sphere_yield_stress": (2.3e9, 2.8e9),
}
ASKED = (
    "peak_force",
    "contact_duration",
    "number_of_contacts",
    "maximum_deflection",
    "peak_plastic_strain",
    "remote_plastic_strain",
    "plastic_zone_length",
    "plastic_dissipation",
)
TIMES = np.linspace(0.0, 1e-3, 60)
VERDICTS = ("usable", "mostly_constant", "constant", "failed_runs")
_PAIR = ("response", "parameter")
_PLAIN = ("first_order", "total_order", "delta", "delta_first_order", "pawn", "pawn_maximum")
_DUMMIES = (*_PLAIN, "regression", "rank_regression")


def sample(count: int = 512, parameters: int = 9, *, failures: int = 0) -> xr.Dataset:
    """Runs of a Sobol study: smooth answers, one with jumps, one mostly zero; the fastest fail."""
    random = np.random.default_rng(1)
    names = list(RANGES)[:parameters]
    unit = random.uniform(size=(count, parameters))
    varied: dict[str, Any] = {"run": np.arange(count)}
    for at, name in enumerate(names):
        low, high = RANGES[name]
        given = {"distribution": "uniform", "low": low, "high": high}
        varied[name] = ("run", low + unit[:, at] * (high - low), given)
    fixed = flatten(paper_impact(), Discretisation(nodes=101))
    scalars = {name: value for name, value in fixed.items() if name not in varied}
    status = np.zeros(count, dtype=np.int32)
    status[np.argsort(unit[:, 0])[count - failures :]] = STATUS_FLAGS["diverged"][0]
    answers = {
        name: ("run", np.where(status == 0, values, np.nan))
        for name, values in _answers(unit).items()
    }
    attrs = {
        "study": "sample",
        "title": "Sensitivity of the impact",
        "description": "Made up for the tests.",
        "study_text": "base: paper\n",
        "created": "2000-01-01T00:00:00+00:00",
        "method": "sobol",
        "varied": names,
        "responses": list(ASKED),
        "base_samples": 32,
        "second_order": 1,
        "seed": 0,
    }
    coords = varied | scalars | {"duration": 8e-3}
    return described(xr.Dataset(answers | {"status": ("run", status)}, coords, attrs))


def _answers(unit: np.ndarray) -> dict[str, np.ndarray]:
    speed, stress = unit[:, 0], unit[:, 1]
    others = unit[:, 2:].mean(axis=1)
    smooth = 1.0 + speed + 0.3 * stress * speed + 0.1 * others
    strain = np.maximum(speed - 0.2 * stress - 0.5, 0.0)
    return {
        "peak_force": 2e4 * smooth,
        "contact_duration": 4e-4 * smooth**-0.2,
        "number_of_contacts": 2.0 + (speed > 0.6) + (stress > 0.9),
        "maximum_deflection": 4e-3 * smooth,
        "peak_plastic_strain": 0.02 * strain,
        "remote_plastic_strain": np.where(speed > 0.95, 1e-3 * speed, 0.0),
        "plastic_zone_length": 0.05 * smooth,
        "plastic_dissipation": 12.0 * smooth**2,
    }


def indices(runs: xr.Dataset, parameters: list[str] | None = None) -> xr.Dataset:
    """Every variable of the contract: the velocity leads, noise below zero comes last.

    The first order of the peak force is 0.71 ± 0.03, 0.12 ± 0.03 and noise; its dummy 0.01 ± 0.02.
    Remote plastic strain is mostly constant. parameters: those of the runs, or their groups.
    """
    random = np.random.default_rng(2)
    names = parameters or [str(name) for name in np.atleast_1d(runs.attrs["varied"])]
    asked = [name for name in RESPONSES if name in runs.data_vars]
    shape = len(asked), len(names)
    lead = np.zeros(shape)
    lead[:, :2] = [0.71, 0.12]
    noise = 0.005 * random.standard_normal(shape)
    data: dict[str, Any] = {}

    def put(name: str, values: np.ndarray, half: float, dims: tuple[str, ...] = _PAIR) -> None:
        data[name] = (dims, values)
        data[f"{name}_interval"] = (dims, np.full_like(values, half), {"confidence": 0.95})

    put("first_order", lead + noise, 0.03)
    put("total_order", 1.1 * lead + 0.01 + noise, 0.04)
    for name in ("delta", "delta_first_order", "pawn"):
        put(name, 0.5 * lead + 0.03 + np.abs(noise), 0.02)
    data["pawn_maximum"] = (_PAIR, 0.8 * lead + 0.05)
    for name, sign in (("regression", -1.0), ("rank_regression", 1.0)):
        put(name, sign * np.sqrt(lead) + noise, 0.02)
        data[f"{name}_r_squared"] = ("response", np.full(shape[0], 0.85))
    for name in _DUMMIES:
        put(f"dummy_{name}", np.full(shape[0], 0.01), 0.02, ("response",))
    put("surrogate_first_order", lead, 0.02)
    put("surrogate_total_order", 1.1 * lead, 0.02)
    data["surrogate_q2"] = ("response", np.full(shape[0], 0.97))
    data["surrogate_q2_low"] = ("response", np.full(shape[0], 0.95))
    data["surrogate_rmse"] = ("response", np.full(shape[0], 0.1))
    size = np.array([float(np.nanmax(np.abs(runs[name]))) for name in asked])[:, None]
    put("morris_mu_star", size * (lead + 0.01), 1.0)
    data["morris_mu_star_interval"] = (_PAIR, 0.02 * size * np.ones(shape), {"confidence": 0.95})
    data["morris_mu"] = data["morris_mu_star"]
    data["morris_sigma"] = (_PAIR, 0.3 * size * (lead + 0.01))
    data |= _second(shape) | _nested(lead, noise)
    data |= {
        "numerical_uncertainty": ("response", np.full(shape[0], 0.005)),
        "numerical_share": ("response", np.full(shape[0], 0.002)),
        "first_order_numerical": (_PAIR, np.full(shape, 0.02)),
        "total_order_numerical": (_PAIR, np.full(shape, 0.02)),
        "imputed_share": ("response", np.zeros(shape[0])),
        "sensitivity_verdict": _verdicts(asked),
    }
    data |= _over_time(lead[0])
    coords: dict[str, Any] = {"response": asked, "parameter": names, "other_parameter": names}
    long_names = [runs[name].attrs["long_name"] if name in runs else name for name in names]
    coords["parameter_long_name"] = ("parameter", long_names)
    coords |= {
        "history": ["contact_force", "midspan_deflection"],
        "history_units": ("history", ["N", "m"]),
        "time": ("time", TIMES, {"units": "s"}),
    }
    nested = {"base_samples": [1, 2, 4, 8, 16, 32]}
    return xr.Dataset(data, coords | nested, runs.attrs)


def _over_time(lead: np.ndarray) -> dict[str, Any]:
    """A pulse of force, whose deviation is a tenth; the deflection is left with few runs."""
    dims, pulse = ("history", "time", "parameter"), np.maximum(np.sin(TIMES / 2e-4), 0.0)
    within = np.where(pulse > 0, 1.0, np.nan)[:, None]
    data: dict[str, Any] = {}
    for name, scale in (("first_order", 1.0), ("total_order", 1.1)):
        values = np.stack([scale * lead * within] * 2)
        data[f"{name}_over_time"] = dims, values
        data[f"{name}_over_time_interval"] = dims, np.full_like(values, 0.05)
        data[f"generalised_{name}"] = ("history", "parameter"), np.stack([scale * lead] * 2)
        half = np.full((2, lead.size), 0.03)
        data[f"generalised_{name}_interval"] = ("history", "parameter"), half
    mean = np.stack([2e4 * pulse, 4e-3 * pulse])
    judged = {"flag_values": np.arange(2, dtype=np.int8), "sound_flags": "usable"}
    told = "runs_left_out: runs failed"
    return data | {
        "history_mean": (dims[:2], mean),
        "history_deviation": (dims[:2], 0.1 * mean),
        "base_samples_left_out": ("history", [0, 3]),
        "time_verdict": (dims[:2], np.stack([np.where(pulse > 0, 0, 2)] * 2)),
        "history_verdict": (
            "history",
            np.array([0, 1], np.int8),
            judged | {"flag_meanings": "usable runs_left_out", "flag_descriptions": told},
        ),
    }


def _second(shape: tuple[int, int]) -> dict[str, Any]:
    dims = (*_PAIR, "other_parameter")
    values = np.full((*shape, shape[1]), np.nan)
    rows, columns = np.triu_indices(shape[1], 1)
    values[:, rows, columns] = values[:, columns, rows] = 0.002
    values[:, 0, 1] = values[:, 1, 0] = 0.07
    half = np.where(np.isfinite(values), 0.02, np.nan)
    return {"second_order": (dims, values), "second_order_interval": (dims, half)}


def _nested(lead: np.ndarray, noise: np.ndarray) -> dict[str, Any]:
    dims = ("response", "base_samples", "parameter")
    samples = np.array([1, 2, 4, 8, 16, 32])[:, None]
    found: dict[str, Any] = {}
    for name, scale in (("first_order", 1.0), ("total_order", 1.1)):
        values = scale * lead[:, None] + 5 * noise[:, None] / np.sqrt(samples)
        found[f"{name}_by_samples"] = (dims, values)
        half = np.broadcast_to(0.17 / np.sqrt(samples), values.shape)
        found[f"{name}_by_samples_interval"] = (dims, half)
    return found


def _verdicts(asked: list[str]) -> xr.DataArray:
    codes = [1 if name == "remote_plastic_strain" else 0 for name in asked]
    attrs = {
        "flag_values": np.arange(len(VERDICTS), dtype=np.int8),
        "flag_meanings": " ".join(VERDICTS),
        "sound_flags": "usable",
        "flag_descriptions": "\n".join(f"{name}: meaning of {name}" for name in VERDICTS),
    }
    return xr.DataArray(np.array(codes, dtype=np.int8), dims="response", attrs=attrs)
