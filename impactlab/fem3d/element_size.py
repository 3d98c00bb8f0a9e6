"""Convergence of the 3-D FE model in the size of its elements: its axis and its figure's."""

from impactlab.analysis.convergence.axes import Axis, Growth
from impactlab.fem3d.wing import MODEL, SIZES, SOLID

ELEMENT_SIZE = Axis(
    MODEL.axis,
    "the element size",
    dict(zip(SIZES, (lambda size: size, lambda count: 1.0 / count), strict=True)),
    lambda runs: (
        "The elements of the 3-D model shrink about the contact, and the time step with them; "
        "beyond they keep their largest size. Models of the beam do not know the element size, and "
        "agree."
    ),
    Growth(
        "in the contact of a solid, plastic strain gathers at the edge of the dent: its peak grows "
        "as the elements shrink",
        lambda runs: runs["beam_model"] == SOLID,
    ),
)
"""The size of the solid elements about the contact."""
