"""The plan of a 3-D run: its case, element size, duration and cost, before anything is solved."""

import math
from dataclasses import dataclass, replace
from typing import Any

from dask.system import CPU_COUNT
from distributed.system import MEMORY_LIMIT

from impactlab.fem3d.solver import MOST_THREADS, Cost, Mesh, estimate, impact_mesh, least_cost
from impactlab.fem3d.solver.estimates import checked_patch, contact_radius
from impactlab.figures.labels import counted
from impactlab.model import cost
from impactlab.model.case_table import between_nodes, case_table
from impactlab.model.checks import positive
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, is_plain, paper_impact
from impactlab.model.parameters import Value, flatten, with_values
from impactlab.model.quantities import amount, time
from impactlab.solve import solve
from impactlab.solver import LUMPED_MODELS, RESISTANCES
from impactlab.study.schema.declarations import ImpactStudy

_MODELS = ("euler_bernoulli", "timoshenko", "spring_mass")  # in the order of tables and figures
_COARSE = 101  # nodes that resolve the duration of a contact within some percent
_LONGEST = 5e-3  # simulated time in s within which the paper's first contact ends at any velocity


@dataclass(frozen=True)
class Case:
    """One impact. name, file: of the study. discretisation: of the beam models.

    longest: simulated time of the study in s. held: base values of the parameters that the study
    varies, by name.
    """

    name: str
    file: str
    impact: Impact
    discretisation: Discretisation
    longest: float
    held: dict[str, Value]


def beam_models(impact: Impact) -> tuple[str, ...]:
    """Return the models of the beam that have such ends, damping, foundation and place."""
    resisted = any(getattr(impact.beam, name) > 0.0 for name in RESISTANCES)
    lumped = is_plain(impact) and not resisted
    return tuple(name for name in _MODELS if lumped or name not in LUMPED_MODELS)


def case_of(
    study: ImpactStudy | None, *, velocity: float | None = None, contact: str | None = None
) -> Case:
    """Return the base of a study with its fixed values, or the paper's own case where it is None.

    Varied parameters keep their base value. velocity (m/s), contact: in place of the study's.
    Raises as Impact does.
    """
    options = {"velocity": velocity, "contact": contact}
    changed: Any = {name: value for name, value in options.items() if value is not None}
    if study is None:
        grid = Discretisation(nodes=601)  # as many for the beam models as the paper takes
        impact = replace(paper_impact(), **changed)
        return Case("paper", "the paper's case", impact, grid, _LONGEST, {})
    base, grid = with_values(study.impact, study.discretisation, study.sampling.fixed)
    values = flatten(base, grid) | {"sphere_mass": base.sphere.total_mass}
    names = [name for name in study.sampling.varied if name in values and name not in changed]
    held = {name: values[name] for name in names}
    impact = replace(base, **changed)
    return Case(study.name, str(study.path), impact, grid, study.duration, held)


USUAL_TIME = 120.0  # seconds of one core that a run may take where no element size is given
MOST_TIME = 3600.0  # seconds that runs may take unless they are forced
_CONTACTS = 2.25  # usual duration over the first contact's: 0.45 ms in the paper's case, as printed
_LONG = 2.0  # durations over the usual one at which the duration counts as the cause of a long run
_MOST_ELEMENTS = 10_000  # of a chosen size, by the least cost: time alone does not limit short runs
_FEWEST = 2.0  # elements over the contact's radius at least, of a chosen size


@dataclass(frozen=True)
class RunPlan:
    """One 3-D run. mesh: None where it does not fit memory. Lengths in m, times in s.

    first_contact: NaN where it outlasts the study. beam_seconds: time that the beam models take.
    """

    case: Case
    element_size: float
    patch: float
    duration: float
    first_contact: float
    usual_duration: float
    beam_seconds: float
    cost: Cost
    mesh: Mesh | None

    def seconds(self, workers: int) -> float:
        """Return the estimated time with so many threads, the beam models' runs included."""
        busy: int = min(workers, CPU_COUNT, MOST_THREADS)
        return self.cost.cpu_seconds / busy + self.beam_seconds

    def problem(self, workers: int) -> str:
        """Return the reason not to start, naming the option that drives it, or ""."""
        option = f"--element-size {1e3 * self.element_size:g} mm"
        elements, long = f"{self.cost.elements:,} elements", self.seconds(workers)
        if self.cost.memory_bytes > MEMORY_LIMIT:
            needed = amount(self.cost.memory_bytes)
            reason = f"{needed} of memory, of {amount(MEMORY_LIMIT)}, for {elements}"
        elif long > MOST_TIME:
            if self.duration > _LONG * self.usual_duration:
                option = f"--duration {1e3 * self.duration:g} ms"
            limit = "which exceeds the limit of one hour per run"
            reason = f"{time(long)}, {limit}, for {self.cost.steps:,} steps of {elements}"
        else:
            return ""
        hint = "see --dry-run, and --force (Python: force=True) runs it all the same"
        return f"{self.case.file}: {option}: about {reason}; {hint}"

    def solved_mesh(self) -> Mesh:
        """Return the mesh, even if it may not fit memory."""
        size = self.element_size
        return self.mesh or impact_mesh(self.case.impact, element_size=size, patch=self.patch)


def planned(
    case: Case,
    *,
    element_size: float | None = None,
    patch: float | None = None,
    duration: float | None = None,
) -> RunPlan:
    """Return the plan of a run; arguments that are None are chosen.

    element_size: the finest of 1, 2 or 5 times a power of ten that keeps within USUAL_TIME.
    duration: 2.25 times the first contact of the Euler-Bernoulli beam, at most the study's.
    Raises ValueError when a number is not valid or the mesh is impossible.
    """
    for name, value in (("element_size", element_size), ("patch", patch), ("duration", duration)):
        if value is not None:
            positive("witness", name, value)
    # Roughly: on a coarse grid, which is quick for any duration.
    nodes = min(case.discretisation.nodes, _COARSE)
    if between_nodes(case.impact.strike_position, nodes):
        nodes = case.discretisation.nodes
    coarse = replace(case.discretisation, nodes=nodes, scheme="leapfrog")
    plain = replace(case.impact, beam_model=_MODELS[0])
    answers = solve(case_table(plain, coarse, duration=case.longest))
    first, usual = float(answers["contact_duration"][0]), case.longest
    if not math.isnan(first):
        usual = min(float(f"{_CONTACTS * first:.2g}"), usual)
    simulated = usual if duration is None else duration
    size = _usual_size(case.impact, patch, simulated) if element_size is None else element_size
    solid, mesh = cost_of(case.impact, size, simulated, patch)
    half = checked_patch(case.impact, size, patch)
    grid = replace(case.discretisation, scheme="leapfrog")
    models = beam_models(case.impact)
    beams = case_table(case.impact, grid, duration=simulated, varied={"beam_model": models})
    beside = float(cost.work(beams).sum() / cost.A_SECOND)
    return RunPlan(case, size, half, simulated, first, usual, beside, solid, mesh)


def cost_of(
    impact: Impact,
    size: float,
    duration: float,
    patch: float | None = None,
    longest: float = math.inf,
) -> tuple[Cost, Mesh | None]:
    """Return the cost on the mesh, and the mesh.

    Where the least cost exceeds the memory or `longest` (s of one core) already: that, and None.
    """
    least = least_cost(impact, element_size=size, duration=duration, patch=patch)
    if least.memory_bytes > MEMORY_LIMIT or least.cpu_seconds > longest:
        return least, None
    mesh = impact_mesh(impact, element_size=size, patch=patch)
    return estimate(mesh, impact, duration=duration), mesh


def _usual_size(impact: Impact, patch: float | None, duration: float) -> float:
    """Return the finest size within USUAL_TIME and _MOST_ELEMENTS, else the coarsest one.

    Sizes are 1, 2 and 5 times powers of ten in m, over three decades.
    """
    fits = min(impact.sphere.radius, impact.beam.width, impact.beam.span) / 10.0
    largest = min(contact_radius(impact) / _FEWEST, fits)
    first = math.floor(math.log10(largest))
    sizes = [float(f"{digit}e{first - down}") for down in range(4) for digit in (5, 2, 1)]
    usual, *finer = [size for size in sizes if size <= largest]
    for size in finer:
        least = least_cost(impact, element_size=size, duration=duration, patch=patch)
        if least.elements > _MOST_ELEMENTS:
            break
        if cost_of(impact, size, duration, patch, USUAL_TIME)[0].cpu_seconds > USUAL_TIME:
            break
        usual = size
    return usual


def print_plan(plan: RunPlan, workers: int | None, problem: str) -> None:
    """Print what is solved and what it costs, one line each, and the problem, if any.

    workers: None for a deck, which another program solves.
    """
    solid, across = plan.cost, contact_radius(plan.case.impact) / plan.element_size
    contact = f"the first contact is longer than {1e3 * plan.case.longest:.4g} ms"
    if not math.isnan(plan.first_contact):
        lasting = f"{1e3 * plan.first_contact:.2g} ms"
        contact = f"an Euler-Bernoulli beam's first contact takes about {lasting}"
        if plan.duration > 1.5 * plan.usual_duration:
            contact += f": for it alone, {1e3 * plan.usual_duration:.4g} ms would do"
    lines = {
        "case": f"{plan.case.file}, at {plan.case.impact.velocity:g} m/s",
        "element size": f"{1e3 * plan.element_size:g} mm in a patch of {1e3 * plan.patch:.3g} mm: "
        f"about {across:.2g} elements over the contact's radius",
        "duration": f"{1e3 * plan.duration:.4g} ms; {contact}",
        "elements": f"{solid.elements:,}",
        "time steps": f"about {solid.steps:,}",
    }
    if workers:
        threads = counted(workers, "thread")
        lines["wall"] = f"about {time(plan.seconds(workers))} on {threads}"
        lines["memory"] = f"about {amount(solid.memory_bytes)}"
    for name, text in lines.items():
        print(f"{name:15s}{text}")
    if problem:
        print(f"exceeds the limit: {problem}")
