"""One impact with its histories, or many for their responses, as labelled datasets."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from impactlab.model.case_table import NO_INTERVAL, case_table
from impactlab.model.checks import instance, integer, positive
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.parameters import LAW_PARAMETERS, PARAMETERS, fixed_values, flatten
from impactlab.model.plausibility import (
    ImplausibleWarning,
    TooShortWarning,
    implausibilities,
    numbers,
)
from impactlab.model.quantities import Quantity, as_text, engineering, in_si
from impactlab.model.quantities import duration as duration_of
from impactlab.provenance import provenance
from impactlab.solve import fibre_section, profile_coordinates, solve, too_short
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import discretise
from impactlab.variables import (
    PROFILES,
    RESPONSES,
    VARIABLES,
    answer_variables,
    described,
)

if TYPE_CHECKING:
    import xarray as xr


def simulate(
    impact: Impact,
    discretisation: Discretisation | None = None,
    *,
    duration: Quantity,
    samples: int = 2001,
    frames: int = 0,
) -> xr.Dataset:
    """Solve one impact.

    Parameters
    ----------
    impact : Impact
        Sphere, beam and velocity.
    discretisation : Discretisation, optional
        Nodes, points and time step; by default `Discretisation()`.
    duration : Quantity
        Simulated time, in s.
    samples : int, default 2001
        Length of `time`, equally spaced from 0 to the duration.
    frames : int, default 0
        Length of `field_time`, on which deflection and strains are kept (0: at the end alone). It
        takes half as many times as long. Only for a single strike.

    Returns
    -------
    xarray.Dataset
        Histories on `time`, strains on `x` and `z` (with `frames`, also on `field_time`), every
        response as a scalar, `status` and `remarks`, in SI units. A response that the run could not
        give is NaN, and `status` says why; `remarks` qualifies the others. With several strikes,
        each of which takes the duration, histories are those of the last one, `deflection` is that
        at rest, what each strike left is on `strike` (NaN from the one that failed on), and
        `steady_strike` and `shakedown_strike` say from which on nothing grows. With several
        spheres, scalars are those of the first, and those of all are on `sphere`, with a status of
        their own.

    Raises
    ------
    ValueError
        If duration, samples or frames is not valid, or a value is impossible.

    Warns
    -----
    ImplausibleWarning
        If a value is implausible.
    TooShortWarning
        If the run ends before some responses can be given; the message names a sufficient duration.

    Examples
    --------
    >>> grid = il.Discretisation(nodes=41)
    >>> run = il.simulate(il.paper_impact("2 m/s"), grid, duration="10 ms")
    >>> f"{run.peak_force.item() / 1e3:.0f} kN, {run.contact_force.sizes['time']} times"
    '24 kN, 2001 times'

    The dent that ten strikes leave, each with the beam at rest again:

    >>> from dataclasses import replace
    >>> ten = replace(il.paper_impact("5 m/s"), strikes=10)
    >>> grid = il.Discretisation(nodes=65, scheme="modal")
    >>> run = il.simulate(ten, grid, duration="10 ms")
    >>> run.permanent_indentation_over_strikes.sizes["strike"]
    10
    """
    _check_order(impact, discretisation)
    seconds = _seconds(duration)
    grid = discretisation or Discretisation()
    samples = integer("simulate", "samples", samples, 2)
    frames = frames and integer("simulate", "frames", frames, 2)
    if frames and impact.strikes > 1:
        raise ValueError(f"simulate.frames = {frames}: must be 0 with several strikes")
    _warn(numbers(impact, grid))
    run = run_dataset(impact, grid, duration=seconds, samples=samples, frames=frames)
    if int(run["status"]):
        _warn_too_short(case_table(impact, grid, duration=seconds), run["status"].values)
    return run


def run_dataset(
    impact: Impact,
    discretisation: Discretisation,
    *,
    duration: float,
    samples: int = 2001,
    frames: int = 0,
    strikes: int = 0,
) -> xr.Dataset:
    """Return what `simulate` returns, whatever the values and the duration (in s) may be.

    For checks, which scale units, and for runs that end early on purpose. strikes: length of
    `strike`; by default the number of strikes, of a single one none.
    """
    grid = discretisation.resolved([impact.beam_model])
    cases = case_table(impact, grid, duration=duration)
    strikes = strikes or (impact.strikes if impact.strikes > 1 else 0)
    answers = solve(cases, samples=samples, profiles=True, strikes=strikes, by_sphere=True)
    axes = {"time": np.linspace(0.0, duration, samples)}
    if strikes:
        axes["strike"] = np.arange(1.0, strikes + 1.0)
    if cases["further"][0]:
        axes["sphere"] = np.arange(1.0, cases["further"][0] + 2.0)
    if frames:
        axes["field_time"], fields = _fields_over_time(cases, frames)
        answers |= fields
    axes |= profile_coordinates(impact, grid)
    variables = answer_variables(answers, tuple(RESPONSES), ())
    fixed = flatten(impact, grid) | {"sphere_mass": impact.sphere.total_mass, "duration": duration}
    fixed["shear_coefficient"] = impact.beam.shear_correction
    laws = {name: str(fixed[name]) for name in LAW_PARAMETERS}
    own = (law for name, word in laws.items() for law in LAW_PARAMETERS[name].outside([word]))
    blank = _blank_run(
        tuple(variables),
        tuple((name, values.tobytes()) for name, values in axes.items()),
        tuple(fixed),
        tuple(laws.items()),
        tuple(law.source_hash for law in own),
    )
    dataset = blank.copy()
    dataset.attrs = provenance()
    values = {name: data[0] for name, (_, data) in variables.items()} | fixed
    for name, value in values.items():
        dataset.variables[name].data = value
    return dataset


@functools.lru_cache(maxsize=8)
def _blank_run(
    answers: tuple[str, ...],
    axes: tuple[tuple[str, bytes], ...],
    fixed: tuple[str, ...],
    laws: tuple[tuple[str, str], ...],
    hashes: tuple[str, ...],
) -> xr.Dataset:
    """Return the dataset of a run before its numbers are in: a copy is sooner made than another.

    answers, fixed: names of data variables and of scalar coordinates. axes: by name, float64 as
    bytes, which tell one axis from another and are read-only, since copies share them. laws: of
    contact and flow, whose texts are attributes. hashes: of the sources of those from outside.
    """
    import xarray as xr  # late, here and below: `solve` does without, and it is slow to load

    points = {name: np.frombuffer(values) for name, values in axes}
    variables = {}
    for name in answers:
        dims = VARIABLES[name].dims if name in VARIABLES else ()
        shape = tuple(points[dim].size for dim in dims)
        variables[name] = dims, np.broadcast_to(np.nan, shape)
    scalars = dict.fromkeys(fixed, np.nan) | dict(laws)
    return described(xr.Dataset(variables, points | scalars))


def _fields_over_time(
    cases: np.ndarray[Any, Any], frames: int
) -> tuple[np.ndarray[Any, Any], dict[str, np.ndarray[Any, Any]]]:
    """Return times (s) of the one case, and by name the fields, (1, times, ...).

    They are those at the end of runs that stop after as many of its steps: the time loop need not
    keep any.
    """
    case = cases[0]
    grid, steps = discretise(case, make_pair(case), fibre_section(case))
    ends = np.unique(np.linspace(0, steps, frames).round())
    stopped = cases.repeat(ends.size - 1)
    stopped["duration"][:-1] = ends[1:-1] * grid.dt * (1.0 - 1e-12)  # no step more by round-off
    fields = {
        f"{name}_over_time": np.concatenate([np.zeros_like(values[:1]), values])[np.newaxis]
        for name, values in solve(stopped, profiles=True).items()
        if name in PROFILES
    }
    return np.append(ends[:-1] * grid.dt, case.duration), fields


def simulate_many(
    impact: Impact,
    discretisation: Discretisation | None = None,
    *,
    duration: Quantity,
    varied: Mapping[str, Sequence[Quantity] | np.ndarray[Any, Any]],
    combine: Literal["paired", "product"] = "paired",
) -> xr.Dataset:
    """Solve many impacts for their responses, on one thread.

    Parameters
    ----------
    impact : Impact
        Values of the parameters that are not varied.
    discretisation : Discretisation, optional
        Nodes, points and time step; by default `Discretisation()`.
    duration : Quantity
        Simulated time, in s.
    varied : mapping of str to sequence of Quantity
        Values by name of the parameter (impactlab.model.parameters.PARAMETERS), shape (runs,) each.
    combine : {"paired", "product"}, default "paired"
        "paired" takes the first value of every list for the first run, and so on, so all lists have
        one length; "product" solves every combination.

    Returns
    -------
    xarray.Dataset
        Every response, `status` and `remarks`, in SI units, on `run` for pairs and on a dimension
        per parameter for a product. Parameters and the duration, varied or fixed, are coordinates.

    Raises
    ------
    ValueError
        If a parameter is unknown or not a list, lengths differ, or the model refuses a value; the
        message names the run.

    Warns
    -----
    ImplausibleWarning
        If a value is implausible.
    TooShortWarning
        If runs end before some responses can be given; the message names a sufficient duration.

    Examples
    --------
    >>> many = il.simulate_many(
    ...     il.paper_impact(), il.Discretisation(nodes=41), duration="10 ms",
    ...     varied={"velocity": ["1 m/s", "2 m/s"], "contact": ["hertz", "stronge", "mjg"]},
    ...     combine="product")
    >>> dict(many.peak_force.sizes)
    {'velocity': 2, 'contact': 3}
    """
    import xarray as xr

    _check_order(impact, discretisation)
    grid = discretisation or Discretisation()
    seconds = _seconds(duration)
    lists = {name: _in_si(name, values) for name, values in varied.items()}
    dims, shape, columns = _combined(lists, combine)
    cases = case_table(impact, grid, duration=seconds, varied=columns)
    interval = cases["strike_interval"].max(initial=0.0)
    if interval > 0.0 and (cases["strikes"] == 1).all():
        raise ValueError(f"strike_interval = {engineering(interval, 's')}: {NO_INTERVAL}")
    ends = {name: (min(values), max(values)) for name, values in lists.items() if len(values)}
    _warn(numbers(impact, grid) | ends)
    answers = {name: values.reshape(shape) for name, values in solve(cases).items()}
    _warn_too_short(cases, answers["status"])
    resolved = grid.resolved(map(str, lists.get("beam_model", [impact.beam_model])))
    fixed = fixed_values(impact, resolved, lists)
    if not {"sphere_radius", "sphere_density"} & lists.keys():
        fixed["sphere_mass"] = impact.sphere.total_mass
    paired = combine == "paired"
    labels = {name: ("run" if paired else name, np.asarray(each)) for name, each in lists.items()}
    numbered = {"run": np.arange(cases.size)} if paired else {}
    dataset = xr.Dataset(
        answer_variables(answers, tuple(RESPONSES), dims),
        coords=numbered | fixed | {"duration": seconds} | labels,
        attrs=provenance(),
    )
    return described(dataset)


def _combined(
    lists: dict[str, Any], combine: str
) -> tuple[tuple[str, ...], tuple[int, ...], dict[str, Any]]:
    """Return dimensions and shape of the runs, and one value per run of each parameter.

    Raises ValueError for an unknown way, or pairs of unequal lengths.
    """
    if combine not in ("paired", "product"):
        raise ValueError(f"combine = {combine!r}: must be 'paired' or 'product'")
    lengths = tuple(np.size(values) for values in lists.values())
    if combine == "paired":
        if len(set(lengths)) > 1:
            given = zip(lists, lengths, strict=True)
            raise ValueError(
                "varied: every parameter needs one value per run, got lengths "
                f"{', '.join(f'{size} of {name}' for name, size in given)}: give lists of the same "
                "length, or combine='product' for every combination"
            )
        return ("run",), (max(lengths, default=1),), lists
    if any(np.ndim(values) != 1 for values in lists.values()):
        return tuple(lists), lengths, lists  # which are refused by name
    places = np.indices(lengths).reshape(len(lengths), -1)
    named = zip(lists.items(), places, strict=True)
    columns = {name: [each[at] for at in where] for (name, each), where in named}
    return tuple(lists), lengths, columns


def _in_si(name: str, values: Any) -> Any:
    values = as_text(values)
    entry = PARAMETERS.get(name)
    is_text = entry is None or entry.choices or entry.any_word
    if is_text or not isinstance(values, list | tuple):
        return values
    return [in_si(name, value, PARAMETERS[name].units) for value in values]


def _check_order(impact: object, discretisation: object) -> None:
    """Raise ValueError unless both arguments are what they should be; say if they are swapped."""
    if isinstance(impact, Discretisation) and isinstance(discretisation, Impact | None):
        swapped = "impact and discretisation are swapped" if discretisation else "it comes second"
        raise ValueError(f"simulate.impact is a Discretisation: {swapped}: give the impact first")
    instance("simulate", "impact", impact, Impact)
    if discretisation is not None:
        instance("simulate", "discretisation", discretisation, Discretisation)


def _seconds(value: Quantity) -> float:
    try:
        seconds = duration_of(as_text(value))
    except ValueError as error:
        raise ValueError(f"simulate.duration = {value!r}: {error}") from None
    return positive("simulate", "duration", seconds)


def _warn(ends: dict[str, Any]) -> None:
    """Warn of values that are implausible, as studies and commands do.

    Raises ValueError for one that is impossible.
    """
    for each in implausibilities(ends):
        if each.impossible:
            raise ValueError(f"{each.name}: {each.reason}")
        warnings.warn(f"{each.name}: {each.reason}", ImplausibleWarning, stacklevel=3)


def _warn_too_short(cases: Any, status: Any) -> None:
    if message := too_short(cases, status):
        warnings.warn(message, TooShortWarning, stacklevel=3)
