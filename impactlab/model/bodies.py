"""The bodies of an impact: spheres, and a beam with its section and its ends."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from impactlab.model.checks import instance, number, one_of, positive, require
from impactlab.model.cross_section import Section
from impactlab.model.material import Material
from impactlab.model.quantities import SI, si
from impactlab.model.section import SHAPES, check_section, section_fields
from impactlab.solver import DAMPINGS as DAMPINGS
from impactlab.solver import RESISTANCES, SUPPORTS, WAVE_MODELS
from impactlab.solver.types import SPHERES

_UNITS = {"strike_position": "1", "velocity": "m s-1", "delay": "s"}
_EXAMPLE = "[{strike_position: 0.25, velocity: 3 m/s, delay: 0.5 ms}]"
_EXPECTED = (
    f"must be a list of spheres, 1 to {SPHERES}, as {_EXAMPLE}, or as text '0.25 3 0.0005' in SI"
)
PLACE_OF_ITS_OWN = "must have a place of its own each: strikes repeat a strike"
"""Why two spheres cannot strike one node."""


def sphere_rows(spheres: Any) -> tuple[tuple[float, ...], ...]:
    """Return rows of place, velocity (m/s) and delay (s) of spheres, which may be text.

    Raises TypeError or ValueError where they are none.
    """
    if isinstance(spheres, str):
        spheres = [[float(word) for word in row.split()] for row in spheres.split(",")]
    rows = []
    for sphere in spheres:
        if not isinstance(sphere, Mapping) and len(sphere) != len(_UNITS):
            raise ValueError(f"a row needs {len(_UNITS)} numbers: {', '.join(_UNITS)}")
        row = {"delay": 0.0} | dict(
            sphere if isinstance(sphere, Mapping) else zip(_UNITS, sphere, strict=True)
        )
        if differing := row.keys() ^ _UNITS.keys():
            raise ValueError(f"other keys: {', '.join(map(str, differing))}")
        rows.append(tuple(si(row[name], units) for name, units in _UNITS.items()))
    return tuple(rows)


def spheres_text(impact: Any) -> str | None:
    """Return the further spheres of an impact as text, whose digits lead back to the numbers.

    Raises ValueError where they are not valid, or another field is at odds with them.
    """
    spheres = impact.further_spheres
    if spheres is None:
        return None
    # a colon ends the value in messages
    shown = spheres if ":" not in repr(spheres) else str(spheres).replace(":", "")
    reason = ""
    try:
        rows = sphere_rows(spheres)
    except (TypeError, ValueError) as error:
        rows, reason = (), f" ({error})"
    field = "Impact", "further_spheres", shown
    require(1 <= len(rows) <= SPHERES, *field, f"{_EXPECTED}{reason}")
    for place, velocity, delay in rows:
        require(velocity > 0.0, *field, "must have velocities above zero")
        require(delay >= 0.0, *field, "must have delays of zero or more")
        left, right = (getattr(impact.beam, f"support_{side}") for side in ("left", "right"))
        free = (("free", "elastic"),)
        on_end = (place == 0.0) & np.isin(left, *free) | (place == 1.0) & np.isin(right, *free)
        message = "must have places above 0 and below 1 of the span, or at a free or elastic end"
        require((0.0 < place < 1.0) | on_end, *field, message)
    places = [place for place, _, _ in rows]
    lone = len(set(places)) == len(places) and not np.isin(impact.strike_position, places).any()
    require(lone, *field, PLACE_OF_ITS_OWN)
    end = "with further_spheres: change it, or leave them out"
    model, needed = impact.beam_model, f"must be {' or '.join(WAVE_MODELS)} {end}"
    require(np.isin(model, WAVE_MODELS), "Impact", "beam_model", model, needed)
    return ", ".join(" ".join(map(repr, row)) for row in rows)


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
        law = self.material.flow_law
        require(law == "linear", "Material", "flow_law", law, 'must be "linear" of a sphere')
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
    shape : {"rectangle", "box", "tube", "circle", "i", "profile", "laminate"}, default "rectangle"
        Shape of the section. Tubes and circles are round: their width and depth are the diameter.
    wall_thickness : Quantity, optional
        Thickness of the wall of a box or a tube, in m; these need it, and other shapes have none.
    flange_thickness, web_thickness : Quantity, optional
        Thickness of each flange, and of the web, of an I-section, in m; it needs both.
    profile : str or sequence of pairs of float, optional
        Width over the depth, with shape "profile" alone: distances from the axis over half the
        depth, from 0 to 1, and widths over the largest one, which is `width`; straight in between,
        two of one distance are a step. Kept as text, "0 0.2, 0.8 0.2, 0.8 1, 1 1".
    layers : str or sequence of rows of float, optional
        Layers of other metals, with shape "laminate" alone: share of half the depth, Young's
        modulus (Pa), yield stress (Pa) and density (kg/m3), from the axis outwards, mirrored below
        it. The rest outside is of `material`, which the sphere touches. Kept as text,
        "0.8 70e9 250e6 2700".
    support_left, support_right : str, default "pinned"
        What holds each end: "pinned" (deflection and moment are zero), "clamped" (deflection
        and slope are zero), "free" (moment and shear force are zero), "elastic" (springs) or
        "roller" (pinned, but free along the axis, which the beam model "von_karman" alone moves:
        the others take it as "pinned"). Clamped and free ends need the beam models
        "euler_bernoulli", "elastic", "timoshenko" or "von_karman", elastic ones, too; in the last
        an elastic end holds the axis if `stiffness` holds the deflection.
    stiffness_left, stiffness_right : Quantity, default 0
        Shear force over the deflection at an elastic end, in N/m.
    rotational_stiffness_left, rotational_stiffness_right : Quantity, default 0
        Moment over the slope at an elastic end, in N m (per rad).
    mass_damping : Quantity, default 0
        Damping force over mass and velocity, Rayleigh's alpha, in 1/s.
    stiffness_damping : Quantity, default 0
        Damping force over that of elastic bending, per rate, Rayleigh's beta, in s.
    damping_ratio : Quantity, default 0
        Damping of each mode over its critical one, of 1; with the scheme "modal" alone.
    foundation_stiffness : Quantity, default 0
        Force per length over the deflection of a bed of springs beneath the beam (Winkler), in
        N/m2; they pull as they push. Damping needs the beam models "euler_bernoulli",
        "elastic", "timoshenko" or "von_karman" (solver/resistance.py), a foundation one of these
        or "solid".

    Raises
    ------
    ValueError
        If a length is not finite and positive, the depth not below the span, the shear coefficient
        not in (0, 1], shape or a support unknown, a stiffness or a damping negative, an elastic
        support without any, or the material is not a `Material`; if a shape lacks a thickness,
        cannot have it, or is round and not as wide as deep.

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
    layers: Any = None
    support_left: str = "pinned"
    support_right: str = "pinned"
    stiffness_left: SI[float] = SI("N m-1", 0.0)
    stiffness_right: SI[float] = SI("N m-1", 0.0)
    rotational_stiffness_left: SI[float] = SI("N m", 0.0)
    rotational_stiffness_right: SI[float] = SI("N m", 0.0)
    mass_damping: SI[float] = SI("s-1", 0.0)
    stiffness_damping: SI[float] = SI("s", 0.0)
    damping_ratio: SI[float] = SI("1", 0.0)
    foundation_stiffness: SI[float] = SI("N m-2", 0.0)

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
        for field in RESISTANCES:
            resistance = number("Beam", field, getattr(self, field))
            require(resistance >= 0, "Beam", field, resistance, "must not be negative")

    @property
    def section(self) -> Section:
        """Section of the beam, which knows its area, second moment and fibres.

        Returns
        -------
        Section
            The section (model/section.py, model/shapes.py).
        """
        sizes = {field: getattr(self, field) for field in section_fields(self.shape)}
        if "layers" in sizes:
            metal = self.material
            sizes["skin"] = metal.youngs_modulus, metal.yield_stress, metal.density
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
