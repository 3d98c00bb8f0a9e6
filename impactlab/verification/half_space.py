"""A sphere on a beam too heavy to move: Hertz's impact on a half-space."""

from __future__ import annotations

from impactlab.model.discretisation import Discretisation
from impactlab.simulate import simulate
from impactlab.verification.cases import rigid_backed
from impactlab.verification.finding import Finding, relative
from impactlab.verification.solutions import hertz

TITLE = "Impact on a half-space"
SOURCE = "Hertz 1881; closed forms in impactlab.verification.solutions.hertz"


def check() -> Finding:
    """Peak force, largest indentation, contact duration and restitution."""
    velocity = 0.99
    impact = rigid_backed(velocity, "hertz")
    modulus, radius = hertz.effective_modulus(impact), hertz.effective_radius(impact)
    args = (impact.sphere.total_mass, velocity, modulus, radius)
    # a small Courant number: here the contact alone sets the time step
    grid = Discretisation(nodes=11, points=3, courant=0.005)
    run = simulate(impact, grid, duration=0.4e-3)
    where = f"the paper's sphere at {velocity} m/s"
    return Finding(
        [
            relative(quantity, where, units, run[name].item(), expected(*args), 2e-5)
            for quantity, name, units, expected in (
                ("peak force", "peak_force", "N", hertz.peak_force),
                ("contact duration", "contact_duration", "s", hertz.contact_duration),
                ("largest indentation", "maximum_indentation", "m", hertz.maximum_indentation),
            )
        ]
        + [relative("restitution", where, "1", run.restitution.item(), 1.0, 2e-5)]
    )
