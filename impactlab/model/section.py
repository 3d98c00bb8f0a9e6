"""Sections by the names of their shapes, and the table of fibres that the kernels take.

Kernels, limits, costs, the 3-D model and the checks know a section by what its class gives. Where
the extents themselves count (the flat top under the sphere, the faces of the 3-D model, the tables
of contact_compliance.py, a strip's bending across its width), they are of a rectangle: others are
refused there, or remarked (solver/responses.py).

To add a shape, write its class in shapes.py and put its name into SHAPES, here and in the solver.
Its fields are those of `Beam`; a new field is a parameter and a field of the case table, too.
Kernels take sections that are symmetric about their axis: of the fibres they keep those above,
each counted twice.
"""

from dataclasses import fields
from itertools import pairwise
from typing import Any

import numpy as np

from impactlab.model.checks import among, one_of, positive, require
from impactlab.model.cross_section import Section
from impactlab.model.laminate import LEAST_FIBRES, Laminate, layer_rows
from impactlab.model.shapes import Box, Circle, ISection, Profile, Rectangle, Tube, profile_points
from impactlab.solver import FLOW_LAWS, RULES
from impactlab.solver import SHAPES as SHAPE_NAMES
from impactlab.solver.types import LAYERS, PROFILE
from impactlab.types import Floats

SHAPES: dict[str, type[Section]] = dict(
    zip(SHAPE_NAMES, (Rectangle, Box, Tube, Circle, ISection, Profile, Laminate), strict=True)
)
"""Every shape of the section, by name."""
THICKNESSES = ("wall_thickness", "flange_thickness", "web_thickness")
"""Fields of `Beam` that some shapes have."""


def section_fields(shape: str) -> list[str]:
    """Return the fields of `Beam` that a shape has."""
    return [field.name for field in fields(SHAPES[shape]) if field.name != "skin"]


def section_of(cases: Any) -> Section:
    """Return the section of a case, or of many of one shape: records of solver.types.CASE."""
    shape = SHAPE_NAMES[int(np.ravel(cases["beam_shape"])[0])]
    sizes = {name: cases[f"beam_{name}"] for name in section_fields(shape)}
    if "profile" in sizes:
        sizes["profile"] = sizes["profile"][: 1 + np.flatnonzero(sizes["profile"][:, 0])[-1]]
    if "layers" in sizes:
        sizes["layers"] = sizes["layers"][sizes["layers"][:, 0] > 0.0]
        skin = (f"beam_{name}" for name in ("youngs_modulus", "yield_stress", "density"))
        sizes["skin"] = tuple(float(cases[name]) for name in skin)
    return SHAPES[shape](**sizes)


def section_values(case: Any) -> dict[str, Any]:
    """Return the parameters of a case's section beside width and depth, by name."""
    shape = SHAPE_NAMES[case["beam_shape"]]
    section = section_of(case)
    sizes = {name: getattr(section, name) for name in section_fields(shape)[2:]}
    return {f"beam_{name}": size for name, size in sizes.items()} | {"beam_shape": shape}


def fibre_table(cases: Any) -> Floats:
    """Return the fibres above the axis that the kernels take, (cases, 3, most points // 2).

    Of each case distances from the axis (m), that which yields first first, areas (m2), twice a
    fibre's: each stands for its mirror image, too; and the real strains over those of the kernels:
    a fibre with r times the outermost one's yield strain is one at z/r with r^2 times the area
    (laminate.py). Cases of fewer points leave the end of their rows at 0.
    """
    table = np.zeros((cases.size, 3, cases["points"].max(initial=0) // 2))
    kinds = zip(*(cases[name].tolist() for name in ("beam_shape", "rule", "points")), strict=True)
    for shape, number, points in set(kinds):
        alike = (cases["rule"] == number) & (cases["points"] == points)
        alike &= cases["beam_shape"] == shape
        half = points // 2
        if SHAPES[SHAPE_NAMES[shape]] is Rectangle:
            z, area = section_of(cases[alike]).cut(RULES[number], points)
        else:
            pairs = [section_of(case).cut(RULES[number], points) for case in cases[alike]]
            z, area = (np.array(parts) for parts in zip(*pairs, strict=True))
        table[alike, 0, :half] = z[:, : -half - 1 : -1]
        table[alike, 1, :half] = 2.0 * area[:, : -half - 1 : -1]
        table[alike, 2, :half] = 1.0
        if SHAPES[SHAPE_NAMES[shape]] is Laminate:
            for row in np.flatnonzero(alike):
                z, area = table[row, :2, :half]
                ratio = section_of(cases[row]).strain_ratio(z)
                fibres = np.stack([z / ratio, area * ratio * ratio, ratio])
                table[row, :, :half] = fibres[:, np.argsort(-fibres[0], kind="stable")]
    return table


def _profile_text(profile: Any, needed: bool) -> str | None:
    """Return the points of a profile as text, a number having the digits that lead back to it.

    Raises ValueError where they make no section, or the shape needs none.
    """
    if profile is None or not needed:
        message = "must be stated with shape: profile" if needed else "must be left out: the shape "
        message += ", as '0 0.2, 0.8 0.2, 0.8 1, 1 1'" if needed else "is no profile"
        require((profile is None) and not needed, "Beam", "profile", profile, message)
        return None
    try:
        points = profile_points(profile)
        rising = points[0][0] == 0 and points[-1][0] == 1
        rising &= all(low[0] <= high[0] for low, high in pairwise(points))
        widths = [width for _, width in points]
        wide = all(0 < width <= 1 for width in widths[:-1]) and 0 <= widths[-1] <= 1
    except (TypeError, ValueError):
        points, rising, wide, widths = (), False, False, []
    example = "'0 0.2, 0.8 0.2, 0.8 1, 1 1'"
    message = f"must be pairs of distance and width, as {example}"
    require(2 <= len(points) <= PROFILE, "Beam", "profile", profile, f"{message}, 2 to {PROFILE}")
    message = "must go from distance 0 (the axis) to 1 (the edge) without a step back"
    require(rising, "Beam", "profile", profile, message)
    message = "must have widths above 0 (at the edge also 0), the largest of which is 1"
    require(wide and max(widths) == 1, "Beam", "profile", profile, message)
    return ", ".join(f"{distance!r} {width!r}" for distance, width in points)


def _layers_text(beam: Any, needed: bool) -> str | None:
    """Return the layers of a laminate as text, a number having the digits that lead back to it.

    Raises ValueError where they make no section, the shape needs none, or the metal of the outer
    layer hardens or depends on the rate.
    """
    layers, example = beam.layers, "as '0.8 70e9 250e6 2700'"
    if layers is None or not needed:
        message = (
            f"must be stated with shape: laminate, {example}"
            if needed
            else ("must be left out: the shape is no laminate")
        )
        require((layers is None) and not needed, "Beam", "layers", layers, message)
        return None
    try:
        rows = layer_rows(layers)
    except (TypeError, ValueError):
        rows = ()
    message = (
        "must be rows of share of half the depth, Young's modulus (Pa), yield stress (Pa) and "
        f"density (kg/m3), from the axis outwards, {example}"
    )
    require(1 <= len(rows) <= LAYERS, "Beam", "layers", layers, f"{message}, 1 to {LAYERS}")
    sound = all(0.0 < value < np.inf for row in rows for value in row)
    sound = sound and all(row[2] < row[1] for row in rows)
    message = "must have numbers above zero, and yield stresses below Young's moduli"
    require(sound, "Beam", "layers", layers, message)
    message = "must leave a share to the outer layer, which is of the beam's material: shares sum "
    message += f"up to {sum(row[0] for row in rows):.6g} of half the depth"
    require(sum(row[0] for row in rows) < 1.0, "Beam", "layers", layers, message)
    for field in ("isotropic_hardening_modulus", "kinematic_hardening_modulus"):
        value = getattr(beam.material, field)
        message = "must be 0 with shape: laminate, whose layers do not harden"
        require(value == 0.0, "Material", field, value, message)
    law, message = beam.material.flow_law, 'must be "linear" with shape: laminate'
    require(among(law, FLOW_LAWS), "Material", "flow_law", law, message)
    for field in ("rate_coefficient", "rate_sensitivity"):
        value = getattr(beam.material, field)
        message = "must be 0 with shape: laminate, whose layers do not depend on the strain rate"
        require(value == 0.0, "Material", field, value, message)
    return ", ".join(" ".join(map(repr, row)) for row in rows)


def least_points(beam: Any) -> int:
    """Return how many points over the depth the section of a beam needs; 0: any number."""
    layers = layer_rows(beam.layers or ())
    return 2 * LEAST_FIBRES * (len(layers) + 1) if layers else 0


def check_section(beam: Any) -> None:
    """Raise ValueError unless shape and sizes make a section, one shape in all of a column."""
    one_of("Beam", "shape", beam.shape, tuple(SHAPES))
    if np.ndim(beam.shape):
        shapes = np.unique(beam.shape).tolist()
        require(len(shapes) == 1, "Beam", "shape", beam.shape, "must be one in all of a column")
        object.__setattr__(beam, "shape", shapes[0])
    needed = section_fields(beam.shape)
    object.__setattr__(beam, "profile", _profile_text(beam.profile, "profile" in needed))
    object.__setattr__(beam, "layers", _layers_text(beam, "layers" in needed))
    limits = {
        "wall_thickness": (0.5 * np.minimum(beam.width, beam.depth), "half of width and depth"),
        "flange_thickness": (0.5 * beam.depth, "half of the depth"),
        "web_thickness": (beam.width, "the width"),
    }
    for field, (limit, side) in limits.items():
        value = getattr(beam, field)
        if value is None:
            message = f"must be stated, as '4 mm' is: shape = {beam.shape!r} needs it"
            require(field not in needed, "Beam", field, value, message)
        else:
            positive("Beam", field, value)
            message = f"must be left out: shape = {beam.shape!r} has none"
            require(field in needed, "Beam", field, value, message)
            require(value < limit, "Beam", field, value, f"must be below {side}")
    if issubclass(SHAPES[beam.shape], Circle):
        message = f"must be the depth ({beam.depth!r} m): shape = {beam.shape!r} is round"
        require(beam.width == beam.depth, "Beam", "width", beam.width, message)
