"""The source paper's case."""

from __future__ import annotations

from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.sphere import Sphere


def paper_impact(velocity: float = 0.99, contact: str = "stronge") -> Impact:
    """Return the impact of the paper's Tables 2 and 3: Gr 15 sphere, Q345 beam; velocity in m/s.

    Masses follow from density and volume: the sphere's 1.4009 kg agrees with the printed 1.4 kg,
    the beam's 10.148 kg does not with the printed 10.929 kg (that would be 840 mm of beam).

    Raises ValueError when velocity or contact is not valid (see Impact).
    """
    gr15 = Material(density=7800.0, youngs_modulus=208e9, poissons_ratio=0.3, yield_stress=2550e6)
    q345 = Material(density=7800.0, youngs_modulus=210e9, poissons_ratio=0.3, yield_stress=345e6)
    return Impact(
        sphere=Sphere(radius=0.035, material=gr15),
        beam=Beam(span=0.78, width=0.06, depth=0.0278, material=q345),
        velocity=velocity,
        contact=contact,
    )
