"""The 3-D FE model in an independent program: Kratos Multiphysics.

The mesh is that of impactlab.fem3d; all else is Kratos': elements, plasticity, contact,
steps in time. It is no dependency: pip install 'impactlab[kratos]'.
"""

from __future__ import annotations

import time
from dataclasses import KW_ONLY, dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, PackageLoader, StrictUndefined

from impactlab.fem3d.solver import Mesh, PatchTooSmallError
from impactlab.fem3d.solver.dataset import OWN, histories, named
from impactlab.fem3d.solver.evaluation import history_responses, plastic_responses
from impactlab.fem3d.solver.march import History, Moment, Progress
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, check_mesh, nodal_masses, sphere_density
from impactlab.fem3d.solver.system import refuse_rate
from impactlab.model.checks import integer, positive
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.provenance import provenance
from impactlab.solver import RESISTANCES

ELEMENT, LAW = "SmallDisplacementBbarElement3D8N", "SmallStrainJ2Plasticity3DLaw"
TIME_STEP, PENALTY = 8e-6, 1e15  # s, and N/m3 (1e6 N/mm3)
MM, MPA, TONNES_PER_MM3, N_PER_MM3 = 1e3, 1e-6, 1e-12, 1e-9
"""Kratos' units over SI: of lengths and velocities, stresses, densities, and penalties."""
PART, BEAM_TOP, SPHERE_BOTTOM = "Structure", "BeamTop", "SphereBottom"
"""Names of the whole model and of the two surfaces that may touch."""
RESIDUAL_RATIO = 1e-5  # residual over that at a step's beginning, at which the step has converged


class KratosMissingError(ImportError):
    """Kratos Multiphysics, or a part of it, is not installed."""


def solve_on(
    mesh: Mesh,
    impact: Impact,
    *,
    duration: float,
    time_step: float = TIME_STEP,
    penalty: float = PENALTY,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve one impact on `mesh` with Kratos Multiphysics; strains and rotations are small.

    mesh: of solver.impact_mesh. duration, time_step: in s. penalty: of the contact in N/m3,
    pressure over penetration. threads: they pay on an idle machine only. progress: called after
    each step with the share done.

    Returns a Dataset with the names of impactlab.fem3d: histories on `time` (one per step),
    responses (NaN where the run ends before they do), and plastic strains on `element`;
    `iterations` are Newton's. A run that was interrupted by Ctrl-C, or in which a step did not
    converge, gives what it has computed until then, and the attribute `stopped` says why.

    Raises KratosMissingError when Kratos is not installed; ValueError when a number is not valid,
    the mesh is of other bodies or no quarter of such a beam, or a material has kinematic
    hardening; and PatchTooSmallError (a ValueError) when the contact leaves the patch of matched
    nodes.
    """
    for name, value in (("duration", duration), ("time_step", time_step), ("penalty", penalty)):
        positive("solve", name, value)
    check_mesh(mesh, impact)
    resisted = any(getattr(impact.beam, name) > 0.0 for name in RESISTANCES)
    if mesh.copies != 4 or mesh.ends != ("pinned", "pinned") or resisted:
        raise ValueError(
            "mesh: Kratos gets quarters of a pinned beam without damping or foundation alone: set "
            "support_left: pinned, support_right: pinned, strike_position: 0.5, mass_damping: 0, "
            "stiffness_damping: 0 and foundation_stiffness: 0, or take impactlab's own solver"
        )
    kratos = engine(integer("solve", "threads", threads, 1))
    run = Run(kratos, mesh, impact, duration=duration, time_step=time_step, penalty=penalty)
    run.go(progress)
    return to_dataset(run)


_OWN = OWN | {
    "iterations": ("1", "Newton's iterations in a step"),
    "equivalent_plastic_strain": ("1", "equivalent plastic strain (PEEQ), mean of the element"),
    "time_step": ("s", "time step"),
    "penalty": ("N m-3", "pressure over penetration in the contact"),
    "cpu_seconds": ("s", "processor time"),
}
"""Units and long_name of variables that impactlab.variables does not have."""
_RESPONSES = (
    *("peak_force", "time_of_peak_force", "contact_duration", "number_of_contacts"),
    *("maximum_indentation", "permanent_indentation", "maximum_deflection"),
)
"""Responses of the histories that take no energies and no forces between the steps."""


def to_dataset(run: Run) -> xr.Dataset:
    """Return all answers of a run, as described in solve_on."""
    peeq, info = run.engine.variable("ACCUMULATED_PLASTIC_STRAIN"), run.part.ProcessInfo
    points = [element.CalculateOnIntegrationPoints(peeq, info) for element in run.part.Elements]
    strain = np.array(points)  # (e, 8)
    largest = strain.max(axis=1)
    # A contact that pauses for less than two steps is one.
    answers, _ = history_responses(run.history, 2.0 * run.time_step)
    dataset = xr.Dataset(
        {
            **{name: answers[name] for name in _RESPONSES},
            **plastic_responses(run.mesh, run.impact, largest),
            "cpu_seconds": run.cpu_seconds,
            **{name: ("time", values) for name, values in histories(run.history).items()},
            "iterations": ("time", run.iterations),
            "equivalent_plastic_strain": ("element", strain.mean(axis=1)),
            "largest_equivalent_plastic_strain": ("element", largest),
        },
        coords={
            "time": run.history.table()[0],
            "body": ("element", run.mesh.body),
            "velocity": run.impact.velocity,
            "time_step": run.time_step,
            "penalty": run.penalty,
            "element_size": run.mesh.element_size,
        },
        attrs=provenance() | {"model": f"Kratos Multiphysics {version('KratosMultiphysics')}"},
    )
    if run.history.stopped:
        dataset.attrs["stopped"] = run.history.stopped
    return named(dataset, _OWN)


@dataclass(frozen=True)
class Kratos:
    """core: the module KratosMultiphysics. analysis: its class of structural analyses."""

    core: Any
    analysis: Any

    def variable(self, name: str) -> Any:
        """Return a variable of the core or of an application."""
        return self.core.KratosGlobals.GetVariable(name)


def engine(threads: int) -> Kratos:
    """Return Kratos on `threads` threads, silent except for warnings.

    Raises KratosMissingError, which says what to install.
    """
    try:
        core = import_module("KratosMultiphysics")
        core.Logger.GetDefaultOutput().SetSeverity(core.Logger.Severity.WARNING)
        # These register elements, laws and conditions.
        for name in ("StructuralMechanics", "ConstitutiveLaws", "ContactStructuralMechanics"):
            import_module(f"KratosMultiphysics.{name}Application")
        module = "StructuralMechanicsApplication.structural_mechanics_analysis"
        analysis = import_module(f"KratosMultiphysics.{module}").StructuralMechanicsAnalysis
    except ImportError as error:
        raise KratosMissingError(
            f"Kratos Multiphysics is not complete here ({error}): pip install 'impactlab[kratos]'"
        ) from error
    core.ParallelUtilities.SetNumThreads(threads)
    return Kratos(core, analysis)


@dataclass
class Run:
    """An impact on a mesh in Kratos; times in s, penalty in N/m3.

    history: at the start and at the end of each step so far, velocities included. iterations:
    Newton's, in each.
    """

    engine: Kratos
    mesh: Mesh
    impact: Impact
    _: KW_ONLY
    duration: float
    time_step: float
    penalty: float
    cpu_seconds: float = 0.0

    def __post_init__(self) -> None:
        engine, mesh, impact = self.engine, self.mesh, self.impact
        self._started = time.process_time()
        self.history = History([Moment(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, impact.velocity)])
        self.iterations = [0.0]
        model = engine.core.Model()
        self.part = model.CreateModelPart(PART)
        self.part.ProcessInfo[engine.variable("DOMAIN_SIZE")] = 3
        parameters = settings(self.duration, self.time_step, self.penalty)
        self._analysis = engine.analysis(model, engine.core.Parameters(parameters))
        fill(engine, self.part, mesh, impact)
        self._analysis.Initialize()
        constrain(engine, self.part, mesh, impact)
        mass = nodal_masses(mesh, impact)
        mass[np.setdiff1d(np.arange(mass.size), mesh.elements[mesh.body == SPHERE])] = 0.0
        self._sphere = mass / mass.sum()  # each node's share

    def go(self, progress: Progress | None) -> None:
        """Step on to the end, or until a step does not converge or Ctrl-C is pressed."""
        analysis = self._analysis
        try:
            while analysis.KeepAdvancingSolutionLoop() and not self.history.stopped:
                self._take()
                if progress:
                    progress(min(analysis.time / self.duration, 1.0))
        except KeyboardInterrupt:
            self.history.stopped = f"interrupted at {analysis.time:.4g} s"
        self.cpu_seconds = time.process_time() - self._started

    def _take(self) -> None:
        """Take one step, or as much of it as converges; the following steps take the rest."""
        analysis, before = self._analysis, self._analysis.time
        analysis.time = analysis._GetSolver().AdvanceInTime(before)
        for _ in range(6):  # cut in half five times at most
            analysis.InitializeSolutionStep()
            if analysis.SolveSolutionStep() or self._balanced():
                analysis.FinalizeSolutionStep()
                self._keep()
                return
            analysis.time = 0.5 * (before + analysis.time)
            # Back to where the step began.
            self.part.OverwriteSolutionStepData(1, 0)
            self.part.ReduceTimeStep(self.part, analysis.time)
            displacement = self.engine.variable("DISPLACEMENT")
            self.engine.core.VariableUtils().UpdateCurrentPosition(self.part.Nodes, displacement)
        self.history.stopped = f"Newton's iterations did not converge after {before:.4g} s"

    def _balanced(self) -> bool:
        """Return whether forces balance although nodes that barely touch still change sides."""
        ratio = self.part.ProcessInfo[self.engine.variable("CONVERGENCE_RATIO")]
        return bool(ratio <= RESIDUAL_RATIO)

    def _keep(self) -> None:
        """Add this step to the history, unless its contact has left the patch."""
        mesh, values = self.mesh, self.engine.core.VariableUtils().GetSolutionStepValuesVector
        down, speed = (  # of every node, from mm to m
            -(np.array(values(self.part.Nodes, self.engine.variable(name), 0, 3))[2::3] / MM)
            for name in ("DISPLACEMENT", "VELOCITY")
        )
        upper, lower = mesh.pairs[mesh.rim].T
        if np.any(mesh.gaps[mesh.rim] < down[upper] - down[lower]):
            raise PatchTooSmallError(
                f"the contact reaches the rim of the patch of matched nodes: patch must be above "
                f"{mesh.patch:.4g} m"
            )
        moment = Moment(
            time=self._analysis.time,
            force=self._force(),
            sphere=float(self._sphere @ down),
            pole=float(down[mesh.pole]),
            axis=float(down[mesh.axis_node]),
            top=float(down[mesh.top_node]),
            velocity=float(self._sphere @ speed),
        )
        self.history.moments.append(moment)
        iterations = self.engine.variable("NL_ITERATION_NUMBER")
        self.iterations.append(float(self.part.ProcessInfo[iterations]))

    def _force(self) -> float:
        """Return the force of the whole beam on the whole sphere in N, upwards: four quarters."""
        core, residual, total = self.engine.core, self.engine.core.Vector(), 0.0
        for pair in self.part.GetSubModelPart("ComputingContact").Conditions:
            if pair.Is(core.ACTIVE):
                pair.CalculateRightHandSide(residual, self.part.ProcessInfo)
                total -= sum(list(residual)[2:12:3])  # on the beam's four nodes, which come first
        return 4.0 * total


def settings(duration: float, time_step: float, penalty: float) -> str:
    """Return project parameters in Kratos' JSON; arguments in s, s and N/m3."""
    templates = Environment(loader=PackageLoader("impactlab.fem3d"), undefined=StrictUndefined)
    return templates.get_template("kratos.json.j2").render(
        part=PART,
        sphere=SPHERE_BOTTOM,
        beam=BEAM_TOP,
        end_time=duration - 0.5 * time_step,
        time_step=time_step,
        residual_ratio=RESIDUAL_RATIO,
        penalty=penalty * N_PER_MM3,
    )


def fill(engine: Kratos, part: Any, mesh: Mesh, impact: Impact) -> None:
    """Put the mesh into the empty model part `part`, which must know its variables.

    Kratos counts from 1: its node i + 1 is the mesh's node i.
    """
    for number, place in enumerate((mesh.nodes * MM).tolist(), 1):
        part.CreateNewNode(number, *place)
    steels = {
        BEAM: _steel(engine, part, 1, impact.beam.material, impact.beam.material.density),
        SPHERE: _steel(engine, part, 2, impact.sphere.material, sphere_density(mesh, impact)),
    }
    of_element = zip((mesh.elements + 1).tolist(), mesh.body.tolist(), strict=True)
    for number, (nodes, body) in enumerate(of_element, 1):
        part.CreateNewElement(ELEMENT, number, nodes, steels[body])
    first = 1
    for name, quads, body in (
        (SPHERE_BOTTOM, mesh.pairs[mesh.faces, 0][:, ::-1], SPHERE),
        (BEAM_TOP, mesh.pairs[mesh.faces, 1], BEAM),
    ):
        surface = part.CreateSubModelPart(name)
        surface.AddNodes(np.unique(quads + 1).tolist())
        for number, nodes in enumerate((quads + 1).tolist(), first):
            surface.CreateNewCondition("SurfaceCondition3D4N", number, nodes, steels[body])
        first += len(quads)


def _steel(engine: Kratos, part: Any, number: int, material: Material, density: float) -> Any:
    """Return Kratos' properties of a material; density in kg/m3."""
    refuse_rate(material)
    if material.kinematic_hardening_modulus > 0.0:
        raise ValueError(
            f"kinematic_hardening_modulus = {material.kinematic_hardening_modulus!r}: {LAW} of "
            "Kratos has isotropic hardening only; set it to 0"
        )
    yield_stress = material.yield_stress * MPA
    values = {
        "DENSITY": density * TONNES_PER_MM3,
        "YOUNG_MODULUS": material.youngs_modulus * MPA,
        "POISSON_RATIO": material.poissons_ratio,
        "YIELD_STRESS": yield_stress,
        "ISOTROPIC_HARDENING_MODULUS": material.isotropic_hardening_modulus * MPA,
        "EXPONENTIAL_SATURATION_YIELD_STRESS": yield_stress,  # no exponential hardening
        "HARDENING_EXPONENT": 0.0,
    }
    result = part.CreateNewProperties(number)
    for name, value in values.items():
        result[engine.variable(name)] = value
    law = engine.core.KratosGlobals.GetConstitutiveLaw(LAW)
    result[engine.core.CONSTITUTIVE_LAW] = law.Clone()
    return result


def constrain(engine: Kratos, part: Any, mesh: Mesh, impact: Impact) -> None:
    """Fix nodes on planes of symmetry and supports; launch the sphere and let it fall.

    The sphere alone has gravity, and its velocity now and in the step before.
    """
    held = {"X": mesh.symmetry_x, "Y": mesh.symmetry_y, "Z": mesh.support}
    for axis, nodes in held.items():
        variable = engine.variable(f"DISPLACEMENT_{axis}")
        for node in (nodes + 1).tolist():
            part.GetNode(node).Fix(variable)
    values = {"VELOCITY_Z": impact.velocity, "VOLUME_ACCELERATION_Z": impact.gravity}
    for node in (np.unique(mesh.elements[mesh.body == SPHERE]) + 1).tolist():
        for name, value in values.items():
            for step in (0, 1):
                part.GetNode(node).SetSolutionStepValue(engine.variable(name), step, -value * MM)
