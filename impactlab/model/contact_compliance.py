"""The local compliance that law and beam model both count, taken out: `contact_compliance: beam`.

A contact law is that of two half-spaces: its approach is measured from points far away. The beam's
axis lies half a depth below, the sphere's centre a radius above. With F the contact force and M
the moment at mid-span the approach of sphere and Timoshenko beam is

    delta + c F + gamma M/(EI),   c = c_b/(E_b H) + c_s/(E_s R),   gamma = g H^2

c_b and g, of H/B and Poisson's ratio, are what 3-D elastic statics of a beam under a point force
have beyond the half-space and Timoshenko's deflection (k = 5/6): two spans tell the part that
grows with the moment from the rest. c_s, of Poisson's ratio, is that of a free sphere whose even
deceleration balances the force. tests/benchmarks/contact_compliance.py makes the table; on the
paper's beam finer elements change it by 0.2 %. In statics M = F L/4, and gamma M/(EI) is most of
the compliance; in an impact the moment is some tenth of that, which is why a constant from
statics takes back too much.

Left out: what the section does in waves across the width or shorter than it, and c_s for other
circles than R/16 (from R/33 to R/8, 6 % of it).
"""

from __future__ import annotations

import numpy as np

from impactlab.model.impact import Impact
from impactlab.types import Floats

DEPTHS = (0.2, 0.3, 0.45, 0.7, 1.0, 1.5, 2.5, 4.0)
"""H/B of the table."""
RATIOS = (0.0, 0.25, 0.45)
"""Poisson's ratios of the table."""
FORCE = np.array(
    [
        [0.615, 2.2682, 3.8894],
        [-0.1538, 0.5056, 1.134],
        [-0.5792, -0.3155, -0.0515],
        [-0.869, -0.7543, -0.5982],
        [-1.0379, -0.9555, -0.7969],
        [-1.1702, -1.0871, -0.8795],
        [-1.1346, -1.0241, -0.7044],
        [-0.6394, -0.479, 0.0319],
    ]
)
"""c_b = c E H at these, shape (depths, ratios)."""
MOMENT = np.array(
    [
        [-0.0064, -0.7086, -1.4125],
        [-0.0015, -0.3307, -0.6448],
        [-0.0004, -0.1689, -0.3199],
        [-0.0004, -0.0968, -0.178],
        [-0.0002, -0.0722, -0.131],
        [-0.0002, -0.0597, -0.1076],
        [-0.0002, -0.0536, -0.0963],
        [-0.0002, -0.0515, -0.0926],
    ]
)
"""g = gamma/H^2 at these."""
SPHERE = (0.0158, -0.2795, -0.3359)
"""c_s = c E R at these ratios."""
TIMOSHENKO_ALONE = "is what a beam adds to Timoshenko's deflection: set beam_model: timoshenko"
LEAST_SPAN = 3.0
"""Of the beam, over the larger of depth and width: the table's shortest."""


def _at_ratio(nu: Floats, values: Floats) -> Floats:
    """Return the parabola through `values` (..., ratios), at nu (...)."""
    total = np.zeros(np.shape(nu))
    for i, here in enumerate(RATIOS):
        others = [there for there in RATIOS if there != here]
        share = np.prod([(nu - there) / (here - there) for there in others], axis=0)
        total = total + share * values[..., i]
    return total


def contact_compliance(impact: Impact) -> tuple[Floats, Floats]:
    """Return c (m/N) and gamma (m2) of an impact, or of many; zero for half-spaces.

    Raises ValueError where the beam is none of Timoshenko's, or outside the table.
    """
    asked = np.equal(impact.contact_compliance, "beam")
    if not np.any(asked):
        return np.zeros(()), np.zeros(())
    beam, sphere, steel = impact.beam, impact.sphere, impact.beam.material
    refused = "Impact.contact_compliance = 'beam': "
    if np.any(asked & np.not_equal(impact.beam_model, "timoshenko")):
        raise ValueError(f"{refused}{TIMOSHENKO_ALONE}")
    shape = np.asarray(beam.depth / beam.width)
    if np.any(asked & ((shape < DEPTHS[0]) | (shape > DEPTHS[-1]))):
        raise ValueError(
            f"{refused}needs a beam of depth over width from {DEPTHS[0]} to {DEPTHS[-1]}"
        )
    if np.any(asked & (beam.span < LEAST_SPAN * np.maximum(beam.depth, beam.width))):
        raise ValueError(f"{refused}needs a span of {LEAST_SPAN:g} depths and widths at least")
    from scipy.interpolate import CubicSpline  # half a second to import, for few

    nu, depth = np.asarray(steel.poissons_ratio), beam.depth
    tables = (CubicSpline(np.log(DEPTHS), table)(np.log(shape)) for table in (FORCE, MOMENT))
    force, moment = (_at_ratio(nu, table) for table in tables)
    ball = _at_ratio(np.asarray(sphere.material.poissons_ratio), np.asarray(SPHERE))
    c = force / (steel.youngs_modulus * depth)
    c = c + ball / (sphere.material.youngs_modulus * sphere.radius)
    shear = (1.0 / beam.shear_coefficient - 6.0 / 5.0) * (1.0 + nu) / 6.0
    return np.where(asked, c, 0.0), np.where(asked, (moment - shear) * depth * depth, 0.0)
