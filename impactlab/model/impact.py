"""One impact: who strikes what, how fast, under which contact law."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.kernels.contact import LAWS
from impactlab.model.beam import Beam
from impactlab.model.checks import not_negative, one_of, positive
from impactlab.model.sphere import Sphere


@dataclass(frozen=True, kw_only=True)
class Impact:
    """A sphere hits the middle of a beam at rest.

    velocity: the sphere's, downwards at first touch, in m/s. contact: the name of a contact law
    (impactlab.kernels.contact.LAWS). gravity: acts on the sphere alone, in m/s2.

    Raises ValueError naming the field when a value is not physical or the law is unknown.
    """

    sphere: Sphere
    beam: Beam
    velocity: float
    contact: str = "stronge"
    gravity: float = 9.81

    def __post_init__(self) -> None:
        positive("Impact", "velocity", self.velocity)
        not_negative("Impact", "gravity", self.gravity)
        one_of("Impact", "contact", self.contact, LAWS)
