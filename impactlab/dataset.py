"""The table of every variable in impactlab's datasets, their encoding, and their provenance."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from impactlab.kernels import status
from impactlab.model.parameters import PARAMETERS

if TYPE_CHECKING:
    import xarray as xr

STATUS_FLAGS: dict[str, tuple[int, str]] = {
    "diverged": (status.DIVERGED, "the run diverged; every response is missing"),
    "first_contact_unfinished": (
        status.FIRST_CONTACT_UNFINISHED,
        "the duration ends before the first contact does",
    ),
    "in_contact_at_end": (
        status.IN_CONTACT_AT_END,
        "the duration ends while sphere and beam are in contact",
    ),
    "sphere_not_leaving": (
        status.SPHERE_NOT_LEAVING,
        "the duration ends before the sphere moves upwards and away from the beam",
    ),
    "deflection_still_growing": (
        status.DEFLECTION_STILL_GROWING,
        "the largest deflection falls on the end of the duration",
    ),
    "indentation_still_growing": (
        status.INDENTATION_STILL_GROWING,
        "the largest indentation falls on the end of the duration",
    ),
    "energy_out_of_balance": (
        status.ENERGY_OUT_OF_BALANCE,
        "energy is out of balance by more than 5 %: take more nodes or a smaller courant",
    ),
}
"""Reasons for a missing response, by name: (bit in `status`, in words)."""


@dataclass(frozen=True)
class Variable:
    """One dataset variable: where it lives, its unit (UDUNITS) and its meaning.

    missing: the status flag that explains why a response is NaN (besides those of the whole run).
    """

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    missing: str | None = None


def _response(name: str, units: str, long_name: str, missing: str | None = None) -> Variable:
    return Variable(name, (), units, long_name, missing)


RESPONSES: dict[str, Variable] = {
    entry.name: entry
    for entry in (
        _response("peak_force", "N", "largest contact force", "indentation_still_growing"),
        _response(
            "time_of_peak_force",
            "s",
            "time of the largest contact force",
            "indentation_still_growing",
        ),
        _response(
            "contact_duration", "s", "duration of the first contact", "first_contact_unfinished"
        ),
        _response("number_of_contacts", "1", "contacts begun within the duration"),
        _response("total_contact_time", "s", "time in contact, all contacts", "in_contact_at_end"),
        _response("maximum_indentation", "m", "largest indentation", "indentation_still_growing"),
        _response(
            "permanent_indentation",
            "m",
            "indentation left after the last contact",
            "in_contact_at_end",
        ),
        _response(
            "maximum_deflection", "m", "largest mid-span deflection", "deflection_still_growing"
        ),
        _response(
            "impulse", "N s", "impulse of the contact force, all contacts", "in_contact_at_end"
        ),
        _response(
            "rebound_velocity",
            "m s-1",
            "sphere's velocity away from the beam when the last contact ends",
            "sphere_not_leaving",
        ),
        _response(
            "restitution",
            "1",
            "coefficient of restitution (rebound over impact velocity)",
            "sphere_not_leaving",
        ),
        _response("peak_plastic_strain", "1", "largest equivalent plastic strain (PEEQ)"),
        _response(
            "remote_plastic_strain",
            "1",
            "largest PEEQ farther than one beam depth from the impact",
        ),
        _response(
            "plastic_zone_length", "m", "length of beam with a PEEQ above 1e-5 in the section"
        ),
        _response(
            "contact_dissipation", "J", "energy dissipated in the contact", "in_contact_at_end"
        ),
        _response("plastic_dissipation", "J", "energy dissipated in the fibres"),
        _response("energy_error", "1", "largest energy imbalance over the initial kinetic energy"),
    )
}
"""The scalar answers of a run, by name."""

_TIME = (
    Variable("contact_force", ("time",), "N", "contact force"),
    Variable("midspan_deflection", ("time",), "m", "deflection of the beam at mid-span"),
    Variable("midspan_curvature", ("time",), "m-1", "curvature w_xx of the beam at mid-span"),
    Variable("sphere_displacement", ("time",), "m", "displacement of the sphere since first touch"),
    Variable("indentation", ("time",), "m", "indentation (approach of sphere and beam axis)"),
)
_FIELDS = (
    Variable("equivalent_plastic_strain", ("x", "z"), "1", "equivalent plastic strain (PEEQ)"),
    Variable("plastic_strain", ("x", "z"), "1", "plastic strain along the beam"),
    Variable("deflection", ("x",), "m", "deflection at the end of the duration"),
)
ANALYSES: dict[str, str] = {
    "convergence_in_nodes": "a grid that varies `nodes` over at least 3 values",
    "convergence_in_points": "a grid that varies `points` over at least 2 values",
    "sensitivity": "a sample (method: sobol)",
}
"""Names of the analyses (modules of impactlab.analysis), and what runs each one needs."""

HISTORIES: dict[str, Variable] = {entry.name: entry for entry in _TIME}
"""Answers on `time`, by name."""
PROFILES: dict[str, Variable] = {entry.name: entry for entry in _FIELDS}
"""Answers along the beam at the end of the run, by name."""

COORDINATES: dict[str, Variable] = {
    "time": Variable("time", ("time",), "s", "time since first touch"),
    "x": Variable("x", ("x",), "m", "distance from the left support"),
    "z": Variable("z", ("z",), "m", "distance below the beam's axis"),
    "duration": Variable("duration", (), "s", "simulated time"),
}
VARIABLES = RESPONSES | HISTORIES | PROFILES | COORDINATES
"""Every variable but `status` and the varied parameters (for these see PARAMETERS)."""


def attributes(name: str) -> dict[str, Any]:
    """CF attributes of a variable, a parameter or `status`. Raises KeyError if unknown."""
    if name == "status":
        return {
            "long_name": "why responses are missing (0: none is)",
            "flag_masks": np.array([bit for bit, _ in STATUS_FLAGS.values()], dtype=np.int32),
            "flag_meanings": " ".join(STATUS_FLAGS),
        }
    entry = VARIABLES[name] if name in VARIABLES else PARAMETERS[name]
    attrs: dict[str, Any] = {"units": entry.units, "long_name": entry.long_name}
    if isinstance(entry, Variable) and entry.missing:
        attrs["missing_because"] = f"diverged energy_out_of_balance {entry.missing}"
    return attrs


def described(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with the attributes of the table on every variable that the table knows."""
    known = VARIABLES | PARAMETERS | {"status": None}
    for name, variable in dataset.variables.items():
        if name in known:
            variable.attrs = attributes(str(name)) | variable.attrs
    return dataset


def status_bits(responses: Iterable[str]) -> int:
    """The status bits that matter to these responses: the whole run's, and each one's own."""
    bits = status.DIVERGED | status.ENERGY_OUT_OF_BALANCE
    for name in responses:
        if reason := RESPONSES[name].missing:
            bits |= STATUS_FLAGS[reason][0]
    return bits


def reasons(bits: int) -> list[str]:
    """The flags of a status in words, for a person."""
    return [words for bit, words in STATUS_FLAGS.values() if bits & bit]


_PACKAGES = ("impactlab", "numpy", "numba", "xarray", "netCDF4", "dask", "SALib", "scipy")


def provenance() -> dict[str, str]:
    """Where numbers come from: versions, source revision, time and class of processor."""
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": _versions(),
        "source_revision": _revision(Path(__file__).resolve().parent),
        "processor": _processor(),
        "Conventions": "CF-1.11",
    }


# What a process has loaded stays as it is, so each of these is found out once.


@cache
def _versions() -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    return f"{packages}, python {platform.python_version()}"


@cache
def _revision(here: Path) -> str:
    """The commit of the source tree, marked when it has changes; "release" outside a checkout."""
    command = ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=12"]
    if not (here.parent / ".git").exists():
        return f"release {version('impactlab')}"
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return "unknown (git did not answer)"
    return result.stdout.strip()


@cache
def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return f"{line.split(':', 1)[1].strip()}, {os.cpu_count()} cores"
    return f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores"
