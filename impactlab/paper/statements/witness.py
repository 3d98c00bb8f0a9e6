"""Numbers of the 3-D witness and of the beam models beside it, each with its uncertainty."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.element_size import SPACINGS
from impactlab.analysis.convergence.uncertainty import numerical_uncertainty
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.paper.statements.claim import Data, Number, UnknownError
from impactlab.paper.statements.curves import BEAM
from impactlab.paper.statements.evidence import answers, number, runs_of
from impactlab.variables import RESPONSES, WITNESS

STUDY = "witness"
"""Of the first contact."""
VELOCITY = 0.99
"""The paper's, in m/s."""
MESHES = "witness_mesh"
"""The 3-D model alone at the paper's velocity, on finer meshes."""
BEAMS = {BEAM: "Euler-Bernoulli beam", "timoshenko": "Timoshenko beam"}
"""The beam models that are held against the witness, the paper's first."""


def velocities(data: Data, study: str = STUDY) -> list[float]:
    """Rising, in m/s; the paper's alone where the study is not solved, to be judged as such."""
    if study not in data or "velocity" not in data[study].dims:
        return [VELOCITY]
    return sorted(float(speed) for speed in data[study]["velocity"].values)


def beam(data: Data, response: str, velocity: float, model: str = BEAM) -> Number:
    """A beam model's answer, its uncertainty from the nodes. Raises UnknownError without one."""
    runs = _chosen(data)
    runs = runs.isel({_elements(runs): 0})
    return _known(number(runs, response, velocity=velocity, beam_model=model))


def solid(data: Data, response: str, velocity: float, least: float = 0.0) -> Number:
    """The 3-D model's answer, its uncertainty from the element sizes, but not below `least`.

    At the paper's velocity it is that of the study MESHES, where that is solved. Raises
    UnknownError where a run is missing or nothing bounds the error.
    """
    runs = _solids(data, velocity)
    if response not in runs:
        study = runs.attrs.get("study", STUDY)
        raise UnknownError(f"the runs of the study {study} do not tell the {response}")
    values = answers(runs, response, velocity=velocity, beam_model=SOLID)
    spacings = SPACINGS[dim := _elements(runs)](runs[dim].values.astype(float))
    finest_first = np.argsort(spacings)
    found = values.values.astype(float)[finest_first]
    width = max(float(numerical_uncertainty(found, spacings[finest_first]).amounts[0]), least)
    entry = (RESPONSES | WITNESS)[response]
    return _known(Number(f"{entry.long_name} (3-D)", found[0], entry.units, width))


def smallest_element(data: Data) -> float:
    """At the paper's velocity, in m. Raises UnknownError where nothing varies it."""
    runs = _solids(data, VELOCITY)
    if "element_size" not in runs.dims:
        raise UnknownError(f"the study {MESHES} has not been solved")
    return float(runs["element_size"].min())


def histories(data: Data, variable: str, model: str) -> Iterator[xr.DataArray]:
    """A history at the paper's velocity on each grid of the model, finest first, (time,)."""
    runs = _chosen(data)
    elements = _elements(runs)
    refined, other = (elements, "nodes") if model == SOLID else ("nodes", elements)
    runs = runs.isel({other: 0})
    if variable not in runs:
        raise UnknownError(f"the study {STUDY} keeps no histories")
    chosen = runs[variable].sel(velocity=VELOCITY, beam_model=model).compute()
    for value in np.sort(chosen[refined].values)[:: 1 if refined == "element_size" else -1]:
        curve = chosen.sel({refined: value})
        if not np.isfinite(curve.values).all():
            raise UnknownError(f"the {variable.replace('_', ' ')} of a run is missing")
        yield curve


def difference(ours: Number, theirs: Number, name: str) -> Number:
    """Ours over theirs, minus one, with the uncertainty of both."""
    ratio = ours.value / theirs.value
    share = ours.uncertainty / abs(ours.value) + theirs.uncertainty / abs(theirs.value)
    return Number(name, ratio - 1.0, "1", ratio * share)


def _chosen(data: Data) -> xr.Dataset:
    """The runs of STUDY, refined for the beam models and for the solid."""
    runs = runs_of(data, STUDY)
    if "nodes" not in runs.dims:
        raise UnknownError(f"the study {STUDY} does not vary nodes: nothing tells the error")
    _elements(runs)
    return runs


def _elements(runs: xr.Dataset) -> str:
    """The dimension on which the solid's elements are refined. Raises UnknownError without one."""
    for name in ELEMENTS:
        if name in runs.dims:
            return name
    study = runs.attrs.get("study", "?")
    raise UnknownError(f"the study {study} does not vary {ELEMENTS[0]}: nothing tells the error")


def _solids(data: Data, velocity: float) -> xr.Dataset:
    """Runs of the 3-D model, among others, that vary the element size."""
    if velocity == VELOCITY and MESHES in data:
        return data[MESHES].expand_dims("velocity")
    return _chosen(data).isel(nodes=0)


def _known(found: Number) -> Number:
    if not np.isfinite(found.uncertainty):
        raise UnknownError(f"nothing bounds the numerical error of the {found.name}")
    return found
