"""The kernels' one door: a case table goes in, arrays of answers come out.

A run that ends before it can give its responses is told of a duration that lasts.
"""

import itertools
import pickle
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from impactlab.jit import precompile
from impactlab.model.beam_modes import mode_keys, mode_table
from impactlab.model.cost import contact_time, flies, swing
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.quantities import engineering
from impactlab.model.section import fibre_table
from impactlab.solver import (
    BEAM_MODELS,
    BENDING_MODELS,
    FLOW_LAWS_OUTSIDE,
    OUTSIDE,
    SCHEMES,
    WAVE_MODELS,
    outputs,
)
from impactlab.solver.contact import NUMBERED
from impactlab.solver.contact.history import CONTACT
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.jit import FOLDER
from impactlab.solver.kernels import is_extended, kernel_of, step_counter
from impactlab.solver.outputs import DIVERGED, SERIES, blank, by_strike
from impactlab.solver.section import FibreSection, make_section
from impactlab.solver.sphere_table import Table, make_table
from impactlab.solver.types import VON_KARMAN
from impactlab.variables import BY_SPHERE, FAILURES, HISTORIES, RESPONSES, STILL_GROWING

_SWINGS = {
    outputs.INDENTATION_STILL_GROWING: 0.0,
    outputs.FIRST_CONTACT_UNFINISHED: 0.0,
    outputs.DEFLECTION_STILL_GROWING: 0.75,
    outputs.IN_CONTACT_AT_END: 1.0,
    outputs.SPHERE_NOT_LEAVING: 1.0,
    outputs.EARLIER_STRIKE_UNFINISHED: 1.0,
}
"""By status bit of a short duration: how many swings a run lasts that gives the response."""


def too_short(cases: Any, status: Any) -> str:
    """Return which responses runs are too short for, and a duration that lasts; "" for none.

    cases: records of solver.types.CASE of one duration. status: of each. No duration is stated
    where gravity takes a sphere's velocity in three swings, or the duration should have lasted. The
    deflection of a beam that moves off grows as long as it does, so no duration is asked for it.
    """
    status = np.ravel(status)
    diverged = status & outputs.DIVERGED != 0
    status = np.where(flies(cases), status & ~outputs.DEFLECTION_STILL_GROWING, status)
    bits = np.where(diverged, 0, status)[:, None] & np.array(list(_SWINGS))
    short = bits.any(axis=1)
    if not short.any():
        return ""
    missing = {
        entry.name: entry.missing and FAILURES[entry.missing] for entry in RESPONSES.values()
    }
    names = [name for name, reason in missing.items() if reason and reason[0] in bits]
    if outputs.EARLIER_STRIKE_UNFINISHED in bits:
        names += ["strikes before the last"]
    swings, cases = np.where(bits, list(_SWINGS.values()), 0.0).max(axis=1)[short], cases[short]
    seconds = cases[0]["duration"]
    lasting = contact_time(cases) + swings * swing(cases)
    remedy = f"take about {engineering(max(lasting.max(), 2.0 * seconds), 's', 2)}"
    slow = cases["velocity"] < 3.0 * cases["gravity"] * swing(cases)
    if ((swings == 1.0) & (slow | (lasting < seconds))).any():
        remedy = "try a longer one; at its end, too, the beam may be moving up behind the sphere"
    short_for = ", ".join(names)
    runs = f" in {cases.size:,} of {status.size:,} runs" if status.size > 1 else ""
    return f"duration = {engineering(seconds, 's')} is too short for {short_for}{runs}: {remedy}"


_COMPILE = """
import pickle
from dataclasses import replace
import numpy as np
import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.own_law import adopt
from impactlab.model.section import fibre_table
from impactlab.solve import solve, step_counts
grid = il.Discretisation(nodes=5, scheme={scheme!r})
impact = replace(il.paper_impact(), further_spheres={spheres!r})
varied = {{"beam_model": [{model!r}], "contact": [{law!r}]}}
cases = case_table(impact, grid, duration=1e-6, varied=varied)
for name, packed in {outside!r}.items():
    law = pickle.loads(packed)
    adopt(law)
    cases[name], cases["contact_prestress"] = law.number, {extended!r}
{call}
"""

_OWN = {"contact": NUMBERED, "beam_flow_law": FLOW_LAWS_OUTSIDE}
"""Laws from outside by their numbers, by the field of the case."""


def solve(
    cases: np.ndarray[Any, Any],
    *,
    samples: int = 0,
    profiles: bool = False,
    strikes: int = 0,
    by_sphere: bool = False,
    steps: np.ndarray[Any, Any] | None = None,
) -> dict[str, np.ndarray[Any, Any]]:
    """Run the kernels over a case table, on the calling thread and without the GIL.

    samples: length of each history (0: none). profiles: keep the fields along the beam, for which
    all cases must share nodes and points; raises ValueError where they do not. strikes: the
    largest number that a case has, or more, to keep what solver.outputs.SERIES has of each (0:
    none). by_sphere: keep the answers of further spheres. steps: number of time steps of each run,
    (R,) of int64, by default as many as the scheme needs. Returns by name, of R runs: the fields of
    solver.outputs.RESPONSE, (R,); histories, (R, samples); profiles, (R, nodes, points), or
    (R, nodes) for the deflection; series, (R, strikes), NaN beyond those of the case, and
    variables.OF_STRIKES; of several spheres, variables.BY_SPHERE, (R, spheres) or
    (R, spheres, samples).
    """
    if profiles and any(np.unique(cases[name]).size > 1 for name in ("nodes", "points", "rule")):
        raise ValueError("profiles need the same nodes, points and rule in every run")
    nodes, points = (int(cases[0].nodes), int(cases[0].points)) if profiles else (0, 0)
    runs = cases.size
    table = fibre_table(cases)
    responses = blank(runs)
    histories = np.full((runs, len(HISTORIES), samples), np.nan)
    series = np.full((runs, strikes, len(SERIES)), np.nan)
    deflection = np.full((runs, nodes), np.nan)
    strains = np.full((2, runs, nodes, points), np.nan)
    contacts, events = np.zeros(runs, CONTACT), np.zeros(runs, EVENTS)
    arrays = (responses, contacts, events, histories, series, deflection)
    models, schemes = cases["beam_model"], cases["scheme"]
    further = [make_table(cases, samples)] if cases["further"].any() else []
    # those from outside have kernels of their own
    laws = [np.where(cases[name] < OUTSIDE, 0, cases[name]) for name in _OWN]
    extended_cases = is_extended(cases) | (strikes > 0)
    kinds = np.stack([models, schemes, extended_cases, mode_keys(cases), *laws])
    starts = np.flatnonzero(np.diff(kinds, prepend=-1).any(axis=0))
    for start, end in itertools.pairwise((*starts, runs)):
        model, scheme, extended, _, *own = kinds[:, start].tolist()
        stretches = model == VON_KARMAN
        fibres = np.full((2, end - start, nodes, points if stretches else points // 2), np.nan)
        kind = [BEAM_MODELS[model]], [SCHEMES[scheme]], [bool(extended)], [bool(further)]
        compile_kernels(*kind, laws=[tuple(own)])
        modes = mode_table(cases[start])
        fastest = further[0].fastest[start:end] if further else cases[start:end]
        if steps is None:
            counts = step_counts(cases[start:end], fastest, table[start:end], own[0])
        else:
            counts = steps[start:end]
        kernel_of(model, scheme, bool(extended), bool(further), *own)(
            cases[start:end],
            counts,
            table[start:end],
            _rows(further[0], start, end, modes) if further else modes,
            *(array[start:end] for array in arrays),
            *fibres,
        )
        if profiles and not stretches:
            _restore(fibres, table[start:end])
        strains[:, start:end] = fibres[..., ::-1] if stretches else _depth(fibres, points)
    columns = {name: responses[name].copy() for name in responses.dtype.names or ()}
    if samples:
        columns |= zip(HISTORIES, np.moveaxis(histories, 1, 0), strict=True)
    if strikes:
        columns |= by_strike(cases, columns, series)
    if further and by_sphere:
        columns |= _by_sphere(columns, further[0])
    if profiles:
        columns["plastic_strain"], columns["equivalent_plastic_strain"] = strains
        columns["deflection"] = deflection
    return columns


def step_counts(
    cases: np.ndarray[Any, Any],
    fastest: np.ndarray[Any, Any],
    fibres: np.ndarray[Any, Any],
    law: int,
) -> np.ndarray[Any, Any]:
    """Return the number of time steps of each run; see stability.count_steps."""
    steps = np.empty(cases.size, dtype=np.int64)
    step_counter(law)(cases, fastest, fibres, steps)
    return steps


def _rows(table: Table, start: int, end: int, modes: np.ndarray[Any, Any]) -> Table:
    """Return the rows of some runs, with the modes that they share."""
    return Table._make([*(rows[start:end] for rows in table[:-1]), modes])


def _by_sphere(columns: dict[str, Any], table: Table) -> dict[str, np.ndarray[Any, Any]]:
    """Return the answers by sphere, of which the first one's are in the columns."""
    fields = table.answers.dtype.names or ()
    further = {name: table.answers[name] for name in fields}
    further["contact_force"] = table.samples[:, :, 0]
    lost = table.answers["status"] & DIVERGED != 0
    further["contact_force"][lost] = np.nan
    stems = {name: name.removesuffix("_of_spheres") for name in BY_SPHERE}
    answers = {
        name: np.concatenate([columns[stem][:, np.newaxis], further[stem]], axis=1)
        for name, stem in stems.items()
        if stem in columns
    }
    statuses = answers["status_of_spheres"] & ~STILL_GROWING  # of the series, not of one sphere
    answers["status_of_spheres"] = statuses.astype(np.int32)
    return answers


def compile_kernels(
    beam_models: Iterable[str] = BEAM_MODELS,
    schemes: Iterable[str] = SCHEMES,
    extended: Iterable[bool] = (False, True),
    several: Iterable[bool] = (False,),
    laws: Iterable[tuple[int, int]] = ((0, 0),),
) -> Path | None:
    """Compile the kernels of these models and schemes, unless they are compiled.

    extended: whether those with what kernels.is_extended names, those without, or both; several:
    the same of further spheres. laws: numbers of contact and flow laws from outside, 0: all
    others. Returns the folder of the compiled kernels, None where they cannot be kept.
    """
    programs = {}
    kinds = itertools.product(beam_models, schemes, extended, several, laws)
    for model, scheme, more, spheres, own in kinds:
        kind: dict[str, Any] = {"model": model, "scheme": scheme, "extended": more}
        kind["law"] = "hunt_crossley" if more and not any(own) else "hertz"
        named = zip(_OWN.items(), own, strict=True)
        kind["outside"] = {name: pickle.dumps(table[law]) for (name, table), law in named if law}
        kind["spheres"] = "0.25 1 0" if spheres else None
        models = BENDING_MODELS if scheme == "modal" else WAVE_MODELS if spheres else BEAM_MODELS
        if model in models:
            number = BEAM_MODELS.index(model), SCHEMES.index(scheme)
            kernel, counter = kernel_of(*number, more, spheres, *own), step_counter(own[0])
            programs[kernel] = _COMPILE.format(**kind, call="solve(cases, steps=np.array([1]))")
            call = f"step_counts(cases, cases, fibre_table(cases), {own[0]})"
            programs[counter] = _COMPILE.format(**kind, call=call)
    precompile(programs)
    return FOLDER


def profile_coordinates(impact: Impact, discretisation: Discretisation) -> dict[str, Any]:
    """Return the `x` and `z` coordinates (m) of fields along the beam."""
    beam = impact.beam
    z, _ = beam.section.cut(discretisation.rule, discretisation.points)
    return {"x": np.linspace(0.0, beam.span, discretisation.nodes), "z": z}


def fibre_section(case: Any) -> FibreSection:
    """Return the kernels' section of a case, for checks."""
    (fibres,) = fibre_table(np.atleast_1d(case))
    section: FibreSection = make_section(case, fibres)
    return section


def _restore(strains: np.ndarray[Any, Any], table: np.ndarray[Any, Any]) -> None:
    """Make strains of the kernels' fibres those of the real ones, outermost first."""
    z, _, ratio = np.moveaxis(table, 1, 0)
    for run in np.flatnonzero((ratio != 1.0).any(axis=1)):
        order = np.argsort(-z[run] * ratio[run])
        strains[:, run] = (strains[:, run] * ratio[run])[:, :, order]


def _depth(lower: np.ndarray[Any, Any], points: int) -> np.ndarray[Any, Any]:
    """Return plastic strain and PEEQ of all fibres in ascending z, from z > 0, outermost first."""
    axis = np.abs(0.0 * lower[..., : points % 2])  # NaN where a run diverged, as all else
    upper = np.stack([-lower[0], lower[1]]) + 0.0  # no -0.0
    return np.concatenate([upper, axis, lower[..., ::-1]], axis=-1)
