"""The compiled core: numbers and arrays in and out, SI throughout, symbols as in the paper.

This file stays free of numba, so that names can be looked up without compiling anything.
"""

from typing import Any

RULES = ("lobatto", "legendre", "layers")
"""Names of the integration rules over the depth; the index is the kernels' switch."""
SCHEMES = ("leapfrog", "modal")
"""Names of the schemes in time; the index is the kernels' switch."""
BEAM_MODELS = (
    "euler_bernoulli",
    "elastic",
    "timoshenko",
    "von_karman",
    "spring_mass",
    "rigid",
)
"""Names of the models of the beam; the index is the kernels' switch."""
LUMPED_MODELS = BEAM_MODELS[4:]
"""Those that move as one mass."""
SHAPES = ("rectangle", "box", "tube", "circle", "i", "profile", "laminate")
"""Names of the shapes of the section (model/section.py); the index is the kernels' switch."""
SUPPORTS = ("pinned", "clamped", "free", "elastic", "roller")
"""What holds an end of the beam; the index is the kernels' switch, in which a roller is pinned."""
AXIAL_SUPPORTS = ("pinned", "clamped")
"""Supports that hold the axis."""
RAYLEIGH = ("mass_damping", "stiffness_damping")
"""Rayleigh's damping of the beam: fields of beams and of the case table."""
DAMPINGS = (*RAYLEIGH, "damping_ratio")
"""What damps the beam: fields of beams and of the case table."""
RESISTANCES = (*DAMPINGS, "foundation_stiffness")
"""What resists the beam's motion beside bending: fields of beams and of the case table."""
LOADS = ("point", "contact_patch")
"""Where the contact force acts on the beam; the index is the kernels' switch."""
COMPLIANCES = ("half_space", "beam", "strip")
"""What the contact laws' half-spaces stand for (model/contact_compliance.py)."""
PRESTRESSES = ("ignored", "bending")
"""What stress the metal is under where the contact yields (contact/prestress.py)."""
BENDING_MODELS = BEAM_MODELS[:2]
"""Those that have every scheme in time; the others have leapfrog alone."""
WAVE_MODELS = BEAM_MODELS[:4]
"""Those of which every node moves, with any ends, on a foundation, damped, struck anywhere."""
FLOW_LAWS = ("linear",)
"""Names of the built-in flow laws of the beam's fibres; the index is the kernels' switch."""
FLOW_LAWS_OUTSIDE: dict[int, Any] = {}
"""Those from outside by their numbers (model/flow_law.py), those of an earlier source included."""
OUTSIDE = 2**52
"""Least number of laws from outside the package; theirs follow from the hashes of their sources."""
