"""The case table: impacts as the records that the kernels take, one per run."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from impactlab import wings
from impactlab.model.bodies import PLACE_OF_ITS_OWN, Beam, sphere_rows
from impactlab.model.checks import column, positive
from impactlab.model.contact_compliance import case_fields
from impactlab.model.cost import flies
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.laminate import LEAST_FIBRES, layer_rows
from impactlab.model.parameters import (
    PARAMETERS,
    PROFILE_FIXED,
    SECTION,
    SPHERES_FIXED,
    WORDS,
    Value,
    flatten,
    with_values,
)
from impactlab.model.quantities import engineering
from impactlab.model.section import least_points
from impactlab.model.shapes import profile_points
from impactlab.solver import (
    AXIAL_SUPPORTS,
    BEAM_MODELS,
    BENDING_MODELS,
    LOADS,
    LUMPED_MODELS,
    SCHEMES,
    SUPPORTS,
)
from impactlab.solver.types import CASE, LAYERS, PROFILE, SPHERES

NO_REST = (
    "must be 1 of a beam that its ends let fly, for it does not come to rest: change it, or hold "
    "an end (support_left, support_right)"
)
"""Why such a beam cannot be struck again."""
STIFF_FOUNDATION = (
    "must be 1 on so stiff a foundation, on which leapfrog finds no rest: change it, or set a "
    "smaller foundation_stiffness, or scheme: modal with euler_bernoulli or elastic"
)
"""The same, of one whose rest solver/settle.py cannot sum."""
MODAL_DAMPING = (
    "is of modes: set scheme: modal, or state mass_damping and stiffness_damping instead"
)
"""End of the message that refuses it in leapfrog."""
TOO_SOON = "must be at least the duration, which is simulated after every strike: change either"
"""Why strikes cannot follow each other so soon."""
MODAL_PATCH = "must be point with further_spheres and scheme: modal: change one of these"
"""Why further spheres cannot press circles there."""
NO_INTERVAL = "has no effect with one strike: take it out, or set more strikes"
"""Why there is nothing between strikes."""
_LONGEST = 20.0
"""Largest length of a beam at rest on a foundation, over its (4 EI/k)^(1/4)."""
_ON_NODE = 1e-6
"""Distance (spacings) from a node at which a strike lies on it."""


def case_table(
    impact: Impact,
    discretisation: Discretisation,
    *,
    duration: float,
    varied: Mapping[str, Sequence[Value] | np.ndarray[Any, Any]] | None = None,
    first_run: int = 0,
) -> np.ndarray[Any, Any]:
    """Return the kernels' table of cases, one record (solver.types.CASE) per run; check each run.

    first_run: the number that messages give the first one. Raises ValueError naming the run and its
    field when the model refuses a value. Among runs that vary, a single strike may have a time to
    the next, which has no effect.
    """
    positive("simulate", "duration", duration)
    varied = varied or {}
    _check_lists(varied)
    lengths = {len(values) for values in varied.values()}
    if len(lengths) > 1:
        raise ValueError(f"varied: every parameter needs one value per run, got lengths {lengths}")
    models = map(str, varied.get("beam_model", [impact.beam_model]))
    discretisation = discretisation.resolved(models)
    try:
        columns = {name: column(values) for name, values in varied.items()}
        many = with_values(impact, discretisation, columns)
    except (TypeError, ValueError):  # some run may be wrong, or right in a way of its own
        runs = _one_by_one(impact, discretisation, varied, first_run)
        tables = [np.zeros(0, CASE), *(_table(*run, duration, 1) for run in runs)]
        cases = np.concatenate(tables)
    else:
        cases = _table(*many, duration, lengths.pop() if lengths else 1)
    lumped = BEAM_MODELS.index(LUMPED_MODELS[0])
    for name, words, first, only, reason in (
        ("scheme", SCHEMES, len(BENDING_MODELS), "leapfrog", ""),
        ("load", LOADS, lumped, "point", ", because it moves as one mass"),
    ):
        refused = (cases["beam_model"] >= first) & (cases[name] != words.index(only))
        if refused.any():
            row = int(refused.argmax())
            model, word = BEAM_MODELS[cases[row].beam_model], words[cases[row][name]]
            run = f"run {first_run + row}: " if varied else ""
            raise ValueError(
                f"{run}{name} = {word!r}: beam_model = {model!r} has {only!r} alone{reason}"
            )
    repeated, interval = cases["strikes"] > 1, cases["strike_interval"]
    for name, refused, reason in (
        ("strikes", repeated & flies(cases), NO_REST),
        ("strikes", repeated & _is_long_on_foundation(cases), STIFF_FOUNDATION),
        ("strike_interval", repeated & (interval > 0.0) & (interval < duration), TOO_SOON),
        ("strike_interval", ~repeated & (interval > 0.0) & (not varied), NO_INTERVAL),
        ("load", _presses_modes(cases), MODAL_PATCH),
        (
            "damping_ratio",
            (cases["damping_ratio"] > 0.0) & (cases["scheme"] != SCHEMES.index("modal")),
            MODAL_DAMPING,
        ),
    ):
        if refused.any():
            row = int(refused.argmax())
            run = f"run {first_run + row}: " if varied else ""
            entry, value = PARAMETERS[name], cases[name][row]
            stated = (
                repr(entry.choices[value])
                if entry.choices
                else engineering(float(value), entry.units)
            )
            raise ValueError(f"{run}{name} = {stated}: {reason}")
    _check_further(cases, "run {}: " if varied else "", first_run)
    between = cases["strike_position"] * (cases["nodes"] - 1)
    refused = abs(between - between.round()) > _ON_NODE
    if refused.any():
        row = int(refused.argmax())
        run = f"run {first_run + row}: " if varied else ""
        reason = between_nodes(cases["strike_position"][row], int(cases["nodes"][row]))
        raise ValueError(f"{run}strike_position = {cases['strike_position'][row]:.12g}: {reason}")
    return cases


def _is_long_on_foundation(cases: Any) -> Any:
    """Return whether leapfrog's beam at rest on its foundation cannot be summed."""
    metal = cases["beam_youngs_modulus"] / cases["beam_density"]
    square = np.sqrt(cases["foundation_stiffness"] / (4.0 * metal * cases["rotary_inertia"]))
    lengths = cases["beam_span"] * np.sqrt(square)
    return (cases["scheme"] != SCHEMES.index("modal")) & (lengths > _LONGEST)


def _presses_modes(cases: Any) -> Any:
    """Return whether circles of several contacts press the modes."""
    modal = (cases["further"] > 0) & (cases["scheme"] == SCHEMES.index("modal"))
    return modal & (cases["load"] == LOADS.index("contact_patch"))


def _check_further(cases: np.ndarray[Any, Any], run: str, first_run: int) -> None:
    """Raise ValueError where further spheres have no node of their own."""
    for row, case in enumerate(cases if cases["further"].any() else (), first_run):
        places = case.further_spheres[: case.further, 0]
        reasons = [between_nodes(float(place), int(case.nodes)) for place in places]
        nodes = np.rint(np.append(places, case.strike_position) * (case.nodes - 1))
        if np.unique(nodes).size < nodes.size:
            reasons.append(PLACE_OF_ITS_OWN)
        if reason := next(filter(None, reasons), ""):
            raise ValueError(f"{run.format(row)}further_spheres: {reason}")


def _check_lists(varied: Mapping[str, Any]) -> None:
    """Raise ValueError where a parameter cannot be varied, or has no list of values."""
    for name, values in varied.items():
        if name in WORDS:
            fixed = SPHERES_FIXED if name == "further_spheres" else PROFILE_FIXED
            raise ValueError(f"varied: {name}: {fixed}")
        if isinstance(values, str) or np.ndim(values) != 1:
            raise ValueError(f"varied: {name} = {values!r}: must be a list with one value per run")


def between_nodes(place: float, nodes: int) -> str:
    """Return why the share `place` of the span cannot be struck with so many nodes; "" if it can.

    >>> between_nodes(0.33, 41)
    'lies between two of the 41 nodes: take 0.325 or 0.35, or 101 nodes'
    """
    cell = place * (nodes - 1)
    if abs(cell - round(cell)) <= _ON_NODE:
        return ""
    low, high = (f"{math.floor(cell + side) / (nodes - 1):.6g}" for side in (0, 1))
    spacings = range(4, 10 * nodes, 2)
    finer = [n for n in spacings if abs(place * n - round(place * n)) <= _ON_NODE]
    nearest = min(finer, key=lambda n: abs(n + 1 - nodes), default=0)
    other = f", or {nearest + 1} nodes" if nearest else ""
    return f"lies between two of the {nodes} nodes: take {low} or {high}{other}"


def _one_by_one(
    impact: Impact,
    discretisation: Discretisation,
    varied: Mapping[str, Sequence[Value] | np.ndarray[Any, Any]],
    first_run: int,
) -> Iterator[tuple[Impact, Discretisation]]:
    """Yield the impact of every run. Raises ValueError naming the first one the model refuses."""
    for run, row in enumerate(zip(*varied.values(), strict=True), first_run):
        # NumPy's scalars as the Python values that the model checks
        plain = (value.item() if isinstance(value, np.generic) else value for value in row)
        values: dict[str, Any] = dict(zip(varied, plain, strict=True))
        try:
            yield with_values(impact, discretisation, values)
        except ValueError as error:
            stated = ", ".join(f"{name} = {value!r}" for name, value in values.items())
            several = f" ({stated})" if len(values) > 1 else ""
            raise ValueError(f"run {run}{several}: {error}") from None


def _table(
    impact: Impact, discretisation: Discretisation, duration: float, runs: int
) -> np.ndarray[Any, Any]:
    """Return the records of as many runs as the impact's columns are long, or one for all."""
    for model in wings.among(impact.beam_model):
        reason = f"is no model of the kernels: {model.advice}"
        raise ValueError(f"beam_model = {model.name!r}: {reason}")
    discretisation = discretisation.resolved(np.unique(impact.beam_model).tolist())
    values: dict[str, Any] = {**flatten(impact, discretisation), "duration": duration}
    values["sphere_mass"] = impact.sphere.total_mass
    values = dict.fromkeys((*SECTION, "strike_interval"), 0.0) | values
    for name, entry in PARAMETERS.items():
        if entry.choices:
            numbered = ((entry.choices.index(word), word) for word in entry.choices)
            values[name] = sum(number * (values[name] == word) for number, word in numbered)
    for side in ("left", "right"):  # a roller is a pinned end whose axis is not held
        support, axial = values[f"support_{side}"], map(SUPPORTS.index, AXIAL_SUPPORTS)
        springs = np.equal(support, SUPPORTS.index("elastic"))
        springs = springs & np.greater(values[f"stiffness_{side}"], 0.0)
        values[f"axis_held_{side}"] = np.isin(support, [*axial]) | springs
        values[f"support_{side}"] = np.where(support == SUPPORTS.index("roller"), 0, support)
    points = profile_points(impact.beam.profile or ())
    values["beam_profile"] = np.zeros((PROFILE, 2))
    values["beam_profile"][: len(points)] = np.reshape(points, (-1, 2))
    rows = layer_rows(impact.beam.layers or ())
    values["beam_layers"] = np.zeros((LAYERS, 4))
    values["beam_layers"][: len(rows)] = np.reshape(rows, (-1, 4))
    spheres = sphere_rows(impact.further_spheres or ())
    values["further_spheres"] = np.zeros((SPHERES, 3))
    values["further_spheres"][: len(spheres)] = np.reshape(spheres, (-1, 3))
    values["further"] = len(spheres)
    if np.any(np.less(discretisation.points, least := least_points(impact.beam))):
        raise ValueError(
            f"points = {discretisation.points!r}: must be at least {least} with so many layers, of "
            f"which each needs {LEAST_FIBRES} on either side of the axis"
        )
    values |= _section_fields(impact.beam) | case_fields(impact)
    cases = np.zeros(runs, dtype=CASE)
    for name in CASE.names or ():
        cases[name] = values[name]
    return cases


def _section_fields(beam: Beam) -> dict[str, Any]:
    """Return the fields of solver.types.CASE that hold properties of the section."""
    section, metal = beam.section, beam.material
    shear_modulus = 0.5 * metal.youngs_modulus / (1.0 + metal.poissons_ratio)
    return {
        "shear_coefficient": beam.shear_correction,
        "mass_per_length": beam.mass_per_length,
        "rotary_inertia": section.rotary_inertia(metal.density),
        "shear_stiffness": beam.shear_correction * shear_modulus * section.area,
        "stress_per_moment": section.stress_per_moment,
        "plastic_modulus": section.plastic_modulus,
        "skin_thickness": section.skin_thickness,
    }
