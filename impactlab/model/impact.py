"""One impact: who strikes what, how fast, under which contact law; and the source paper's case.

Quantities are numbers in SI units, strings with a unit ("27.8 mm") or quantities of pint; fields
hold SI numbers.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from impactlab import wings
from impactlab.model.bodies import Beam, Sphere, spheres_text
from impactlab.model.checks import among, instance, integer, number, one_of, positive, require
from impactlab.model.contact_law import LAW_NAMES, ContactLaw
from impactlab.model.material import Material
from impactlab.model.quantities import SI, Quantity, engineering
from impactlab.solver import (
    BEAM_MODELS,
    COMPLIANCES,
    FLOW_LAWS,
    LOADS,
    PRESTRESSES,
    RAYLEIGH,
    WAVE_MODELS,
)

MODELS = (*BEAM_MODELS, *wings.models())
"""Names of all models of the beam."""
MOVING_MODELS = (*WAVE_MODELS, *wings.models())
"""Those of which every place moves, with any ends, struck anywhere."""
MODELS_ON_SPRINGS = (*WAVE_MODELS, *wings.models())
"""Those with elastic ends and a foundation."""
MID_SPAN = 0.5
"""Usual place of the strike over the span."""
HINGES = ("pinned", "roller")
"""Supports against deflection alone; a roller does not hold the axis (solver/von_karman.py)."""
MOVING_SUPPORTS = ("free", "elastic")
"""Supports whose end can be struck."""
SPRUNG_BEAM = (
    f"{' or '.join(MODELS_ON_SPRINGS)} with elastic ends: change it, or set other supports"
)
"""End of messages on what elastic ends cannot have."""
DAMPED_BEAM = (
    f"{' or '.join(MODELS_ON_SPRINGS)} with {' or '.join(RAYLEIGH)}: change it, or set these to 0"
)
"""The same, of Rayleigh's damping of the beam."""
RATIO_DAMPED_BEAM = (
    f"{' or '.join(WAVE_MODELS)} with damping_ratio: change it, or set that to 0; "
    f"{' and '.join(RAYLEIGH)} damp any of {', '.join(MODELS_ON_SPRINGS)}"
)
"""The same, of one ratio for all modes."""
FOUNDED_BEAM = (
    f"{' or '.join(MODELS_ON_SPRINGS)} with foundation_stiffness: change it, or set that to 0"
)
"""The same, of a foundation."""
STRETCHED_LAYERS = (
    "must not be von_karman with shape: laminate, for it stretches one metal alone: change it, or "
    "set another shape"
)
"""Message on sections of layers."""
OTHER_BEAM = (
    "with ends that are not pinned, or a strike beside mid-span: change it, or set support_left: "
    "pinned, support_right: pinned and strike_position: 0.5"
)
"""Ends of messages on what other beams cannot have."""
OTHER_MODEL = f"a model of the beam other than {', '.join(BEAM_MODELS)}"
"""End of the message on what other models cannot have."""
OTHER_SECTION = "with a section that is no rectangle: change it, or set shape: rectangle"
"""The same, of other sections."""


@dataclass(frozen=True, kw_only=True)
class Impact:
    """A sphere that hits a beam at rest.

    Parameters
    ----------
    sphere : Sphere
        Striking body.
    beam : Beam
        Struck body.
    velocity : Quantity
        Velocity of the sphere, downwards at first touch, in m/s.
    contact : str, default "finite_element"
        Contact law (impactlab.solver.contact.LAWS), or a registered one (`il.register`) by its
        name or as it is; the default agrees best with 3-D finite elements (docs/agreement.md).
    gravity : Quantity, default 9.81
        Acceleration of the sphere alone, in m/s2.
    beam_model : str, default "euler_bernoulli"
        "euler_bernoulli" (the paper's, of yielding fibres), "elastic" (the same, no fibre yields),
        "timoshenko" (with transverse shear and rotary inertia), "von_karman" (with the axial force
        of large deflections), "spring_mass" (Wang et al.: one
        degree of freedom), "rigid" (the beam does not move), or "solid" (3-D finite elements of
        both bodies, in which `contact` and `load` play no part).
    load : {"point", "contact_patch"}, default "point"
        Place of the contact force: the struck point, or the contact circle
        (solver/contact_patch.py; not on lumped beams).
    contact_compliance : {"half_space", "beam", "strip"}, default "half_space"
        Local compliance: that of the contact law, of this beam and sphere, or of a beam that bends
        across its width, too (model/contact_compliance.py). Others than the default need
        `beam_model="timoshenko"`.
    contact_prestress : {"ignored", "bending"}, default "ignored"
        Stress from the beam's bending that changes the force at which the contact yields, and what
        the contact's flow does to the section (solver/contact/prestress.py, kink.py, punching.py).
        "bending" needs `beam_model="timoshenko"`.
    strike_position : Quantity, default 0.5
        Place that the sphere strikes, as a share of the span from the left end; it must lie on a
        node of the discretisation, and on an end only where that is free. Others than mid-span need
        what other ends need.
    strikes : int, default 1
        Number of times that a sphere with this velocity strikes this place, the beam at rest again
        before each (solver/settle.py) unless `strike_interval` is stated: plastic strains and dent
        are carried over. Responses are those of the last strike, but that dents, plastic strains
        and dissipated energies are what all of them have left, and deflections count from the axis
        before the first. More than one need ends or a foundation that hold the beam, and another
        beam model than "solid".
    strike_interval : Quantity, optional
        Time from one strike to the next, in s, between which the beam goes on moving; at least the
        duration, after which the sphere of the strike before is taken away. By default the beam
        comes to rest in between.
    further_spheres : str or sequence of mappings, optional
        Further spheres like `sphere`, at most 8: the `strike_position` of each, which no other has,
        its `velocity`, and its `delay` (by default 0), the time from the first sphere's touch to
        its own; or rows of these in SI. Scalar responses are those of the first sphere. With
        several strikes all come again in each. They need a beam model whose nodes move, and by
        scheme "modal" a point load (solver/several_spheres.py). Kept as text, "0.25 3.0 0.0005".

    Raises
    ------
    ValueError
        If a value is not physical or a name is unknown; the message names the field.

    Examples
    --------
    >>> paper = il.paper_impact()
    >>> impact = il.Impact(sphere=paper.sphere, beam=paper.beam, velocity="7.2 km/h")
    >>> impact.velocity
    2.0
    >>> il.Impact(sphere=paper.sphere, beam=paper.beam, velocity="2 kg")
    Traceback (most recent call last):
    ValueError: Impact.velocity = '2 kg': 'kg' has the wrong dimension; expected a velocity ...
    """

    sphere: Sphere
    beam: Beam
    velocity: SI[float] = SI("m s-1")
    contact: str = "finite_element"
    gravity: SI[float] = SI("m s-2", 9.81)
    beam_model: str = "euler_bernoulli"
    load: str = "point"
    contact_compliance: str = "half_space"
    contact_prestress: str = "ignored"
    strike_position: SI[float] = SI("1", MID_SPAN)
    strikes: int = 1
    strike_interval: SI[float | None] = SI("s", None)
    further_spheres: Any = None

    def __post_init__(self) -> None:
        instance("Impact", "sphere", self.sphere, Sphere)
        instance("Impact", "beam", self.beam, Beam)
        strikes = integer("Impact", "strikes", self.strikes, 1)
        object.__setattr__(self, "strikes", strikes)
        alone = np.equal(strikes, 1) | among(self.beam_model, BEAM_MODELS)
        require(alone, "Impact", "strikes", strikes, f"must be 1 with {OTHER_MODEL}")
        linear = among(self.beam.material.flow_law, FLOW_LAWS)
        message = "must be 1 with a flow_law of one's own, with which the beam is not put to rest"
        require(np.equal(strikes, 1) | linear, "Impact", "strikes", strikes, message)
        if self.strike_interval is not None:
            positive("Impact", "strike_interval", self.strike_interval)
        positive("Impact", "velocity", self.velocity)
        gravity = number("Impact", "gravity", self.gravity)
        require(gravity >= 0, "Impact", "gravity", gravity, "must not be negative")
        law: Any = self.contact
        if isinstance(law, ContactLaw):
            object.__setattr__(self, "contact", LAW_NAMES.registered(law))
        one_of("Impact", "contact", self.contact, LAW_NAMES)
        one_of("Impact", "beam_model", self.beam_model, MODELS)
        one_of("Impact", "load", self.load, LOADS)
        one_of("Impact", "contact_compliance", self.contact_compliance, COMPLIANCES)
        one_of("Impact", "contact_prestress", self.contact_prestress, PRESTRESSES)
        place, beam = number("Impact", "strike_position", self.strike_position), self.beam
        on_end = np.equal(place, 0.0) & among(beam.support_left, MOVING_SUPPORTS)
        on_end |= np.equal(place, 1.0) & among(beam.support_right, MOVING_SUPPORTS)
        on_beam = np.greater(place, 0.0) & np.less(place, 1.0) | on_end
        message = (
            "must be a share of the span above 0 and below 1, or the place of a free or elastic end"
        )
        require(on_beam, "Impact", "strike_position", place, message)
        moves = among(self.beam_model, MOVING_MODELS)
        message = f"must be {' or '.join(MOVING_MODELS)} {OTHER_BEAM}"
        require(moves | is_plain(self), "Impact", "beam_model", self.beam_model, message)
        message = f"must be {' or '.join(BEAM_MODELS)} {OTHER_SECTION}"
        sound = among(self.beam_model, BEAM_MODELS) | np.equal(beam.shape, "rectangle")
        require(sound, "Impact", "beam_model", self.beam_model, message)
        sprung = np.equal(beam.support_left, "elastic") | np.equal(beam.support_right, "elastic")
        on_springs = among(self.beam_model, MODELS_ON_SPRINGS)
        sound = on_springs | ~sprung
        require(sound, "Impact", "beam_model", self.beam_model, f"must be {SPRUNG_BEAM}")
        sound = on_springs | np.equal(beam.foundation_stiffness, 0.0)
        require(sound, "Impact", "beam_model", self.beam_model, f"must be {FOUNDED_BEAM}")
        damped = sum(np.greater(getattr(beam, field), 0.0) for field in RAYLEIGH)
        sound = on_springs | np.equal(damped, 0)
        require(sound, "Impact", "beam_model", self.beam_model, f"must be {DAMPED_BEAM}")
        sound = among(self.beam_model, WAVE_MODELS) | np.equal(beam.damping_ratio, 0.0)
        require(sound, "Impact", "beam_model", self.beam_model, f"must be {RATIO_DAMPED_BEAM}")
        sound = np.not_equal(beam.shape, "laminate") | np.not_equal(self.beam_model, "von_karman")
        require(sound, "Impact", "beam_model", self.beam_model, STRETCHED_LAYERS)
        object.__setattr__(self, "further_spheres", spheres_text(self))

    def _repr_html_(self) -> str:
        """Return a table of all parameters for notebooks, with units."""
        from impactlab.model.discretisation import Discretisation
        from impactlab.model.parameters import PARAMETERS, flatten  # which import this module

        values, rows = flatten(self, Discretisation()), ""
        for name, entry in PARAMETERS.items():
            if name in values and entry.path[0] == "impact":
                value = values[name]
                text = value if isinstance(value, str) else engineering(value, entry.units)
                rows += f"<tr><td>{entry.long_name}</td><td>{text}</td></tr>"
        return f"<table>{rows}</table>"


def paper_impact(velocity: Quantity = 0.99, contact: str = "stronge") -> Impact:
    """Return the impact of the paper's Tables 2 and 3: Gr 15 sphere, Q345 beam.

    Parameters
    ----------
    velocity : Quantity, default 0.99
        Velocity of the sphere, in m/s.
    contact : str, default "stronge"
        Contact law, by name or a registered one as it is; the default is the paper's.

    Returns
    -------
    Impact
        Sphere, beam and velocity.

    Raises
    ------
    ValueError
        If velocity or contact is not valid (see `Impact`).

    Notes
    -----
    Masses follow from density and volume: the sphere's 1.4009 kg agrees with the printed 1.4 kg,
    the beam's 10.148 kg does not with the printed 10.929 kg (that would be 840 mm of beam).

    Examples
    --------
    >>> il.paper_impact("2 m/s").beam.depth
    0.0278
    """
    gr15 = Material(density=7800.0, youngs_modulus=208e9, poissons_ratio=0.3, yield_stress=2550e6)
    q345 = Material(density=7800.0, youngs_modulus=210e9, poissons_ratio=0.3, yield_stress=345e6)
    return Impact(
        sphere=Sphere(radius=0.035, material=gr15),
        beam=Beam(span=0.78, width=0.06, depth=0.0278, material=q345),
        velocity=velocity,
        contact=contact,
    )


def corrected_impact(velocity: Quantity = 0.99) -> Impact:
    """Return the paper's sphere and beam in the beam model that is nearest to 3-D.

    Timoshenko's beam, a contact law from finite elements, the local compliance of sphere and beam
    with bending across the width, the stress of bending where the contact yields, and the force
    over the circle of contact: docs/agreement.md measures the effect of each.

    Parameters
    ----------
    velocity : Quantity, default 0.99
        Velocity of the sphere, in m/s.

    Returns
    -------
    Impact
        Sphere, beam and velocity.

    Raises
    ------
    ValueError
        If velocity is not valid.

    Examples
    --------
    >>> il.corrected_impact("2 m/s").contact
    'finite_element'
    """
    return replace(
        paper_impact(velocity, "finite_element"),
        beam_model="timoshenko",
        contact_compliance="strip",
        contact_prestress="bending",
        load="contact_patch",
    )


def is_plain(impact: Impact) -> Any:
    """Return whether both ends are hinges and mid-span is struck, of each run."""
    left = among(impact.beam.support_left, HINGES)
    right = among(impact.beam.support_right, HINGES)
    return left & right & np.equal(impact.strike_position, MID_SPAN)


BASES = {"paper": paper_impact, "corrected": corrected_impact}
"""Impacts to start from, by name."""
