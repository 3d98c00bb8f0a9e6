"""Timoshenko's first example of a sphere striking a beam (1913)."""

from __future__ import annotations

from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.sphere import Sphere

_KGF_PER_CM2 = 98066.5


def timoshenko_impact(velocity: float = 0.01) -> Impact:
    """A 10 mm-radius steel sphere on a 10 x 10 x 153.5 mm steel beam; velocity in m/s.

    S. Timoshenko, Zur Frage nach der Wirkung eines Stosses auf einen Balken, Z. Math. Phys. 62
    (1913) 198: E = 2.2e6 kgf/cm2, density 7.96 g/cm3, nu = 0.3, quoted at second hand. Without
    gravity, which would matter: during the contact it adds 15 % of the velocity. The yield stress
    is ours; it plays no part in an elastic impact.

    Raises ValueError when the velocity is not finite and positive.
    """
    steel = Material(
        density=7960.0,
        youngs_modulus=2.2e6 * _KGF_PER_CM2,
        poissons_ratio=0.3,
        yield_stress=1e9,
    )
    return Impact(
        sphere=Sphere(radius=0.01, material=steel),
        beam=Beam(span=0.1535, width=0.01, depth=0.01, material=steel),
        velocity=velocity,
        contact="hertz",
        gravity=0.0,
    )
