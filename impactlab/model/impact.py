"""One impact: who strikes what, how fast, under which contact law."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.beam import Beam
from impactlab.model.checks import instance, not_negative, one_of, positive
from impactlab.model.sphere import Sphere
from impactlab.solver import BEAM_MODELS
from impactlab.solver.contact import LAWS

SOLID = "solid"
"""The word for the 3-D model of beam and sphere (impactlab.fem3d), no kernel's."""
MODELS = (*BEAM_MODELS, SOLID)
"""Names of all models of the beam."""


@dataclass(frozen=True, kw_only=True)
class Impact:
    """A sphere hits the middle of a beam at rest.

    velocity: the sphere's, downwards at first touch, in m/s. contact: the name of a contact law
    (impactlab.solver.contact.LAWS). gravity: acts on the sphere alone, in m/s2. beam_model:
    "euler_bernoulli" (the paper's, of yielding fibres), "elastic" (the same, no fibre yields),
    "timoshenko" (with transverse shear and rotary inertia), "spring_mass" (Wang et al.: one degree
    of freedom), "rigid" (the beam does not move) or "solid" (3-D finite elements of both bodies,
    in which `contact` plays no part).

    Raises ValueError naming the field when a value is not physical or a name is unknown.
    """

    sphere: Sphere
    beam: Beam
    velocity: float
    contact: str = "stronge"
    gravity: float = 9.81
    beam_model: str = "euler_bernoulli"

    def __post_init__(self) -> None:
        instance("Impact", "sphere", self.sphere, Sphere)
        instance("Impact", "beam", self.beam, Beam)
        positive("Impact", "velocity", self.velocity)
        not_negative("Impact", "gravity", self.gravity)
        one_of("Impact", "contact", self.contact, LAWS)
        one_of("Impact", "beam_model", self.beam_model, MODELS)
