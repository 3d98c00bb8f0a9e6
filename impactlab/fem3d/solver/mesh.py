"""The mesh of an impact: parts of beam and sphere, matched where they touch.

A quarter of both where the beam is held alike at both ends and struck in its middle; else a half.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impactlab.fem3d.solver.estimates import checked_patch, checked_size, copies, end_springs, ends
from impactlab.fem3d.solver.impulses import bulges
from impactlab.fem3d.solver.lattice import Integers, brick, graded, mirrored, quarter_sphere
from impactlab.model.checks import positive
from impactlab.model.impact import Impact
from impactlab.types import Floats

BEAM, SPHERE = 0, 1  # values of Mesh.body

_RING = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
CORNERS = np.array([(*place, level) for level in (-1.0, 1.0) for place in _RING])
"""Natural coordinates of a hexahedron's nodes, (8, 3), in VTK's order."""
FACES = np.array(
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
"""A hexahedron's nodes around each face, in the order of Abaqus' and CalculiX's S1 to S6."""
_FLAT = 1e-6  # distance from a plane, over the element size, that counts as zero
NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners that share an edge with each corner, turning right-handed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A part of beam and sphere: x along the beam, y across, z upwards, in m.

    x = 0 is the struck section, y = 0 mid-width, z = 0 the beam's top, which the sphere touches at
    the origin. y = 0 is a plane of symmetry; of a quarter, x = 0 is another.

    nodes: (n, 3). elements: (e, 8) node numbers in VTK's order of a hexahedron. body: (e,), BEAM or
    SPHERE. full: (e,), whether fully integrated. copies: of this part that make up the bodies, 4 or
    2. pairs: (p, 2) nodes (of the sphere, of the beam) with the same x and y, in a rectangle, y
    fastest. faces: (f, 4) rows of pairs, the faces that may touch. gaps: (p,) initial distances in
    m. rim: (p,), pairs on the border of the matched patch. bulge: (f, points) in m of the sphere's
    faces, see impulses.bulges. normals: (p, 3) of the sphere, see impulses.close_gaps. symmetry_x,
    symmetry_y: nodes that keep their x (y). support: nodes that keep their z. clamped: nodes that
    do not move. ends: what holds the beam, see estimates.ends. axis_node: on the beam's axis below
    the impact. element_size: of the patch, in m. patch: half the side of the square of matched
    nodes, in m.

    Raises ValueError when an element is inverted or has no volume at a corner.
    """

    nodes: Floats
    elements: Integers
    body: Integers
    full: NDArray[np.bool_]
    copies: int
    pairs: Integers
    faces: Integers
    gaps: Floats
    rim: NDArray[np.bool_]
    bulge: Floats
    normals: Floats
    symmetry_x: Integers
    symmetry_y: Integers
    support: Integers
    clamped: Integers
    ends: tuple[str, str]
    axis_node: int
    element_size: float
    patch: float

    def __post_init__(self) -> None:
        points = self.nodes[self.elements]
        edges = points[:, NEIGHBOURS] - points[:, :, None]
        if np.any(wrong := np.linalg.det(edges).min(axis=1) <= 0.0):
            first = int(np.flatnonzero(wrong)[0])
            where = self.nodes[self.elements[first]].mean(axis=0)
            raise ValueError(
                f"mesh: {wrong.sum()} elements are inverted, the first at x, y, z = {where} m: "
                "take a smaller element_size"
            )

    def groups(self) -> list[tuple[int, bool, Integers]]:
        """Return the groups of elements alike in body and full: both, and the numbers in each."""
        return [
            (body, full, np.flatnonzero(chosen).astype(np.int32))
            for body in (BEAM, SPHERE)
            for full in (True, False)
            if np.any(chosen := (self.body == body) & (self.full == full))
        ]

    @cached_property
    def pole(self) -> int:
        """Return the sphere's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 0])

    @cached_property
    def top_node(self) -> int:
        """Return the beam's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 1])


def faces_of(rows: int, columns: int) -> Integers:
    """Return the faces of a rectangle of pairs, (f, 4), right-handed about z."""
    number = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, 4)


def plane_faces(
    nodes: Floats, elements: Integers, axis: int, element_size: float
) -> tuple[NDArray[np.int64], Integers]:
    """Return the faces in the plane through the origin across `axis` (0, 1, 2: x, y, z).

    Returns the element of each face, (faces,), and its nodes, (faces, 4).
    """
    corners = elements[:, FACES]
    near = np.abs(nodes[corners, axis]) < _FLAT * element_size
    element, face = np.nonzero(near.all(axis=2))
    return element, corners[element, face]


def _refuse_other_beams(impact: Impact) -> None:
    """Raise ValueError unless the 3-D model has such a beam, struck in such a way."""
    beam = impact.beam
    plain_values: list[tuple[Any, str, Any]] = [
        (beam, "shape", "rectangle"),
        (impact, "strikes", 1),
        (impact, "further_spheres", None),
    ]
    for owner, field, plain in plain_values:
        if (value := getattr(owner, field)) != plain:
            advice = "leave it out" if plain is None else f"set it to {plain!r}"
            raise ValueError(
                f"{type(owner).__name__}.{field} = {value!r}: the 3-D model is of a rectangular "
                f"beam struck once by one sphere: {advice}"
            )
    if beam.damping_ratio > 0.0:
        raise ValueError(
            f"Beam.damping_ratio = {beam.damping_ratio!r}: is of modes, which the 3-D model does "
            "not have: set it to 0, and state mass_damping and stiffness_damping"
        )
    if not 0.0 < impact.strike_position < 1.0:
        raise ValueError(
            f"Impact.strike_position = {impact.strike_position!r}: the 3-D model needs beam on "
            "both sides of the contact: strike beside the end"
        )


def check_mesh(mesh: Mesh, impact: Impact) -> None:
    """Raise ValueError where the mesh is that of other bodies."""
    _refuse_other_beams(impact)
    beam, nodes = impact.beam, mesh.nodes
    corners = nodes[mesh.elements[mesh.body == BEAM]]
    left, right = -corners[..., 0].min(), corners[..., 0].max()
    left = right if mesh.copies == 4 else left
    for name, meshed, length in (
        ("beam's span", left + right, beam.span),
        ("distance of the strike from the left end", left, impact.strike_position * beam.span),
        ("beam's width", 2.0 * corners[..., 1].max(), beam.width),
        ("beam's depth", -nodes[:, 2].min(), beam.depth),
        ("sphere's radius", 0.5 * nodes[:, 2].max(), impact.sphere.radius),
    ):
        if not math.isclose(meshed, length, rel_tol=1e-9):
            raise ValueError(
                f"mesh: the {name} is {meshed:.9g} m in the mesh and {length:.9g} m in the "
                "impact: make the mesh from this impact (impact_mesh)"
            )
    if mesh.ends != (supports := ends(beam)):
        raise ValueError(
            f"mesh: the beam's ends are {' and '.join(mesh.ends)} in the mesh and "
            f"{' and '.join(supports)} in the impact: make the mesh from this impact (impact_mesh)"
        )
    if mesh.copies > copies(impact):
        raise ValueError(
            "mesh: the mesh is a quarter, but the springs of the beam's ends differ in the impact: "
            "make the mesh from this impact (impact_mesh)"
        )


def nodal_masses(mesh: Mesh, impact: Impact) -> Floats:
    """Return the lumped mass of each node in kg, (n,): an eighth of each of its elements.

    The sphere's density is that of sphere_density.
    """
    beam, sphere = impact.beam.material.density, sphere_density(mesh, impact)
    masses = np.repeat(np.where(mesh.body == BEAM, beam, sphere) * element_volumes(mesh) / 8.0, 8)
    return np.asarray(
        np.bincount(mesh.elements.ravel(), weights=masses, minlength=len(mesh.nodes)), dtype=float
    )


def sphere_density(mesh: Mesh, impact: Impact) -> float:
    """Return the density in kg/m3 with which all copies weigh what the impact says."""
    volume = element_volumes(mesh)[mesh.body == SPHERE].sum()
    return float(impact.sphere.total_mass / mesh.copies / volume)


def element_volumes(mesh: Mesh) -> Floats:
    """Return each element's volume in m3, (e,): Gauss's rule of two points per side is exact."""
    points, total = mesh.nodes[mesh.elements], np.zeros(len(mesh.elements))
    for place in CORNERS / np.sqrt(3.0):
        factors = 1.0 + CORNERS * place
        slopes = [CORNERS[:, a] * np.prod(np.delete(factors, a, axis=1), axis=1) for a in range(3)]
        total += np.linalg.det(0.125 * np.stack(slopes) @ points)
    return total


def impact_mesh(
    impact: Impact,
    *,
    element_size: float,
    patch: float | None = None,
    ratio: float = 1.3,
    coarsest: float | None = None,
    quarters: bool = True,
) -> Mesh:
    """Return the mesh of `impact`: of a quarter where it is symmetric along the beam, else a half.

    element_size: of the elements about the contact, in m. patch: half the side of the square in
    which nodes of sphere and beam are matched, in m, rounded up to whole elements (None: estimated
    from the impact). ratio: of neighbouring elements beyond the patch. coarsest: largest element
    in m (None: a sixth of the beam's depth). quarters: False for a half of a symmetric impact, too,
    which costs twice as much.

    Raises ValueError when a length is not positive, the ratio not above 1, the element size beyond
    reason, the patch does not fit on beam and sphere, or the 3-D model has no such beam.
    """
    _refuse_other_beams(impact)
    size, beam = checked_size(impact, element_size), impact.beam
    if positive("mesh", "ratio", ratio) <= 1.0:
        raise ValueError(f"mesh.ratio = {ratio!r}: must be above 1")
    limit = beam.depth / 6.0 if coarsest is None else coarsest
    largest = max(positive("mesh", "coarsest", limit), size)
    half = checked_patch(impact, size, patch)
    depth = size * max(round(half / size), 2)
    parts = copies(impact) if quarters else 2
    y, right = (
        graded(size, half, length, ratio, largest)
        for length in (beam.width / 2, (1.0 - impact.strike_position) * beam.span)
    )
    x, struck = right, 0
    if parts == 2:
        left = graded(size, half, impact.strike_position * beam.span, ratio, largest)
        x, struck = np.concatenate([-left[:0:-1], right]), left.size - 1
    z, axis = _layers(beam.depth / 2, size, depth, ratio, largest)
    beam_nodes, beam_elements = brick(x, y, z)
    sphere_nodes, sphere_elements, surface = quarter_sphere(
        impact.sphere.radius, size, half, depth, ratio, largest
    )
    pole = len(surface) - 1 if parts == 2 else 0
    if parts == 2:
        sphere_nodes, sphere_elements, surface = mirrored(sphere_nodes, sphere_elements, surface)
    first, reach = len(beam_nodes), round(half / size)
    place = np.arange(first, dtype=np.int32).reshape(x.size, y.size, z.size)
    centred = (surface + np.int32(first), pole), (place[:, :, -1], struck)
    pairs, faces, rim = _matched(centred, reach, parts)
    nodes = np.concatenate([beam_nodes, sphere_nodes])
    nodes[pairs[:, 0], :2] = nodes[pairs[:, 1], :2]  # the same to the last bit
    elements = np.concatenate([beam_elements, sphere_elements + np.int32(first)])
    body = np.repeat(np.array([BEAM, SPHERE], np.int32), [len(beam_elements), len(sphere_elements)])
    support, clamped = _held(place, axis, ends(beam), parts)
    touching = nodes[pairs[:, 0]]
    slopes = touching[:, :2] / (impact.sphere.radius - touching[:, 2:])
    on_plane = np.abs(nodes[:, :2]) < 1e-6 * size
    on_plane[:, 0] &= parts == 4
    symmetry_x, symmetry_y = (np.flatnonzero(on).astype(np.int32) for on in on_plane.T)
    return Mesh(
        nodes=nodes,
        elements=elements,
        body=body,
        full=_full(nodes[elements].mean(axis=1), body, half, impact),
        copies=parts,
        pairs=pairs,
        faces=faces,
        gaps=nodes[pairs[:, 0], 2] - nodes[pairs[:, 1], 2],
        rim=rim,
        bulge=bulges(nodes[pairs[faces, 0]], impact.sphere.radius),
        normals=np.column_stack([-slopes, np.ones(len(slopes))]),
        symmetry_x=symmetry_x,
        symmetry_y=symmetry_y,
        support=support,
        clamped=clamped,
        ends=ends(beam),
        axis_node=int(place[struck, 0, axis]),
        element_size=size,
        patch=half,
    )


def _matched(
    centred: Iterable[tuple[Integers, int]], reach: int, parts: int
) -> tuple[Integers, Integers, NDArray[np.bool_]]:
    """Return pairs of nodes, those of sphere and beam, their faces, and which are on the rim.

    centred: nodes of sphere and beam, and the row of the middle. reach: of the patch, in elements.
    """
    above, below = (
        rows[max(centre - reach, 0) : centre + reach + 1, : reach + 1] for rows, centre in centred
    )
    rim = np.zeros(above.shape, dtype=bool)
    rim[-1], rim[:, -1] = True, True
    rim[0] |= parts == 2
    pairs = np.stack([above, below], axis=-1).reshape(-1, 2)
    return pairs, faces_of(*above.shape), rim.ravel()


def _layers(
    middle: float, size: float, depth: float, ratio: float, largest: float
) -> tuple[Floats, int]:
    """Return the beam's cuts along z in m, ascending, and the number of that at mid-depth.

    middle: half the beam's depth. Others: see quarter_sphere. Where a last layer above the axis
    would be thin, all are alike.
    """
    fine = depth if middle - depth > 0.7 * size else middle
    upper = graded(size, fine, middle, ratio, largest)
    last = upper[-1] - upper[-2]
    lower = middle + graded(last, last, middle, ratio, largest)
    z = -np.concatenate([upper, lower[1:]])[::-1]
    return z, int(np.argmin(np.abs(z + middle)))


def _held(
    place: Integers, axis: int, kinds: tuple[str, str], parts: int
) -> tuple[Integers, Integers]:
    """Return the nodes on hinges and those of clamped end faces.

    place: node numbers of the beam along x, y and z. axis: of the cut along z at mid-depth. kinds:
    see estimates.ends. parts: 4 or 2; a quarter has the right end alone.
    """
    none = np.empty(0, dtype=np.int32)
    hinges, clamps = [none], [none]
    for face, kind in ((place[0], kinds[0]), (place[-1], kinds[1]))[parts == 4 :]:
        if kind == "pinned":
            hinges.append(face[:, axis])
        elif kind == "clamped":
            clamps.append(face.ravel())
    return np.concatenate(hinges), np.concatenate(clamps)


def _full(centres: Floats, body: Integers, half: float, impact: Impact) -> NDArray[np.bool_]:
    """Return which elements are fully integrated: about the contact, and where bending may yield.

    centres: (e, 3) in m. half: the patch, in m.
    """
    full = np.all(np.abs(centres) < 1.5 * half, axis=1)
    # An infinite beam whose middle moves at v has M = v sqrt(rho A EI) there: does it yield?
    steel, beam = impact.beam.material, impact.beam
    yields = steel.yield_stress / math.sqrt(3.0 * steel.density * steel.youngs_modulus)
    if impact.velocity > yields:
        x, near = centres[:, 0], 2.5 * beam.depth
        bent = np.abs(x) < near
        place, kinds, springs = impact.strike_position, ends(beam), end_springs(beam)
        distances = x + place * beam.span, (1.0 - place) * beam.span - x
        for kind, (_, turn), distance in zip(kinds, springs, distances, strict=True):
            if kind == "clamped" or turn > 0.0:
                bent |= distance < near
        full |= (body == BEAM) & bent
    return np.asarray(full)
