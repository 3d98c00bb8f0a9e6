"""Numbers from solved studies, each with its uncertainty from the convergence in the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.convergence.axes import ELEMENT_SIZE
from impactlab.analysis.convergence.judgement import judge, numerical_uncertainty
from impactlab.analysis.convergence.richardson import SAFETY_DOUBTFUL
from impactlab.analysis.responses import relevant_bits
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.paper.statements.statement import Data, Number, UnknownError
from impactlab.variables import RESPONSES, WITNESS, reasons

Floats = NDArray[np.float64]
BEAM = "euler_bernoulli"
"""The paper's beam, among `beam_model`."""
VELOCITY = 0.99
"""The paper's impact velocity, m/s."""
FIRST_CONTACT, MESHES = "witness", "witness_mesh"
"""Studies: beam and 3-D models over the velocities; the 3-D model at VELOCITY on finer meshes."""


@dataclass(frozen=True)
class Curve:
    """A response against the velocity.

    velocity (m/s, ascending), value and uncertainty (SI): each of shape (velocities,).
    """

    velocity: Floats
    value: Floats
    uncertainty: Floats

    @property
    def low(self) -> Floats:
        """The smallest values that the uncertainty allows."""
        return self.value - self.uncertainty

    @property
    def high(self) -> Floats:
        """The largest values that the uncertainty allows."""
        return self.value + self.uncertainty

    def number(self, at: int, name: str, units: str) -> Number:
        """Return the value at one velocity, given by its index."""
        return Number(name, float(self.value[at]), units, float(self.uncertainty[at]))


def runs_of(data: Data, study: str) -> xr.Dataset:
    """Return the runs of a study. Raises UnknownError where there are none."""
    if study not in data:
        raise UnknownError(f"the study {study} has not been solved")
    return data[study]


def select_response(runs: xr.Dataset, response: str, **where: Any) -> xr.DataArray:
    """Return a response at the labels `where`.

    Raises UnknownError, with the reasons, where a run lacks it.
    """
    try:
        chosen = runs[[response, "status"]].sel(where)
    except KeyError as error:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not have {error.args[0]!r}") from None
    bits = chosen["status"].values & relevant_bits(response)
    gaps = (bits != 0) | ~np.isfinite(chosen[response].values)
    if gaps.any():
        found = reasons(int(np.bitwise_or.reduce(np.ravel(bits)))) or ["no reason is recorded"]
        raise UnknownError(f"{int(gaps.sum())} of {gaps.size} runs lack it: {'; '.join(found)}")
    return chosen[response]


def finest_grid(runs: xr.Dataset, response: str, **where: Any) -> Number:
    """Return a response on the finest grid with its uncertainty; see `grid_uncertainty`.

    where: a label for every varied parameter but `nodes`. Raises UnknownError where a run of the
    grids is missing.
    """
    if "nodes" not in runs.dims:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not vary the nodes: no uncertainty is known")
    by_grid = select_response(runs, response, **where).sortby("nodes", ascending=False)
    values = by_grid.values.astype(float)
    return Number(
        RESPONSES[response].long_name,
        float(values[0]),
        RESPONSES[response].units,
        grid_uncertainty(values, by_grid["nodes"].values),
    )


def grid_uncertainty(values: Floats, nodes: NDArray[Any]) -> float:
    """Return the half-width about the value on the finest grid, in the unit of the values.

    values, nodes: (grids,), finest first. The half-width is the grid convergence index. Where the
    grids show no convergence, it is three times the range of the three finest (Eca and Hoekstra's
    bound for scattered data), so that a value which still grows has an uncertainty of its own
    size. NaN with fewer than three grids.
    """
    if len(values) < 3:
        return float("nan")
    index = judge(values, 1.0 / (nodes - 1.0)).gci
    scatter = SAFETY_DOUBTFUL * float(np.ptp(values[:3]))
    return float(index * abs(values[0])) if np.isfinite(index) else scatter


def response_curve(data: Data, study: str, response: str, **where: Any) -> Curve:
    """Return a response over the velocities of a study, on the paper's beam unless `where` differs.

    Raises UnknownError where a run or an uncertainty is missing, naming the velocity.
    """
    runs = runs_of(data, study)
    if "beam_model" in runs.dims:
        where = {"beam_model": BEAM} | where
    velocities = np.sort(runs["velocity"].values.astype(float))
    found = [_at_velocity(runs, response, float(velocity), where) for velocity in velocities]
    values, uncertainties = np.array(found).T
    return Curve(velocities, values, uncertainties)


def _at_velocity(
    runs: xr.Dataset, response: str, velocity: float, where: dict[str, Any]
) -> tuple[float, float]:
    try:
        number = finest_grid(runs, response, velocity=velocity, **where)
    except UnknownError as reason:
        raise UnknownError(f"at {velocity:g} m/s {reason}") from None
    if np.isnan(number.uncertainty):
        raise UnknownError(f"at {velocity:g} m/s there are fewer than three grids")
    return number.value, number.uncertainty


def beam_response(data: Data, response: str, velocity: float, model: str) -> Number:
    """Return a beam model's response; raises UnknownError where its uncertainty is unknown."""
    runs = refined_runs(data)
    runs = runs.isel({refined_elements(runs): 0})
    return _bounded(finest_grid(runs, response, velocity=velocity, beam_model=model))


def solid_response(data: Data, response: str, velocity: float, least: float = 0.0) -> Number:
    """Return the 3-D model's response, its uncertainty from the element sizes, at least `least`.

    At the paper's velocity it comes from the study MESHES, where that is solved. Raises
    UnknownError where a run is missing or nothing bounds the error.
    """
    runs = solid_runs(data, velocity)
    if response not in runs:
        study = runs.attrs.get("study", FIRST_CONTACT)
        raise UnknownError(f"the runs of the study {study} do not hold the {response}")
    values = select_response(runs, response, velocity=velocity, beam_model=SOLID)
    elements = refined_elements(runs)
    spacings = ELEMENT_SIZE.spacings[elements](runs[elements].values.astype(float))
    finest_first = np.argsort(spacings)
    found = values.values.astype(float)[finest_first]
    width = max(float(numerical_uncertainty(found, spacings[finest_first]).amounts[0]), least)
    entry = (RESPONSES | WITNESS)[response]
    return _bounded(Number(f"{entry.long_name} (3-D)", found[0], entry.units, width))


def refined_runs(data: Data) -> xr.Dataset:
    """Return the runs of FIRST_CONTACT; raises UnknownError unless nodes and elements vary."""
    runs = runs_of(data, FIRST_CONTACT)
    if "nodes" not in runs.dims:
        raise UnknownError(f"the study {FIRST_CONTACT} does not vary nodes: its error is unknown")
    refined_elements(runs)
    return runs


def refined_elements(runs: xr.Dataset) -> str:
    """Return the dimension on which the 3-D elements are refined; raises UnknownError without."""
    for name in ELEMENTS:
        if name in runs.dims:
            return name
    study = runs.attrs.get("study", "?")
    raise UnknownError(f"the study {study} does not vary {ELEMENTS[0]}: its error is unknown")


def solid_runs(data: Data, velocity: float) -> xr.Dataset:
    """Return runs that vary the element size, among them those of the 3-D model."""
    if velocity == VELOCITY and MESHES in data:
        return data[MESHES].expand_dims("velocity")
    return refined_runs(data).isel(nodes=0)


def _bounded(number: Number) -> Number:
    if not np.isfinite(number.uncertainty):
        raise UnknownError(f"nothing bounds the numerical error of the {number.name}")
    return number
