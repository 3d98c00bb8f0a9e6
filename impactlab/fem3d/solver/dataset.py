"""One impact on one mesh, solved and returned as a dataset, with snapshots of it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.solver.compiler import COMPILER
from impactlab.fem3d.solver.evaluation import fields, plastic_responses, responses
from impactlab.fem3d.solver.march import Energies, History, March, Progress
from impactlab.fem3d.solver.mesh import Mesh, check_mesh, impact_mesh, plane_faces
from impactlab.fem3d.solver.system import System, ThreadPool
from impactlab.model.checks import integer, positive
from impactlab.model.contact_compliance import TIMOSHENKO_OPTIONS
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, SECTION, flatten
from impactlab.provenance import provenance
from impactlab.types import Floats
from impactlab.variables import described

FRAMES = {
    "field_time": ("s", "time of the fields since first touch"),
    "section_position": ("m", "corners of the faces in the plane along the beam, x and z"),
    "section_plastic_strain": ("1", "equivalent plastic strain (PEEQ) of their elements"),
}
"""Units and long_name of what a run keeps."""


class Frames:
    """Displaced corners of the plane's faces, and the strain of their elements, over time."""

    def __init__(self, system: System) -> None:
        """Keep the beginning."""
        self._system = system
        mesh = system.mesh
        self._elements, self._nodes = plane_faces(mesh.nodes, mesh.elements, 1, mesh.element_size)
        self._times, self._positions, self._strains = list[float](), list[Any](), list[Any]()
        self.keep(0.0)

    def keep(self, time: float) -> None:
        """Keep the present state, as that at a time in s, unless that of this time is kept."""
        if self._times and time <= self._times[-1]:
            return
        system = self._system
        strain = fields(system.groups, len(system.mesh.elements))["equivalent_plastic_strain"]
        self._times.append(time)
        self._positions.append(system.x[self._nodes][..., [0, 2]])
        self._strains.append(strain[self._elements])

    def variables(self) -> dict[str, Any]:
        """Return the variables FRAMES."""
        dims = ("field_time", "face")
        return {
            "field_time": self._times,
            "section_position": ((*dims, "face_corner", "section_axis"), np.array(self._positions)),
            "section_plastic_strain": (dims, np.array(self._strains)),
        }


def solve(
    impact: Impact, *, element_size: float, patch: float | None = None, **options: Any
) -> xr.Dataset:
    """Solve one impact as solve_on, on the mesh of impact_mesh; element_size, patch: in m."""
    mesh = impact_mesh(impact, element_size=element_size, patch=patch)
    return solve_on(mesh, impact, **options)


def solve_on(
    mesh: Mesh,
    impact: Impact,
    *,
    duration: float,
    samples: int = 2001,
    threads: int = 1,
    progress: Progress | None = None,
    frames: bool = False,
) -> xr.Dataset:
    """Solve one impact on `mesh`; contact law and model of the beam in `impact` play no part.

    duration: simulated time in s. samples: length of `time`, equally spaced. threads: the answers
    are the same to the last bit for any number. progress: called a hundred times per run with the
    share done. frames: whether to keep the plane along the beam on `field_time` as often.

    Returns a Dataset with the histories and responses of impactlab.variables that a 3-D FE model
    has (`status` says why one is NaN), energies on `checkpoint`, plastic strains and von Mises
    stress on `element`, displacements on `node`, and the mesh as coordinates. A run that was
    interrupted by Ctrl-C, diverged, or stopped because elements were squeezed flat or the contact
    left the patch of matched nodes, returns what it has computed until then, and the attribute
    `stopped` gives the reason; `patch_needed` is the patch to take, in m.

    Raises ValueError when a number is not valid, the mesh is of other bodies, or the duration below
    a time step.
    """
    positive("solve", "duration", duration)
    check_mesh(mesh, impact)
    samples = integer("solve", "samples", samples, 2)
    with ThreadPool(integer("solve", "threads", threads, 1)) as pool:
        system = System(mesh, impact, pool)
        march, kept = March(system, impact), Frames(system) if frames else None

        def watch(share: float) -> None:
            if kept:
                kept.keep(march.history.moments[-1].time)
            if progress:
                progress(share)

        history = march.run(duration, watch)
    answers = to_dataset(system, impact, history, samples)
    return named(answers.assign(kept.variables()), FRAMES) if kept else answers


def compile_all() -> Path | None:
    """Compile the loops into their cache; return its folder, None where they cannot be kept."""
    solve(paper_impact(), element_size=4e-3, duration=2e-6)
    return COMPILER.folder


OWN = {
    "node_position": ("m", "position of the mesh's nodes at first touch (z upwards)"),
    "element_nodes": ("1", "numbers of a hexahedron's nodes, in VTK's order"),
    "body": ("1", "0: of the beam, 1: of the sphere"),
    "fully_integrated": ("1", "whether an element has eight integration points"),
    "checkpoint_time": ("s", "time since first touch"),
    "displacement": ("m", "displacement of the nodes at the end (z upwards)"),
    "von_mises_stress": ("Pa", "von Mises stress at the end, mean of the element"),
    "largest_equivalent_plastic_strain": ("1", "largest PEEQ of an element's integration points"),
    "sphere_plastic_strain": ("1", "largest PEEQ in the sphere"),
    "one_point_plastic_strain": ("1", "largest PEEQ in elements with one integration point"),
    "node_offset": ("1", "largest slide of matched nodes in touch, over the element size"),
    "kinetic_energy": ("J", "kinetic energy of beam and sphere"),
    "strain_work": ("J", "work of the stresses, kept and dissipated"),
    "plastic_work": ("J", "work dissipated by plastic flow"),
    "hourglass_work": ("J", "work against hourglassing"),
    "contact_work": ("J", "work against overlaps in the contact, kept and lost"),
    "gravity_work": ("J", "work of gravity on the sphere"),
    "spring_energy": ("J", "energy of the springs of elastic ends and foundation"),
    "damping_work": ("J", "work that the beam's damping took"),
    "element_size": ("m", "size of the elements about the contact"),
    "patch": ("m", "half the side of the square in which nodes are matched"),
    "number_of_elements": ("1", "elements of the part that is solved"),
    "copies": ("1", "parts like it that make up beam and sphere: 4 quarters or 2 halves"),
    "time_step": ("s", "time step at the beginning"),
    "number_of_steps": ("1", "time steps taken"),
}
"""Units and long_name of variables that impactlab.variables does not have."""
_COMMENTS = {
    "peak_plastic_strain": "of the beam, the contact included, where it grows with finer meshes",
    "plastic_dissipation": "in all of beam and sphere, the contact included",
    "permanent_indentation": "mean of what the surfaces keep of the indentation from the last "
    "contact to the end: bending and vibrations that go on until then leave a part of themselves",
    "number_of_contacts": "without pauses in which a wave does not cross the patch twice there and "
    "back",
    "sphere_displacement": "of the sphere's centre of mass",
    "midspan_deflection": "of the axis below the impact, at mid-depth and mid-width",
}
IMPACT_PARAMETERS = [
    name
    for name, entry in PARAMETERS.items()
    if entry.path[0] == "impact"
    and name not in ("contact", *TIMOSHENKO_OPTIONS, "beam_model", "load", "shear_coefficient")
    and name not in (*SECTION, "damping_ratio", "strike_interval", "further_spheres")
]
"""Parameters of an impact, without those of the beam models alone."""


def to_dataset(system: System, impact: Impact, history: History, samples: int) -> xr.Dataset:
    """Return all answers of a run, as described in solve_on."""
    mesh, steel = system.mesh, impact.beam.material
    element_fields = fields(system.groups, len(mesh.elements))
    # A pause in which a wave crosses the patch twice there and back parts contacts.
    pause = 4.0 * mesh.patch / float(np.sqrt(steel.youngs_modulus / steel.density))
    answers, status = responses(history, impact, pause)
    answers |= plastic_responses(mesh, impact, element_fields["largest_equivalent_plastic_strain"])
    worked = history.energies[-1].plastic_work if history.energies else np.nan
    answers["plastic_dissipation"] = worked
    last = history.moments[-1].time
    even = np.linspace(0.0, last, samples)
    energies = np.array(history.energies).reshape(-1, len(Energies._fields)).T
    checkpoints = dict(zip(Energies._fields, energies, strict=True))
    times = checkpoints.pop("time")
    parameters = flatten(impact, Discretisation()) | {"sphere_mass": impact.sphere.total_mass}
    dataset = xr.Dataset(
        {
            **answers,
            "status": np.int32(status),
            "node_offset": history.offset,
            **{
                name: ("time", np.interp(even, history.table()[0], values))
                for name, values in histories(history).items()
            },
            **{name: ("checkpoint", values) for name, values in checkpoints.items()},
            **{name: ("element", values) for name, values in element_fields.items()},
            "displacement": (("node", "axis"), system.x - mesh.nodes),
        },
        coords={
            **{name: parameters[name] for name in IMPACT_PARAMETERS},
            "time": even,
            "checkpoint_time": ("checkpoint", times),
            "node_position": (("node", "axis"), mesh.nodes),
            "axis": ["x", "y", "z"],
            "element_nodes": (("element", "corner"), mesh.elements),
            "body": ("element", mesh.body),
            "fully_integrated": ("element", mesh.full),
            "element_size": mesh.element_size,
            "patch": mesh.patch,
            "number_of_elements": len(mesh.elements),
            "copies": mesh.copies,
            "number_of_steps": len(history.moments),
            "time_step": history.moments[1].time - history.moments[0].time,
            "duration": last,
        },
        attrs=provenance() | {"model": "3-D finite elements"},
    )
    if history.stopped:
        dataset.attrs["stopped"] = history.stopped
    if history.patch_needed:
        dataset.attrs["patch_needed"] = history.patch_needed
    for name, comment in _COMMENTS.items():
        dataset[name].attrs["comment"] = comment
    return named(dataset, OWN)


def histories(history: History) -> dict[str, Floats]:
    """Return the histories by name, at the history's times."""
    _, force, sphere, _, axis, _, _ = history.table()
    return {
        "contact_force": force,
        "midspan_deflection": axis,
        "sphere_displacement": sphere,
        "indentation": sphere - axis,
    }


def named(dataset: xr.Dataset, more: Mapping[str, tuple[str, str]]) -> xr.Dataset:
    """Return the dataset with attributes on all variables; more: units and long_name of others."""
    dataset = described(dataset)
    for name, (units, long_name) in more.items():
        if name in dataset.variables:
            dataset[name].attrs |= {"units": units, "long_name": long_name}
    return dataset
