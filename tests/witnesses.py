"""Planted studies of beam models beside the 3-D FE model."""

import numpy as np
import xarray as xr

from impactlab.analysis.convergence import axes
from impactlab.fem3d.study_rules import ELEMENT_SIZE
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import flatten
from impactlab.variables import described

Study = tuple[xr.Dataset, xr.Dataset]

SPEEDS = [0.5, 1.0, 5.0]
MODELS = ["euler_bernoulli", "timoshenko", "solid"]
FACTORS = xr.DataArray([1.05, 0.98, 1.0], {"beam_model": MODELS})
SIZES = xr.DataArray([1e-3, 5e-4, 2.5e-4], {"element_size": [1e-3, 5e-4, 2.5e-4]})
NODES = xr.DataArray([101, 201, 401], {"nodes": [101, 201, 401]})


def _runs_of(first: xr.DataArray, name: str) -> xr.Dataset:
    """Return a response per model from `first`; errors of second order, 1 % on the finest grid."""
    solid = FACTORS["beam_model"] == "solid"
    refined = xr.where(solid, (SIZES / 2.5e-4) ** 2, (400.0 / (NODES - 1)) ** 2)
    force = FACTORS * first * (1.0 + 0.01 * refined)
    duration = 1e-4 * FACTORS**-1 * first * (1.0 + 0.01 * refined)
    found = xr.Dataset({"peak_force": force, "contact_duration": duration})
    found["status"] = xr.zeros_like(force, dtype=np.int32)
    attrs = {"responses": [*found.data_vars][:2], "method": "grid", "study": "planted"}
    varied = [name, "beam_model", "nodes", "element_size"]
    fixed = flatten(paper_impact(), Discretisation()) | {"duration": 1e-3}
    scalars = {key: value for key, value in fixed.items() if key not in found.coords}
    return described(found.assign_coords(scalars).assign_attrs(attrs | {"varied": varied}))


def analysed(runs: xr.Dataset) -> xr.Dataset:
    """Return both convergence studies of the runs."""
    return xr.merge(
        [axes.NODES.analysis(runs), ELEMENT_SIZE.analysis(runs)], join="exact", compat="equals"
    )


def against_velocity() -> Study:
    """Return runs with Euler-Bernoulli 5 % above the 3-D FE model, and Timoshenko 2 % below."""
    speeds = xr.DataArray(SPEEDS, {"velocity": SPEEDS})
    runs = _runs_of(1e4 * speeds, "velocity")
    return runs, analysed(runs)


def counted(runs: xr.Dataset) -> Study:
    """Return the same runs, with 2, 4 and 8 elements per radius in place of element sizes."""
    values = 2e-3 / runs["element_size"].values
    found = runs.rename(element_size="elements_per_radius")
    found = found.assign_coords(elements_per_radius=values)
    return found, analysed(found)


def taken_apart() -> Study:
    """Return runs in which yielding lowers the force by 10 % in the beams, and by 20 % in 3-D."""
    stress = {"beam_yield_stress": [345e6, 20e9]}
    solid = FACTORS["beam_model"] == "solid"
    first = xr.where(solid, xr.DataArray([0.8, 1.0], stress), xr.DataArray([0.9, 1.0], stress))
    runs = _runs_of(first, "beam_yield_stress")
    time = xr.DataArray(np.linspace(0.0, 1.0, 5), dims="time")
    history = runs["peak_force"] * time
    found = runs.assign(contact_force=history, indentation=1e-5 * history)
    return described(found.assign_coords(time=1e-3 * time)), analysed(runs)
