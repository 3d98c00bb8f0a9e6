"""Beams of every shape, and the width over the depth of each, written down anew."""

import numpy as np

import impactlab as il
from impactlab.solver import SHAPES

SIZES = {
    "rectangle": {"width": 0.05, "depth": 0.03},
    "box": {"width": 0.05, "depth": 0.03, "wall_thickness": 0.004},
    "tube": {"width": 0.03, "depth": 0.03, "wall_thickness": 0.003},
    "circle": {"width": 0.03, "depth": 0.03},
    "i": {"width": 0.05, "depth": 0.03, "flange_thickness": 0.004, "web_thickness": 0.002},
    "profile": {"width": 0.05, "depth": 0.03, "profile": "0.0 0.2, 0.6 0.1, 0.6 0.5, 1.0 1.0"},
    "laminate": {"width": 0.05, "depth": 0.03, "layers": "0.6 105000000000.0 172500000.0 3900.0"},
}
"""Fields of a beam of each shape, in m; the laminate's core has half of the steel's values."""
assert SIZES.keys() == set(SHAPES)


def chord(diameter, z):
    return np.sqrt(np.maximum(diameter**2 - 4 * z**2, 0.0))


WIDTHS = {
    "rectangle": lambda z: 0.05 + 0.0 * z,
    "box": lambda z: np.where(abs(z) > 0.011, 0.05, 0.008),
    "tube": lambda z: chord(0.03, z) - chord(0.024, z),
    "circle": lambda z: chord(0.03, z),
    "i": lambda z: np.where(abs(z) > 0.011, 0.05, 0.002),
    "profile": lambda z: np.where(
        abs(z) > 0.009,
        0.05 * (0.5 + 0.5 * (abs(z) / 0.015 - 0.6) / 0.4),
        0.05 * (0.2 - 0.1 * abs(z) / 0.009),
    ),
    "laminate": lambda z: np.where(abs(z) > 0.009, 0.05, 0.025),
}
"""Width (m) at a distance z (m) from the axis."""
BREAKS = {"box": [0.011], "tube": [0.012], "i": [0.011], "profile": [0.009], "laminate": [0.009]}
"""Places above the axis where the width jumps or has a vertical tangent, in m."""


def beam_of(shape, **changes):
    """Return a beam of the paper's steel, a metre long."""
    steel = il.paper_impact().beam.material
    return il.Beam(**{"span": 1.0, "material": steel, "shape": shape} | SIZES[shape] | changes)


def parameters_of(shape):
    """Return the parameters of a beam of that shape, as studies name them."""
    return {"beam_shape": shape} | {f"beam_{name}": size for name, size in SIZES[shape].items()}
