"""One impact: who strikes what, how fast, under which contact law; and the source paper's case.

Quantities are numbers in SI units, strings with a unit ("27.8 mm") or quantities of pint; fields
hold SI numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from impactlab import wings
from impactlab.model.checks import instance, number, one_of, positive, require
from impactlab.model.cross_section import Section
from impactlab.model.material import Material
from impactlab.model.quantities import SI, Quantity, engineering
from impactlab.model.section import SHAPES, check_section, section_fields
from impactlab.solver import (
    BEAM_MODELS,
    BENDING_MODELS,
    COMPLIANCES,
    LOADS,
    PRESTRESSES,
    SUPPORTS,
    WAVE_MODELS,
)
from impactlab.solver.contact import LAWS

MODELS = (*BEAM_MODELS, *wings.models())
"""Names of all models of the beam."""
MID_SPAN = 0.5
"""Usual place of the strike over the span."""
MOVING_SUPPORTS = ("free", "elastic")
"""Supports whose end can be struck."""
SPRUNG_BEAM = f"{' or '.join(BENDING_MODELS)} with elastic ends: change it, or set other supports"
"""End of messages on what elastic ends cannot have."""
OTHER_BEAM = (
    "with ends that are not pinned, or a strike beside mid-span: change it, or set support_left: "
    "pinned, support_right: pinned and strike_position: 0.5"
)
"""Ends of messages on what other beams cannot have."""
OTHER_SECTION = "with a section that is no rectangle: change it, or set shape: rectangle"
"""The same, of other sections."""


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """A solid sphere.

    Parameters
    ----------
    radius : Quantity
        Radius, in m.
    material : Material
        Metal of the sphere.
    mass : Quantity, optional
        Mass, in kg; by default density times volume.

    Raises
    ------
    ValueError
        If radius or mass is not finite and positive, or the material is not a `Material`.

    Examples
    --------
    >>> from dataclasses import replace
    >>> replace(il.paper_impact().sphere, radius="3 cm").total_mass
    0.8821592171280138
    """

    radius: SI[float] = SI("m")
    material: Material
    mass: SI[float | None] = SI("kg", None)

    def __post_init__(self) -> None:
        instance("Sphere", "material", self.material, Material)
        positive("Sphere", "radius", self.radius)
        if self.mass is not None:
            positive("Sphere", "mass", self.mass)

    @property
    def total_mass(self) -> float:
        """Mass in kg: the stated one, else density times volume.

        Returns
        -------
        float
            Mass, in kg.
        """
        if self.mass is not None:
            return self.mass
        # not **3: numpy's power of a column is not Python's to the last bit
        cube = self.radius * self.radius * self.radius
        mass: float = self.material.density * 4.0 / 3.0 * math.pi * cube
        return mass


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A beam, held at both ends or at one.

    Parameters
    ----------
    span : Quantity
        Distance of the ends, in m.
    width, depth : Quantity
        Side of the section, across and along the velocity, in m.
    material : Material
        Metal of the beam.
    shear_coefficient : Quantity, optional
        Shear force over G A times the shear angle, of Timoshenko's beam alone; by default that of
        the shape: 5/6 of a rectangle, Cowper's of the others (model/shapes.py).
    shape : {"rectangle", "box", "tube", "circle", "i", "profile"}, default "rectangle"
        Shape of the section. Tubes and circles are round: their width and depth are the diameter.
    wall_thickness : Quantity, optional
        Thickness of the wall of a box or a tube, in m; these need it, and other shapes have none.
    flange_thickness, web_thickness : Quantity, optional
        Thickness of each flange, and of the web, of an I-section, in m; it needs both.
    profile : str or sequence of pairs of float, optional
        Width over the depth, with shape "profile" alone: distances from the axis over half the
        depth, from 0 to 1, and widths over the largest one, which is `width`; straight in between,
        two of one distance are a step. Kept as text, "0 0.2, 0.8 0.2, 0.8 1, 1 1".
    support_left, support_right : {"pinned", "clamped", "free", "elastic"}, default "pinned"
        What holds each end: "pinned" (deflection and moment are zero; a roller is the same, without
        an axial force), "clamped" (deflection and slope are zero), "free" (moment and shear force
        are zero) or "elastic" (springs). Others than pinned need the beam models "euler_bernoulli",
        "elastic" or "timoshenko", elastic ones one of the first two.
    stiffness_left, stiffness_right : Quantity, default 0
        Shear force over the deflection at an elastic end, in N/m.
    rotational_stiffness_left, rotational_stiffness_right : Quantity, default 0
        Moment over the slope at an elastic end, in N m (per rad).

    Raises
    ------
    ValueError
        If a length is not finite and positive, the depth not below the span, the shear coefficient
        not in (0, 1], shape or a support unknown, a stiffness negative, an elastic support without
        any, or the material is not a `Material`; if a shape lacks a thickness, cannot have it, or
        is round and not as wide as deep.

    Examples
    --------
    >>> steel = il.paper_impact().beam.material
    >>> il.Beam(span="78 cm", width="6 cm", depth="28 mm", material=steel).depth
    0.028
    """

    span: SI[float] = SI("m")
    width: SI[float] = SI("m")
    depth: SI[float] = SI("m")
    material: Material
    shear_coefficient: SI[float | None] = SI("1", None)
    shape: str = "rectangle"
    wall_thickness: SI[float | None] = SI("m", None)
    flange_thickness: SI[float | None] = SI("m", None)
    web_thickness: SI[float | None] = SI("m", None)
    profile: Any = None
    support_left: str = "pinned"
    support_right: str = "pinned"
    stiffness_left: SI[float] = SI("N m-1", 0.0)
    stiffness_right: SI[float] = SI("N m-1", 0.0)
    rotational_stiffness_left: SI[float] = SI("N m", 0.0)
    rotational_stiffness_right: SI[float] = SI("N m", 0.0)

    def __post_init__(self) -> None:
        instance("Beam", "material", self.material, Material)
        for field in ("span", "width", "depth"):
            positive("Beam", field, getattr(self, field))
        below = f"must be below the span ({self.span!r} m)"
        require(self.depth < self.span, "Beam", "depth", self.depth, below)
        if self.shear_coefficient is not None:
            k = positive("Beam", "shear_coefficient", self.shear_coefficient)
            message = "must be in (0, 1]; 5/6 holds for a rectangle"
            require(k <= 1, "Beam", "shear_coefficient", self.shear_coefficient, message)
        check_section(self)
        for side in ("left", "right"):
            _check_end(self, side)

    @property
    def section(self) -> Section:
        """Section of the beam, which knows its area, second moment and fibres.

        Returns
        -------
        Section
            The section (model/section.py, model/shapes.py).
        """
        sizes = {field: getattr(self, field) for field in section_fields(self.shape)}
        return SHAPES[self.shape](**sizes)

    @property
    def shear_correction(self) -> float:
        """Shear coefficient: the stated one, else that of the shape.

        Returns
        -------
        float
            k, of 1.
        """
        if self.shear_coefficient is not None:
            return self.shear_coefficient
        k: float = self.section.shear_coefficient(self.material.poissons_ratio)
        return k

    @property
    def mass_per_length(self) -> float:
        """Density times area of the section.

        Returns
        -------
        float
            rho A, in kg/m.
        """
        mass: float = self.section.mass_per_length(self.material.density)
        return mass

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness of the exact section, not that of an integration rule.

        Returns
        -------
        float
            EI, in N m2.
        """
        stiffness: float = self.section.bending_stiffness(self.material.youngs_modulus)
        return stiffness


def _check_end(beam: Beam, side: str) -> None:
    """Raise ValueError unless the end has a known support, and an elastic one a spring."""
    support = one_of("Beam", f"support_{side}", getattr(beam, f"support_{side}"), SUPPORTS)
    springs = 0.0
    for field in (f"stiffness_{side}", f"rotational_stiffness_{side}"):
        spring = number("Beam", field, getattr(beam, field))
        require(spring >= 0, "Beam", field, spring, "must not be negative")
        springs = springs + spring
    message = f"needs a spring: set stiffness_{side} or rotational_stiffness_{side}"
    sprung = np.greater(springs, 0.0) | np.not_equal(support, "elastic")
    require(sprung, "Beam", f"support_{side}", support, message)


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
        Contact law (impactlab.solver.contact.LAWS); the default agrees best with 3-D finite
        elements (docs/agreement.md).
    gravity : Quantity, default 9.81
        Acceleration of the sphere alone, in m/s2.
    beam_model : str, default "euler_bernoulli"
        "euler_bernoulli" (the paper's, of yielding fibres), "elastic" (the same, no fibre yields),
        "timoshenko" (with transverse shear and rotary inertia), "spring_mass" (Wang et al.: one
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
        Stress from the beam's bending that changes the force at which the contact yields
        (solver/contact/prestress.py). "bending" needs `beam_model="timoshenko"`.
    strike_position : Quantity, default 0.5
        Place that the sphere strikes, as a share of the span from the left end; it must lie on a
        node of the discretisation, and on an end only where that is free. Others than mid-span need
        what other ends need.

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

    def __post_init__(self) -> None:
        instance("Impact", "sphere", self.sphere, Sphere)
        instance("Impact", "beam", self.beam, Beam)
        positive("Impact", "velocity", self.velocity)
        gravity = number("Impact", "gravity", self.gravity)
        require(gravity >= 0, "Impact", "gravity", gravity, "must not be negative")
        one_of("Impact", "contact", self.contact, LAWS)
        one_of("Impact", "beam_model", self.beam_model, MODELS)
        one_of("Impact", "load", self.load, LOADS)
        one_of("Impact", "contact_compliance", self.contact_compliance, COMPLIANCES)
        one_of("Impact", "contact_prestress", self.contact_prestress, PRESTRESSES)
        place, beam = number("Impact", "strike_position", self.strike_position), self.beam
        on_end = np.equal(place, 0.0) & np.isin(beam.support_left, MOVING_SUPPORTS)
        on_end |= np.equal(place, 1.0) & np.isin(beam.support_right, MOVING_SUPPORTS)
        on_beam = np.greater(place, 0.0) & np.less(place, 1.0) | on_end
        message = (
            "must be a share of the span above 0 and below 1, or the place of a free or elastic end"
        )
        require(on_beam, "Impact", "strike_position", place, message)
        moves = np.isin(self.beam_model, WAVE_MODELS)
        message = f"must be {' or '.join(WAVE_MODELS)} {OTHER_BEAM}"
        require(moves | is_plain(self), "Impact", "beam_model", self.beam_model, message)
        message = f"must be {' or '.join(BEAM_MODELS)} {OTHER_SECTION}"
        sound = np.isin(self.beam_model, BEAM_MODELS) | np.equal(beam.shape, "rectangle")
        require(sound, "Impact", "beam_model", self.beam_model, message)
        sprung = np.equal(beam.support_left, "elastic") | np.equal(beam.support_right, "elastic")
        sound = np.isin(self.beam_model, BENDING_MODELS) | ~sprung
        require(sound, "Impact", "beam_model", self.beam_model, f"must be {SPRUNG_BEAM}")

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
        Contact law; the default is the paper's.

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
    """Return whether the beam is pinned at both ends and struck in its middle, of each run."""
    pinned = np.equal(impact.beam.support_left, "pinned")
    pinned &= np.equal(impact.beam.support_right, "pinned")
    return pinned & np.equal(impact.strike_position, MID_SPAN)


BASES = {"paper": paper_impact, "corrected": corrected_impact}
"""Impacts to start from, by name."""
