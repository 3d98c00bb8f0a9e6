"""Statements that compare the beam model with a 3-D finite-element model."""

from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.judgement import numerical_uncertainty
from impactlab.fem3d.study_rules import ELEMENT_SIZE
from impactlab.fem3d.wing import SIZES, SOLID
from impactlab.figures import labels
from impactlab.model.impact import paper_impact
from impactlab.paper.statements.statement import (
    BEAM,
    PRINTED_DIFFERENCE,
    VELOCITY,
    Assessment,
    Case,
    Data,
    Number,
    UnknownError,
    finest_grid,
    judged,
    runs_of,
    select_response,
    statement,
)
from impactlab.types import Floats
from impactlab.variables import VARIABLES

FIRST_CONTACT, MESHES = "witness", "witness_mesh"
"""Studies: beam and 3-D models over the velocities; the 3-D model at VELOCITY on finer meshes."""
Norm = Callable[[Floats], float]


def _solid_response(data: Data, response: str, velocity: float) -> Number:
    """Return the 3-D model's response with its uncertainty."""
    runs = _solid_runs(data, velocity)
    if response not in runs:
        study = runs.attrs.get("study", FIRST_CONTACT)
        raise UnknownError(f"the runs of the study {study} do not hold the {response}")
    values = select_response(runs, response, velocity=velocity, beam_model=SOLID)
    elements = _refined_elements(runs)
    spacings = ELEMENT_SIZE.spacings[elements](runs[elements].values.astype(float))
    finest_first = np.argsort(spacings)
    finest = values.values.astype(float)[finest_first]
    width = float(numerical_uncertainty(finest, spacings[finest_first])[0][0])
    entry = VARIABLES[response]
    return _bounded(Number(f"{entry.long_name} (3-D)", finest[0], entry.units, width))


def _solid_runs(data: Data, velocity: float) -> xr.Dataset:
    """Return runs that vary the elements: of MESHES at the paper's velocity, if solved."""
    if velocity == VELOCITY and MESHES in data:
        return data[MESHES].expand_dims("velocity")
    return _refined_runs(data)[0].isel(nodes=0)


def _refined_runs(data: Data) -> tuple[xr.Dataset, str]:
    """Return the runs of FIRST_CONTACT and the dimension that refines their elements."""
    runs = runs_of(data, FIRST_CONTACT)
    if "nodes" not in runs.dims:
        raise UnknownError(f"the study {FIRST_CONTACT} does not vary nodes: its error is unknown")
    return runs, _refined_elements(runs)


def _refined_elements(runs: xr.Dataset) -> str:
    if names := [name for name in SIZES if name in runs.dims]:
        return names[0]
    study = runs.attrs.get("study", "?")
    raise UnknownError(f"the study {study} does not vary {SIZES[0]}: its error is unknown")


def _bounded(number: Number) -> Number:
    if not np.isfinite(number.uncertainty):
        raise UnknownError(f"nothing bounds the error of the {number.name}: finer grids would")
    return number


_READING = "On the finest grids; U: three times the change from the second finest, of both models."


def _histories(data: Data, variable: str, model: str) -> tuple[Floats, list[Floats]]:
    """Return times and a history at the paper's velocity per grid, finest first, (time,) each."""
    runs, elements = _refined_runs(data)
    refined, other = (elements, "nodes") if model == SOLID else ("nodes", elements)
    runs = runs.isel({other: 0})
    if variable not in runs:
        raise UnknownError(f"the study {FIRST_CONTACT} keeps no histories")
    chosen = runs[variable].sel(velocity=VELOCITY, beam_model=model).compute()
    order = np.sort(chosen[refined].values)[:: 1 if refined == "element_size" else -1]
    curves = [chosen.sel({refined: value}).values for value in order]
    if len(curves) < 2:
        raise UnknownError(f"the study {FIRST_CONTACT} has one grid: its error is unknown")
    if not np.isfinite(curves).all():
        raise UnknownError(f"the {variable.replace('_', ' ')} of a run is missing")
    return runs["time"].values, curves


def _norm(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _largest(values: Floats) -> float:
    return float(np.max(np.abs(values)))


def _distance(data: Data, variable: str, norm: Norm, shifted: bool = False) -> Number:
    """Return the norm of the difference of two histories over that of the 3-D model's."""
    time, ours = _histories(data, variable, BEAM)
    _, theirs = _histories(data, variable, SOLID)
    scale = norm(theirs[0])
    width = 3.0 * sum(norm(curves[1] - curves[0]) for curves in (ours, theirs)) / scale
    # the shift of either history that makes the difference least; its uncertainty is the same
    delays = np.linspace(-0.1, 0.1, 401) * time[-1] if shifted else np.zeros(1)
    gaps = [norm(np.interp(time - delay, time, ours[0]) - theirs[0]) for delay in delays]
    best = int(np.argmin(gaps))
    name = "difference over the 3-D model's"
    if shifted:
        name += f" (the beam's shifted by {labels.number(1e6 * delays[best], 2)} µs)"
    return Number(name, gaps[best] / scale, "1", width, percent=True)


def _gap(data: Data, velocity: float, response: str) -> tuple[Number, ...]:
    """Return a response of the beam, of the 3-D model, and their difference over the latter."""
    runs, elements = _refined_runs(data)
    runs = runs.isel({elements: 0})
    ours = _bounded(finest_grid(runs, response, velocity=velocity, beam_model=BEAM))
    theirs = _solid_response(data, response, velocity)
    return ours, theirs, ours.relative_to(theirs, "difference, relative to the 3-D model")


def _spelled(gap: Number) -> str:
    """Return "They differ by −5.3 ± 0.1 %"."""
    value, width = labels.number(100 * gap.value, 2), labels.number(100 * gap.uncertainty, 2)
    return f"They differ by {value} ± {width} %"


def _impulses(data: Data) -> tuple[Number, ...]:
    """Return the impulses of both models over the stored time, and their relative difference."""
    impulses: list[Number] = []
    for model, label in ((BEAM, "beam"), (SOLID, "3-D")):
        time, curves = _histories(data, "contact_force", model)
        finest, next_finer = (float(np.trapezoid(curve, time)) for curve in curves[:2])
        width = 3.0 * abs(finest - next_finer)
        impulses.append(Number(f"impulse ({label})", finest, "N s", width))
    return *impulses, impulses[0].relative_to(impulses[1], "difference, relative to the 3-D model")


@statement(
    text="The force history differs by 2.4 % from that of 3-D finite elements.",
    test=(
        "|d| − U ≤ 2.4 %; d: ‖F(beam) − F(3-D)‖/‖F(3-D)‖ over time (L2 norm), the same after the "
        "best shift in time, and the relative differences of peak and impulse; U: the numerical "
        "uncertainties of both. The paper does not say which measure it takes: a row per measure. "
        "3-D: this project's model in the place of the paper's."
    ),
    cases=(
        ("the history, L2 norm", "L2"),
        ("the history after the best shift in time, L2 norm", "shifted"),
        ("its peak", "peak"),
        ("its impulse", "impulse"),
    ),
    studies=(FIRST_CONTACT, MESHES),
)
def force_history(data: Data, measure: str) -> Assessment:
    """Judge a measure of the difference at the paper's velocity."""
    if measure == "peak":
        numbers = _gap(data, VELOCITY, "peak_force")
    elif measure == "impulse":
        numbers = _impulses(data)
    else:
        numbers = (_distance(data, "contact_force", _norm, measure == "shifted"),)
    gap = numbers[-1]
    stands = gap.within(PRINTED_DIFFERENCE)
    why = f"{_spelled(gap)}: {'compatible with' if stands else 'more than'} 2.4 %."
    return judged(numbers, stands, why, literal=measure == "L2")


@statement(
    text="The deflection agrees with that of 3-D finite elements, with slight deviations.",
    test=(
        "d − U ≤ limit; d: the largest |w(beam) − w(3-D)| over time, over the largest |w(3-D)|, at "
        "mid-span. The paper gives no number: two readings, agreement within U, and deviations of "
        f"its 2.4 % at most. {_READING}"
    ),
    cases=(
        (f"{VELOCITY:g} m/s, agreement", 0.0),
        (f"{VELOCITY:g} m/s, deviations up to 2.4 %", PRINTED_DIFFERENCE),
    ),
    studies=(FIRST_CONTACT,),
)
def deflection_history(data: Data, limit: float) -> Assessment:
    """Judge the histories of the deflection at mid-span."""
    gap = _distance(data, "midspan_deflection", _largest)
    stands = gap.within(limit)
    why = f"{_spelled(gap)} of the largest deflection."
    return judged((gap,), stands, why, literal=False)


def _velocities(data: Data) -> Iterator[Case]:
    velocities = [VELOCITY]
    if FIRST_CONTACT in data and "velocity" in data[FIRST_CONTACT].dims:
        velocities = np.sort(data[FIRST_CONTACT]["velocity"].values.astype(float)).tolist()
    for velocity in velocities:
        yield f"{velocity:g} m/s", velocity


@statement(
    text="The contact duration against the velocity agrees with 3-D finite elements.",
    test=(
        "|t(beam)/t(3-D) − 1| ≤ U; t: duration of the first contact; U: the numerical "
        "uncertainties of both. To be compatible is a reading of “agree”: look at U."
    ),
    cases=_velocities,
    studies=(FIRST_CONTACT, MESHES),
)
def duration_of_witness(data: Data, velocity: float) -> Assessment:
    """Judge the durations of the first contact."""
    numbers = _gap(data, velocity, "contact_duration")
    gap = numbers[-1]
    stands = gap.within(0.0)
    why = f"{_spelled(gap)}: {'compatible' if stands else 'more than the uncertainty'}."
    return judged(numbers, stands, why, literal=False)


PRINTED_EXTENT = 1.52e-3  # extent of the plastic zone in figure 9, m
_ZONE = {
    "along the surface, PEEQ above 0.2 %": ("plastic_zone_radius", 1.0),
    "at any depth, half the length with a PEEQ above 1e-5": ("plastic_zone_length", 0.5),
    "below the centre, PEEQ above 0.2 %": ("plastic_zone_depth", 1.0),
}
"""Readings of the zone's extent: variable of the runs, and factor from it to the extent."""


def _contact_radius(data: Data, factor: float) -> Number:
    """Return sqrt(factor R delta) in m from the 3-D model's largest indentation."""
    depth = _solid_response(data, "maximum_indentation", VELOCITY)
    radius = float(np.sqrt(factor * paper_impact().sphere.radius * depth.value))
    return Number("contact radius", radius, "m", 0.5 * radius * depth.uncertainty / depth.value)


def _zone_extent(data: Data, variable: str, factor: float) -> Number:
    """Return an extent from the centre of the impact in m, to within an element at best."""
    runs = runs_of(data, MESHES).expand_dims("velocity").sortby("element_size")
    values = select_response(runs, variable, velocity=VELOCITY, beam_model=SOLID).values
    if values.size < 3:
        raise UnknownError(f"the study {MESHES} has fewer than three meshes")
    width = max(3.0 * factor * np.ptp(values[:3]), runs["element_size"].values[0])
    return Number("extent from the centre", factor * float(values[0]), "m", float(width))


@statement(
    text="At 0.99 m/s the plastic zone reaches 1.52 mm from the centre (3-D, figure 9).",
    test=(
        "|r − 1.52 mm| ≤ U; U: three times the range of the three finest meshes, at least the size "
        "of an element. The paper does not say at which strain its zone ends, nor along which "
        "line: readings of r along the struck surface, at any depth, in depth; and the radius "
        "√(R δ) of an elastic contact at the largest indentation, which is no plastic zone."
    ),
    cases=(*((place, *zone) for place, zone in _ZONE.items()), ("the contact's radius", "", 1.0)),
    studies=(FIRST_CONTACT, MESHES),
)
def plastic_zone_extent(data: Data, variable: str, factor: float) -> Assessment:
    """Judge a variable of the runs; factor: from it to the extent from the centre."""
    reach = _zone_extent(data, variable, factor) if variable else _contact_radius(data, 1.0)
    gap = abs(reach.value - PRINTED_EXTENT)
    stands = gap <= reach.uncertainty
    margin = "within" if stands else "more than"
    why = f"It differs by {1e3 * gap:.2f} mm, {margin} the uncertainty."
    return judged((reach,), stands, why, literal=False)


@statement(
    text="At 0.99 m/s the plastic zone remains below the contact (3-D, figure 9).",
    test=(
        "r − U ≤ a + U; r: the zone's extent along the surface; a: the contact's radius at the "
        "largest indentation, √(R δ) while elastic, √(2 R δ) where the surface neither sinks in "
        "nor piles up. And no element farther than one beam depth from the impact yields."
    ),
    cases=(
        ("within the radius √(R δ)", 1.0),
        ("within the radius √(2 R δ)", 2.0),
        ("within one beam depth", None),
    ),
    studies=(FIRST_CONTACT, MESHES),
)
def plastic_zone_place(data: Data, factor: float | None) -> Assessment:
    """Judge the zone beside the contact's radius; factor: of R delta under the root."""
    if factor is None:
        runs, _ = _refined_runs(data)
        remote = select_response(runs, "remote_plastic_strain", velocity=VELOCITY, beam_model=SOLID)
        largest = Number("largest PEEQ beyond one depth", float(remote.max()), "1", percent=True)
        why = "No element there yields on any mesh."
        return judged((largest,), largest.value == 0.0, why, "Some do.", literal=False)
    reach, radius = _zone_extent(data, "plastic_zone_radius", 1.0), _contact_radius(data, factor)
    stands = reach.low <= radius.high
    why = "The zone's edge may lie under the contact."
    beyond = "It reaches beyond the contact."
    return judged((reach, radius), stands, why, beyond, literal=False)
