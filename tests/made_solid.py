"""Invented answers of a 3-D run on a real mesh: quick, of plausible size, not physics."""

from functools import cache

import numpy as np
import xarray as xr

from impactlab.fem3d.comparison import simulate_beams
from impactlab.fem3d.solver import impact_mesh
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import flatten
from impactlab.variables import STATUS_FLAGS, described

RESPONSES = {
    "peak_force": 11e3,
    "contact_duration": 0.2e-3,
    "number_of_contacts": 1.0,
    "permanent_indentation": 40e-6,
    "maximum_deflection": np.nan,
    "peak_plastic_strain": 0.02,
    "remote_plastic_strain": 0.0,
}
DEPTH_OF_STRAIN = 3e-3
"""PEEQ falls from 2 % at first touch to none so far away, in the beam."""


@cache
def _mesh():
    return impact_mesh(paper_impact(), element_size=2e-3)


def solid():
    """Return the paper's case on a mesh of 2 mm: strains about the contact, waves in time."""
    mesh = _mesh()
    centres = mesh.nodes[mesh.elements].mean(axis=1)
    strain = 0.02 * np.clip(1.0 - np.linalg.norm(centres, axis=1) / DEPTH_OF_STRAIN, 0.0, None)
    strain[mesh.body == 1] = 0.0
    time = np.linspace(0.0, 0.45e-3, 50)
    wave = np.sin(np.pi * time / time[-1])
    displacement = 1e-4 * np.sin(np.arange(mesh.nodes.size)).reshape(mesh.nodes.shape)
    values = {name: ((), value) for name, value in RESPONSES.items()}
    dataset = xr.Dataset(
        values
        | {
            "status": ((), np.int32(STATUS_FLAGS["deflection_still_growing"][0])),
            "contact_force": ("time", 11e3 * wave),
            "midspan_deflection": ("time", 1e-4 * wave),
            "indentation": ("time", 7e-5 * wave),
            "equivalent_plastic_strain": ("element", strain),
            "von_mises_stress": ("element", 1e8 * np.cos(np.arange(len(mesh.elements)))),
            "displacement": (("node", "axis"), displacement),
        },
        coords={
            "time": time,
            "axis": ["x", "y", "z"],
            "node_position": (("node", "axis"), mesh.nodes),
            "element_nodes": (("element", "corner"), mesh.elements),
            "body": ("element", mesh.body),
            "fully_integrated": ("element", mesh.full),
            "element_size": mesh.element_size,
            "patch": mesh.patch,
            "number_of_elements": len(mesh.elements),
            "copies": mesh.copies,
            "duration": float(time[-1]),
            **{name: flatten(paper_impact(), Discretisation())[name] for name in _GIVEN},
        },
    )
    return described(dataset)


_GIVEN = ("velocity", "beam_depth", "beam_span", "sphere_radius")


@cache
def beam_models():
    """Return the beam models' own answers to the paper's case."""
    return simulate_beams(paper_impact(), Discretisation(nodes=21, points=3), 0.45e-3)
