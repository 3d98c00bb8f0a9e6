"""The types of the kernels' arguments and results, and the record of a case."""

from typing import Any

import numpy as np

from impactlab.solver import BEAM_MODELS, LOADS, SCHEMES, SHAPES

Array = np.ndarray[Any, Any]
"""An array; the docstring gives shape and unit."""
Record = Any
"""One record of a structured array, its fields read and set by name."""
Index = Any
"""A position in an array, signed or not."""
ONE, TWO = np.uint64(1), np.uint64(2)
"""Offsets for an unsigned index. A loop over one gets vectorised from wherever it begins; a signed
index might be negative, that is, count from the end."""
Unloading = tuple[float, float, float, float]
"""What a contact law's `curve` gives: see contact/hertz.py."""
Shape = tuple[float, ...]
Crowding = tuple[float, float]
HALF_SPACE: Crowding = (0.0, 0.0)
"""What a law's `shape` makes of the two metals, for its `curve`: see contact/metals.py."""

ELASTIC = BEAM_MODELS.index("elastic")
TIMOSHENKO = BEAM_MODELS.index("timoshenko")
VON_KARMAN = BEAM_MODELS.index("von_karman")
SPRING_MASS = BEAM_MODELS.index("spring_mass")
RIGID = BEAM_MODELS.index("rigid")
MODAL = SCHEMES.index("modal")
RECTANGLE = SHAPES.index("rectangle")
CIRCLE = SHAPES.index("circle")
TUBE = SHAPES.index("tube")
LAMINATE = SHAPES.index("laminate")
CONTACT_PATCH = LOADS.index("contact_patch")


def record(real: str, integers: str = "") -> np.dtype[Any]:
    """Return a record type of whole numbers and floats, each given as names with spaces between."""
    fields = [(n, np.int64) for n in integers.split()] + [(n, float) for n in real.split()]
    return np.dtype((np.record, fields))


LAYERS = 8
"""Most layers of a laminate that a case holds, beside the outer one."""
SPHERES = 8
"""Most further spheres that a case holds."""
PROFILE = 16
"""Most points of the width over the depth that a case holds."""
CASE = record(
    """
    duration velocity gravity sphere_radius sphere_mass
    sphere_density sphere_youngs_modulus sphere_poissons_ratio sphere_yield_stress
    beam_span beam_width beam_depth beam_wall_thickness beam_flange_thickness beam_web_thickness
    shear_coefficient
    mass_per_length rotary_inertia shear_stiffness stress_per_moment plastic_modulus
    skin_thickness
    beam_density beam_youngs_modulus beam_poissons_ratio beam_yield_stress
    beam_isotropic_hardening_modulus beam_kinematic_hardening_modulus
    beam_rate_coefficient beam_rate_exponent beam_rate_sensitivity beam_reference_rate courant
    strike_position strike_interval
    stiffness_left stiffness_right rotational_stiffness_left rotational_stiffness_right
    mass_damping stiffness_damping damping_ratio foundation_stiffness
    compliance bending_compliance stress_along stress_across crowding crowding_in_depth
    width_stiffness width_inertia width_lever width_twist axis_compliance axis_bending
    """,
    integers="contact beam_model load contact_prestress support_left support_right"
    " axis_held_left axis_held_right beam_flow_law beam_shape nodes points rule scheme strikes"
    " further",
)
CASE = np.dtype(
    (
        np.record,
        [
            *CASE.descr,
            ("beam_profile", float, (PROFILE, 2)),
            ("beam_layers", float, (LAYERS, 4)),
            ("further_spheres", float, (SPHERES, 3)),
        ],
    )
)
"""Record type of the case table: one record per run, everything the kernels need to know of it.

The fields are the parameters of model/parameters.py, in SI, with contact law, beam model, load,
supports, flow law, shape, rule and scheme as numbers (their places in contact.LAWS, BEAM_MODELS,
LOADS, SUPPORTS, FLOW_LAWS, SHAPES, RULES and SCHEMES), the sphere's mass and the shear coefficient
resolved, thicknesses that the shape does not have as 0, the points of a profile, (PROFILE, 2), and
the rows of layers, (LAYERS, 4), 0 after the last; rows of further spheres, (SPHERES, 3), as many as
`further` says: place, velocity and delay; the time between strikes, 0 where the beam rests in
between; the duration in s; whether supports hold the axis; and what follows from them: of the
section (model/section.py) rho A, rho I, k G A, the stress in the outermost fibre over the bending
moment, the plastic modulus and the thickness of the outer layer, and of contact and strip those of
model/contact_compliance.py.
"""
