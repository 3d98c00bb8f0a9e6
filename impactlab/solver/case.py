"""The case table: one record a run, everything the kernels need to know of it.

The fields are the parameters of model/parameters.py, in SI, with contact law, model of the beam,
rule and scheme as numbers (their places in contact.LAWS, BEAM_MODELS, RULES and SCHEMES) and the
sphere's mass resolved; and the duration in s.
"""

from __future__ import annotations

import numpy as np

WHOLE = ("contact", "beam_model", "nodes", "points", "rule", "scheme")
REAL = (
    "duration",
    "velocity",
    "gravity",
    "sphere_radius",
    "sphere_mass",
    "sphere_density",
    "sphere_youngs_modulus",
    "sphere_poissons_ratio",
    "sphere_yield_stress",
    "beam_span",
    "beam_width",
    "beam_depth",
    "shear_coefficient",
    "beam_density",
    "beam_youngs_modulus",
    "beam_poissons_ratio",
    "beam_yield_stress",
    "beam_isotropic_hardening_modulus",
    "beam_kinematic_hardening_modulus",
    "courant",
)

CASE = np.dtype(
    (np.record, [(name, np.int64) for name in WHOLE] + [(name, float) for name in REAL])
)
"""Record type of the case table."""
