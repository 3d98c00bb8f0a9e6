"""Statements on how fine the beam is cut: nodes, integration points, and Zhang's layers."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from impactlab.analysis.convergence.judgement import judge as judge_convergence
from impactlab.paper.statements.statement import (
    PRINTED_DIFFERENCE,
    VELOCITY,
    Assessment,
    Case,
    Data,
    Number,
    Ruling,
    UnknownError,
    finest_grid,
    judged,
    runs_of,
    select_response,
    statement,
)
from impactlab.verdicts import TOLERANCE

NODES_STUDY, POINTS_STUDY = "fig06_nodes", "fig06_points"
VELOCITIES = (VELOCITY, 15.0)  # without and with yielding fibres, m/s
MOTION = ("peak_force", "contact_duration", "maximum_indentation", "maximum_deflection")
"""Responses that the paper's histories show."""
STRAIN = ("peak_plastic_strain", "remote_plastic_strain")
"""Responses of plastic strain, which converge in their own way or not at all."""
PRINTED_NODES = 601
READINGS_OF_P = (
    ("two Lobatto points over the depth (as printed)", "lobatto", 2, True),
    (
        "two Lobatto points over half the depth, the axis one of them (3 in all)",
        "lobatto",
        3,
        False,
    ),
    ("two Lobatto points in each half of the depth (4 in all)", "lobatto", 4, False),
    ("two Gauss points over the depth", "legendre", 2, False),
)
"""Readings of P = 2: words, rule, points over the whole depth, whether it is the literal one."""


def _response_groups(data: Data, study: str) -> Iterator[Case]:
    """Yield words, velocity and a group of responses; strains only where a fibre yields."""
    for velocity in VELOCITIES:
        yield f"{velocity:g} m/s, force and motion", velocity, MOTION
        strains = data[study].get("peak_plastic_strain") if study in data else None
        if strains is None or (strains.where(strains["velocity"] == velocity) > 0).any():
            yield f"{velocity:g} m/s, plastic strain (PEEQ)", velocity, STRAIN


@statement(
    text="N = 601 nodes are the least for convergence.",
    test=(
        "For every response f: |f(601) − f∞| + U ≤ 1 % of f∞, and no smaller N of the study does "
        "as well. f∞: Richardson's value, or the value with the most nodes where there is none; "
        "U: its uncertainty (grid convergence index). Plastic strain (PEEQ) is judged separately. "
        "The paper does not say what it counts as converged: 1 % is ours, as in all our studies."
    ),
    cases=partial(_response_groups, study=NODES_STUDY),
    studies=(NODES_STUDY,),
)
def nodes_suffice(data: Data, velocity: float, names: tuple[str, ...]) -> Assessment:
    """Judge 601 nodes by the error of each response."""
    errors, needed = zip(*(_nodes_error(data, velocity, name) for name in names), strict=True)
    if unbounded := [error for error in errors if np.isnan(error.uncertainty)]:
        # Of two grids the coarser errs by half of their difference or more.
        worst = max(unbounded, key=lambda error: error.value)
        if not 0.5 * worst.value > TOLERANCE:
            raise UnknownError(f"the {worst.name} is not known: it takes three grids or more")
        why = f"Half of the change to the finest grid exceeds {100 * TOLERANCE:g} %: {worst.name}."
        return Assessment(errors, Ruling.FAILS, why)
    highest = [error.high for error in errors]
    worst, least = names[int(np.argmax(highest))].replace("_", " "), max(needed)
    numbers = (*errors, Number("least nodes for all of them", least, "1"))
    beyond = f"With {PRINTED_NODES} nodes the {worst} is not known within {100 * TOLERANCE:g} %."
    why = "Every smaller number of nodes in the study falls short."
    if not (exact := least == PRINTED_NODES):
        why = f"Read as “{PRINTED_NODES} are enough”: {least:g} already are."
    return judged(numbers, not max(highest) > TOLERANCE, why, beyond, literal=exact)


def _nodes_error(data: Data, velocity: float, name: str) -> tuple[Number, float]:
    """Return the relative error at N = 601, and the least N from which on it is in tolerance."""
    runs = runs_of(data, NODES_STUDY)
    if PRINTED_NODES not in runs["nodes"].values:
        raise UnknownError(f"the study {NODES_STUDY} has no run with {PRINTED_NODES} nodes")
    where = {"velocity": velocity, "points": int(runs["points"].max())}
    values = select_response(runs, name, **where).sortby("nodes", ascending=False)
    finest = finest_grid(runs, name, **where)
    reference = finest.value
    if values.size >= 3:
        spacings = 1.0 / (values["nodes"].values - 1.0)
        limit = judge_convergence(values.values.astype(float), spacings).extrapolated
        reference = limit if np.isfinite(limit) else reference
    share = finest.uncertainty / abs(reference) if reference else 0.0 if not finest.high else np.inf
    error = abs(values - reference) / (abs(reference) or 1.0)
    within = (error + share <= TOLERANCE).values
    count = int(np.argmin(within)) if not within.all() else within.size
    least = float(values["nodes"].values[count - 1]) if count else np.inf
    gap = float(error.sel(nodes=PRINTED_NODES))
    return Number(f"error of the {name.replace('_', ' ')}", gap, "1", share, percent=True), least


def _points_cases(data: Data) -> Iterator[Case]:
    for reading, rule, points, literal in READINGS_OF_P:
        for case, velocity, names in _response_groups(data, POINTS_STUDY):
            where = {"velocity": velocity, "rule": rule}
            yield f"{reading}; {case}", where, points, names, literal


@statement(
    text="P = 2 integration points over the depth are the least for convergence.",
    test=(
        "For every response f: |f(P) − f(most)| + U ≤ 1 % of f(most), at 601 nodes. U: the change "
        "of f between the most points and the next fewer. The paper does not say which points P "
        "counts: every reading has a row; nor what is converged: 1 % is ours."
    ),
    cases=_points_cases,
    studies=(POINTS_STUDY,),
)
def points_suffice(
    data: Data, where: dict[str, Any], points: int, names: tuple[str, ...], literal: bool
) -> Assessment:
    """Judge a reading of P = 2 by the error of each response."""
    errors = tuple(_points_error(data, where, points, name) for name in names)
    worst = max(errors, key=lambda error: error.high)
    within = worst.high <= TOLERANCE
    beyond = f"The {worst.name} is {100 * worst.value:,.1f} %."
    return judged(errors, within, "Every error is within 1 %.", beyond, literal=literal)


def _points_error(data: Data, where: dict[str, Any], points: int, name: str) -> Number:
    """Return the relative error with so many points; infinite where the value should be zero."""
    values = select_response(runs_of(data, POINTS_STUDY), name, **where)
    values = values.sortby("points", ascending=False)
    most, next_fewer = (float(values.isel(points=rank)) for rank in (0, 1))
    printed = float(values.sel(points=points))
    scale = abs(most) or (np.nan if printed or next_fewer else 1.0)
    gaps = (abs(value - most) / scale for value in (printed, next_fewer))
    error, spread = (np.inf if np.isnan(gap) else float(gap) for gap in gaps)
    return Number(f"error of the {name.replace('_', ' ')}", error, "1", spread, percent=True)


PRINTED_LAYERS = 0.069  # what the paper says of Zhang's layered beam against finite elements


@statement(
    text=(
        "Zhang's layered beam is 6.9 % off finite elements and this beam 2.4 %, because of the "
        "Lobatto points."
    ),
    test=(
        "The change of the peak force, or of the contact duration, that equal layers in the place "
        "of Lobatto's points bring is 6.9 − 2.4 = 4.5 % or more: |f(layers, P)/f(Lobatto) − 1| + U "
        "≥ 4.5 % at 0.99 m/s and 601 nodes. f(Lobatto): with the most points; U: its change to the "
        "next fewer. The paper does not give Zhang's number of layers."
    ),
    cases=tuple((f"{points} layers over the depth", points) for points in (2, 4, 10, 20)),
    studies=(POINTS_STUDY,),
)
def lobatto_is_the_reason(data: Data, points: int) -> Assessment:
    """Judge the change from Lobatto's points to so many layers."""
    runs = runs_of(data, POINTS_STUDY)
    gaps = []
    for name in ("peak_force", "contact_duration"):
        lobatto = select_response(runs, name, velocity=VELOCITY, rule="lobatto")
        best, next_best = lobatto.sortby("points", ascending=False).values[:2].astype(float)
        layers = select_response(runs, name, velocity=VELOCITY, rule="layers", points=points)
        width = abs(best - next_best) / best
        label = f"change of the {name.replace('_', ' ')}"
        gaps.append(Number(label, float(layers) / best - 1.0, "1", width, percent=True))
    needed = PRINTED_LAYERS - PRINTED_DIFFERENCE
    largest = max(abs(gap.value) + gap.uncertainty for gap in gaps)
    enough = "The rule may explain the difference."
    less = "No fibre yields: the rule changes the stiffness alone, by far less than 4.5 %."
    return judged(tuple(gaps), largest >= needed, enough, less, literal=False)
