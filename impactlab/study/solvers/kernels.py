"""Impacts, solved by the kernels."""

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from impactlab.law_texts import OWN
from impactlab.methods.runs import listed
from impactlab.model.case_table import case_table
from impactlab.model.contact_law import LAW_NAMES
from impactlab.model.cost import ANY_RUN, work
from impactlab.model.discretisation import Discretisation
from impactlab.model.flow_law import FLOW_LAW_NAMES
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import LAW_PARAMETERS, PARAMETERS, SECTION, with_values
from impactlab.provenance import provenance
from impactlab.solve import compile_kernels, profile_coordinates, solve
from impactlab.solver import FLOW_LAWS, RESISTANCES
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.switch import DAMPED
from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.shard import Array
from impactlab.study.solvers import Solver, flattened, run_number, run_shape
from impactlab.study.store import OutputSpec
from impactlab.variables import (
    BY_SPHERE,
    HISTORIES,
    OF_STRIKES,
    PROFILES,
    RESPONSES,
    answer_variables,
    described,
    status_bits,
)

_BESIDE_SPHERES = ("strike_position", "support_left", "support_right")
"""What may be at odds with further spheres."""


def columns(design: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the requested responses, their flags, and of what is kept beside them."""
    names = (*listed(design, "responses"), "status", "remarks", *kept(OutputSpec.of(design)))
    return tuple(dict.fromkeys(names))


def kept(output: OutputSpec) -> tuple[str, ...]:
    """Return the names of histories and profiles kept, and of answers by strike and by sphere."""
    histories = HISTORIES if output.samples else ()
    profiles = PROFILES if output.profiles else ()
    strikes = OF_STRIKES if output.strikes else ()
    spheres = [
        name
        for name, entry in (BY_SPHERE if output.spheres else {}).items()
        if output.samples or "time" not in entry.dims
    ]
    return (*histories, *profiles, *strikes, *spheres)


def cases(design: xr.Dataset, runs: Array) -> Array:
    """Return the kernels' case table of these runs. Raises ValueError naming one it refuses."""
    check_laws(design)
    varied = {name: flattened(design, name, runs) for name in listed(design, "varied")}
    duration = design["duration"].item()
    first = run_number(design, runs[0])
    return case_table(*base(design), duration=duration, varied=varied, first_run=first)


def check_laws(design: xr.Dataset) -> None:
    """Raise ValueError where this process lacks a law from outside, or has it of another source."""
    stated_laws = [
        (names, *line.partition(": ")[::2])
        for parameter, names in LAW_PARAMETERS.items()
        if parameter in design.variables
        for line in design[parameter].attrs.get(OWN, "").splitlines()
    ]
    for names, name, origin in stated_laws:
        kind = names.law_class.kind
        stated = f"{kind} {name!r} of this design is {origin}, but this session"
        advice = "call il.register with it, or install the package that has it as an entry point"
        if name not in names:
            raise ValueError(f"{stated} does not know it: {advice}")
        (law,) = names.outside([name])
        if not origin.endswith(law.source_hash):
            raise ValueError(
                f"{stated} has another one, source hash {law.source_hash}: {advice}, or draw the "
                "design again"
            )


def values(cases: Array, output: OutputSpec) -> int:
    """Count the responses of a run and what is kept beside them; all have the first one's mesh."""
    profile = int(cases[0].nodes) * int(cases[0].points) if output.profiles else 0
    by_sphere = output.spheres * (len(BY_SPHERE) + output.samples)
    numbers = len(RESPONSES) + len(HISTORIES) * output.samples + len(PROFILES) * profile
    return numbers + len(OF_STRIKES) * output.strikes + by_sphere


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """Return the answers of a design's runs, in its order, under its labels and with provenance."""
    (dims, shape), output = run_shape(design), OutputSpec.of(design)
    flat = answer_variables(answers, tuple(listed(design, "responses")), ("run",))
    variables = {
        name: ((*dims, *others[1:]), values.reshape(*shape, *values.shape[1:]))
        for name, (others, values) in flat.items()
    }
    dataset = design.assign(variables)
    if output.samples:
        times = np.linspace(0.0, design["duration"].item(), output.samples)
        dataset = dataset.assign_coords(time=times)
    for name, size in (("strike", output.strikes), ("sphere", output.spheres)):
        if size:
            dataset = dataset.assign_coords({name: np.arange(1.0, size + 1.0)})
    if output.profiles:
        dataset = dataset.assign_coords(profile_coordinates(*base(design)))
    return described(dataset.assign_attrs(provenance()))


def base(design: xr.Dataset) -> tuple[Impact, Discretisation]:
    """Return the impact and the discretisation without what is varied.

    A section has the sizes of the first run, without which it may be none, and further spheres have
    its place of the strike and its supports, with which they may not be at odds.
    """
    stated_by_first = (
        *SECTION,
        *(_BESIDE_SPHERES if "further_spheres" in design.variables else ()),
    )
    varied = {name for name in listed(design, "varied") if name not in stated_by_first}
    variables = design.variables  # quicker to get than arrays with labels
    stated = [name for name in PARAMETERS if name in variables and name not in varied]
    fixed = {name: variables[name].values.flat[0].item() for name in stated}
    return with_values(paper_impact(), Discretisation(), fixed)


def prepare(design: xr.Dataset) -> None:
    """Compile the kernels of a design's beam models, schemes and options."""
    impact, grid = base(design)
    models = np.unique(design.get("beam_model", impact.beam_model)).tolist()
    schemes = np.unique(design.get("scheme", grid.scheme)).tolist()
    patch = np.atleast_1d(design.get("load", impact.load)) == "contact_patch"
    metal = impact.beam.material
    rate = np.atleast_1d(design.get("beam_rate_coefficient", metal.rate_coefficient))
    sensitivity = np.atleast_1d(design.get("beam_rate_sensitivity", metal.rate_sensitivity))
    strip = np.atleast_1d(design.get("contact_compliance", impact.contact_compliance)) == "strip"
    stress = np.atleast_1d(design.get("contact_prestress", impact.contact_prestress)) == "bending"
    laws = np.atleast_1d(design.get("contact", impact.contact))
    own = LAW_NAMES.outside(laws)
    flow = np.atleast_1d(design.get("beam_flow_law", metal.flow_law))
    dampers = [LAWS[number] for number in DAMPED] + [law.name for law in own if law.damping]
    damped = np.isin(laws, dampers)
    resisted = [
        np.atleast_1d(design.get(name, getattr(impact.beam, name))) > 0.0 for name in RESISTANCES
    ]
    by_rate = rate > 0.0, sensitivity > 0.0, ~np.isin(flow, FLOW_LAWS)
    repeated = np.atleast_1d("most_strikes" in design.attrs)
    options = np.meshgrid(patch, *by_rate, strip, stress, damped, repeated, *resisted)
    extended = np.unique(np.logical_or.reduce(options)).tolist()
    numbers = [law.number for law in own] + [0] * bool(np.isin(laws, LAWS).any())
    of_flow = [law.number for law in FLOW_LAW_NAMES.outside(flow)]
    of_flow += [0] * bool(np.isin(flow, FLOW_LAWS).any())
    several = [True] if "further_spheres" in design.variables else [False]
    compile_kernels(models, schemes, extended, several, list(product(numbers, of_flow)))


SOLVER = Solver(
    version=SOURCES_HASH,
    columns=columns,
    failures=lambda design: status_bits(listed(design, "responses")),
    cases=cases,
    cost=lambda cases: work(cases) + ANY_RUN,  # A_SECOND are a second
    values=values,
    solve=lambda cases, form: solve(
        cases,
        samples=form.samples,
        profiles=form.profiles,
        strikes=form.strikes,
        by_sphere=form.spheres > 0,
    ),
    prepare=prepare,
    labelled=labelled,
)
