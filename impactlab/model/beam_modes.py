"""Modes of a beam with any ends: the table that the modal scheme takes for others than sines.

Lengths are over the span L, stiffnesses over EI and L: a beam of unit span, stiffness and mass. Its
modes are phi(x), of unit mean square, with the frequencies b^2 (in sqrt(EI/(rho A L^4))):

    phi = A sin(b x) + B cos(b x) + C exp(-b x) + D exp(-b (1 - x))

An end has a spring against deflection, k_t, and one against rotation, k_r (pinned: infinite and 0,
clamped: both infinite, free: both 0). With x from the end inwards its conditions are

    phi''' + k_t phi = 0,   phi'' - k_r phi' = 0.

The b are found by halving intervals on the number of modes below a frequency (Wittrick and
Williams), which misses none. Deflections, at the struck point and of the nodes, are those of phi.
Curvatures are those of the modes of the discrete beam (solver/beam.py), scaled to the stiffness
b^4: the curvatures of these modes are orthogonal over the sections, so that sections which yield
take nothing from a mode that it has not, and those of phi on the nodes are not. Of sines, both are
the same.

Sources: W. H. Wittrick, F. W. Williams, Q. J. Mech. Appl. Math. 24 (1971) 263; Rayleigh, Theory of
Sound, sections 170 to 175, on the integral of phi^2.
"""

import functools
import math
from typing import Any

import numpy as np

from impactlab.model.section import fibre_table
from impactlab.solver import SCHEMES, SUPPORTS

Array = np.ndarray[Any, Any]

_SPRINGS = {"pinned": (np.inf, 0.0), "clamped": (np.inf, np.inf), "free": (0.0, 0.0)}
_ELASTIC = SUPPORTS.index("elastic")
_HALVINGS, _SECANTS = 40, 6
_LEFT_OUT = 3
"""Modes of which the sum of those left out is made, over those kept; the rest is estimated."""
_LEAST = 1e-9
"""Deflection at the struck point that a mode has at least: amplitudes are counted by it."""


def has_table(cases: Any) -> Any:
    """Return which cases need a table of modes: by the modal scheme, and not of sines."""
    pinned = SUPPORTS.index("pinned")
    sines = (cases["support_left"] == pinned) & (cases["support_right"] == pinned)
    sines &= (cases["strike_position"] == 0.5) & (cases["further"] == 0)
    return (cases["scheme"] == SCHEMES.index("modal")) & ~sines


def mode_keys(cases: Any) -> Any:
    """Return a number per case, the same for those with the same table; 0 without any."""
    keys, tabled = np.zeros(cases.size, dtype=np.int64), np.flatnonzero(has_table(cases))
    if tabled.size:
        some = cases[tabled]
        columns = np.vstack([_springs(some).reshape(4, -1), some["nodes"], some["strike_position"]])
        keys[tabled] = 1 + np.unique(columns, axis=1, return_inverse=True)[1].reshape(-1)
    return keys


def _springs(cases: Any) -> Array:
    """Return k_t and k_r of the left ends and of the right ones, over EI and span, (2, 2, cases).

    EI is that of the integration rule.
    """
    z, area, _ = np.moveaxis(fibre_table(cases), 1, 0)
    bending, span = cases["beam_youngs_modulus"] * np.sum(area * z * z, axis=1), cases["beam_span"]
    springs = np.zeros((2, 2, cases.size))
    for row, side in zip(springs, ("left", "right"), strict=True):
        support = cases[f"support_{side}"]
        for entry, (kind, scale) in enumerate(
            (("", span**3 / bending), ("rotational_", span / bending))
        ):
            row[entry] = np.where(
                support == _ELASTIC, scale * cases[f"{kind}stiffness_{side}"], 0.0
            )
        for kind, fixed in _SPRINGS.items():
            row[:, support == SUPPORTS.index(kind)] = np.array(fixed)[:, np.newaxis]
    return springs


def mode_table(case: Any) -> Array:
    """Return the table of a case's modes, see `_table`; without any entry where it needs none.

    Further spheres have a column each, of the modes left out at their node alone.
    """
    if not has_table(case):
        return np.empty((0, 0))
    left, right = _springs(np.atleast_1d(case))[..., 0].tolist()
    nodes = int(case["nodes"])
    ends, struck = (tuple(left), tuple(right)), round(float(case["strike_position"]) * (nodes - 1))
    places = case["further_spheres"][: case["further"], 0]
    table, columns = _table(ends, nodes, struck, places.size == 0), []
    first = int(ends[0] == _SPRINGS["pinned"])
    for node in np.rint(places * (nodes - 1)).astype(int).tolist():
        column = np.zeros((len(table), 1))
        column[0], column[3 + node - first] = table[0, -1], 1.0 / _LEAST
        column[1] = _LEAST**2 * _table(ends, nodes, node, False)[1, -1]
        columns.append(column)
    return np.concatenate([table, *columns], axis=1)


@functools.lru_cache(maxsize=16)
def _table(
    ends: tuple[tuple[float, float], ...], nodes: int, struck: int, symmetric: bool
) -> Array:
    """Return the table of the modes of a beam with so many nodes.

    Columns: the n modes that the nodes can tell apart, and the sum of those left out. Rows: b^2;
    the square of phi at the struck node, of those left out the flexibility there; the share of
    sine and cosine in phi there; then phi, and the curvature, at each node that solver/beam.py
    moves, both over phi at the struck node. ends: k_t and k_r, left and right. symmetric: whether
    no other node is struck.
    """
    springs, spacings = np.array(ends), nodes - 1
    halved = symmetric and ends[0] == ends[1] and 2 * struck == spacings
    solved = spacings // 2 if halved else spacings
    moved = solved + 1 - np.isinf(springs[: 1 if halved else 2, 0]).sum()
    first = int(ends[0] == _SPRINGS["pinned"])  # the first and the last node of the solver
    last = solved - int(not halved and ends[1] == _SPRINGS["pinned"])
    places = np.append(np.arange(first, last + 1), struck) / spacings
    step = 2 if halved else 1  # the odd ones are zero in the middle
    b = wave_numbers(springs, step * (1 + _LEFT_OUT) * moved)
    phi, waves = (part[::step] for part in shapes(springs, b, places))
    b = b[::step]
    push = phi[:, -1] ** 2
    beyond = push[moved:] / b[moved:] ** 4
    gap = step * math.pi
    left_out = beyond.sum() + push[-moved:].mean() / (3.0 * gap * (b[-1] + 0.5 * gap) ** 3)
    curvatures = _curvatures(springs, halved, b[:moved], phi[:moved, :-1], places[:-1])
    at = np.where(np.abs(phi[:, -1]) < _LEAST, _LEAST, phi[:, -1])[:moved, np.newaxis]
    table = np.zeros((3 + 2 * (places.size - 1), moved + 1))
    table[0] = b[: moved + 1] ** 2
    table[1, :moved], table[1, moved] = at[:, 0] ** 2, left_out
    table[2, :moved] = waves[:moved, -1] / at[:, 0]
    table[3:, :moved] = (np.concatenate([phi[:moved, :-1], curvatures], axis=1) / at).T
    return table


def wave_numbers(springs: Array, count: int) -> Array:
    """Return b of the first modes, ascending, with zeros for those that do not bend the beam.

    springs: k_t and k_r of the left end and of the right one, (2, 2).
    """
    rigid = len(_rigid_shapes(springs, np.zeros(1)))
    numbers = np.arange(1 + rigid, count + 1)
    low, high = np.full(numbers.size, 1e-6), (numbers + 1.01) * math.pi
    for _ in range(_HALVINGS):
        b = 0.5 * (low + high)
        below = _modes_below(springs, b) >= numbers
        low, high = np.where(below, low, b), np.where(below, b, high)
    before, b = b * (1.0 - 1e-6), b * (1.0 + 1e-7)
    value_before, value = (np.linalg.det(_conditions(springs, each)) for each in (before, b))
    for _ in range(_SECANTS):  # to the last digits, which the count of modes may lose
        change = value - value_before
        step = np.where(
            change == 0.0, 0.0, value * (b - before) / np.where(change == 0.0, 1.0, change)
        )
        before, value_before, b = b, value, b - step
        value = np.linalg.det(_conditions(springs, b))
    return np.concatenate([np.zeros(rigid), b])


def _shares(springs: Array, b: Array) -> Array:
    """Return k_t/(b^3 + k_t) and k_r/(b + k_r) of both ends, (4, modes)."""
    with np.errstate(divide="ignore"):
        return 1.0 / (1.0 + np.stack([b**3, b, b**3, b]) / springs.reshape(4, 1))


def _conditions(springs: Array, b: Array) -> Array:
    """Return the conditions at the ends, by the factors of the four functions, (modes, 4, 4)."""
    shares, rows = _shares(springs, b)[..., np.newaxis], []
    for end, inwards in ((0, 1.0), (1, -1.0)):
        x = np.array([float(end)])
        phi, slope, bend, shear = (_basis(b, x, order)[:, 0] for order in range(4))
        against_w, against_turn = shares[2 * end], shares[2 * end + 1]
        rows.append((1.0 - against_w) * inwards * shear + against_w * phi)
        rows.append((1.0 - against_turn) * bend - against_turn * inwards * slope)
    return np.stack(rows, axis=1)


def _modes_below(springs: Array, b: Array) -> Array:
    """Return how many modes lie below b: those of clamped ends, and the negative stiffnesses."""
    sine, cosine, tanh = np.sin(b), np.cos(b), np.tanh(b)
    sech = 2.0 * np.exp(-b) / (1.0 + np.exp(-2.0 * b))
    pole, half_waves = sech - cosine, np.floor(b / math.pi)
    clamped = half_waves - 0.5 * (1.0 - (-1.0) ** half_waves * np.sign(pole))
    w, turn = cosine * tanh + sine, sine - cosine * tanh
    beside, w_beside = sine * tanh, -(sine * sech + tanh)
    turn_beside, across = tanh - sine * sech, 1.0 - cosine * sech
    rows = [
        [w, beside, w_beside, across],
        [beside, turn, -across, turn_beside],
        [w_beside, -across, w, -beside],
        [across, turn_beside, -beside, turn],
    ]
    shares = _shares(springs, b)
    open_ends, negative = np.sqrt(1.0 - shares), np.zeros(b.size)
    with np.errstate(divide="ignore", invalid="ignore"):  # at a pole, which is a root at most
        matrix = np.array(rows) / pole * open_ends * open_ends[:, np.newaxis]
        matrix[range(4), range(4)] += shares
        for i in range(4):
            negative += matrix[i, i] < 0.0
            for j in range(i + 1, 4):
                matrix[j, i + 1 :] -= matrix[j, i] / matrix[i, i] * matrix[i, i + 1 :]
    return clamped + negative


def _basis(b: Array, x: Array, order: int) -> Array:
    """Return derivatives, over b^order, of the four functions at x, (modes, places, 4)."""
    angle, b = b[:, np.newaxis] * x + 0.5 * math.pi * order, b[:, np.newaxis]
    falling, rising = (-1.0) ** order * np.exp(-b * x), np.exp(-b * (1.0 - x))
    return np.stack([np.sin(angle), np.cos(angle), falling, rising], axis=-1)


def shapes(springs: Array, b: Array, places: Array) -> tuple[Array, Array]:
    """Return phi at places (of the span), and the part of it that is sine and cosine.

    Both of shape (modes, places). springs, b: see wave_numbers.
    """
    rigid = _rigid_shapes(springs, places)
    bent = b[len(rigid) :]
    factors = np.linalg.svd(_conditions(springs, bent))[2][:, -1, :, np.newaxis]
    ends = [(_basis(bent, np.array([0.0, 1.0]), order) @ factors)[:, :, 0] for order in range(4)]
    sums = (3.0 * ends[0] * ends[3] - ends[1] * ends[2]) / bent[:, np.newaxis]
    sums[:, 1] += (ends[0] ** 2 - 2.0 * ends[1] * ends[3] + ends[2] ** 2)[:, 1]
    factors = factors / np.sqrt(0.25 * (sums[:, 1] - sums[:, 0]))[:, np.newaxis, np.newaxis]
    basis = _basis(bent, places, 0)
    phi, waves = basis @ factors, basis[..., :2] @ factors[:, :2]
    return np.concatenate([rigid, phi[..., 0]]), np.concatenate([rigid, waves[..., 0]])


def _rigid_shapes(springs: Array, x: Array) -> Array:
    """Return the shapes at x in which the beam moves without bending, (modes, places)."""
    left, right = springs[:, 0] > 0.0
    turns = not springs[:, 1].any()
    rows = [] if left or right else [np.ones_like(x)]
    if turns and not (left and right):
        about_left, about_right = math.sqrt(3.0) * x, math.sqrt(3.0) * (1.0 - x)
        rows.append(about_left if left else about_right if right else about_left - about_right)
    return np.array(rows).reshape(-1, x.size)


def _curvatures(springs: Array, halved: bool, b: Array, phi: Array, places: Array) -> Array:
    """Return the curvatures of the modes at places, the solver's nodes, (modes, places).

    b: of the modes. phi: deflections there. halved: whether the last place is mid-span.
    """
    dx = places[1] - places[0]
    solved = round((0.5 if halved else 1.0) / dx)
    size = solved + 1
    mass, weights = np.full(size, dx), np.full(size + 4, dx)
    mass[[0, solved]], weights[[0, solved]] = 0.5 * dx, 0.5 * dx
    rows, free = np.zeros((size + 4, size)), np.ones(size, dtype=bool)  # springs come last
    for i in range(1, solved):
        rows[i, i - 1 : i + 2] = np.array([1.0, -2.0, 1.0]) / dx**2
    for side, end, beside in ((0, 0, 1), (1, solved, solved - 1)):
        k_t, k_r = (0.0, np.inf) if side and halved else springs[side]
        slope = np.array([-1.0, 1.0]) / dx
        if k_r == np.inf:
            rows[end, [end, beside]] = 2.0 * slope / dx
        elif k_r > 0.0:  # in series with half a spacing, which stays elastic
            rows[size + side, [end, beside]] = slope
            weights[size + side] = 1.0 / (1.0 / k_r + 0.5 * dx)
        if 0.0 < k_t < np.inf:
            rows[size + 2 + side, end], weights[size + 2 + side] = 1.0, k_t
        free[end] = k_t < np.inf
    scaled = rows[:, free] * np.sqrt(weights)[:, np.newaxis] / np.sqrt(mass[free])
    bent, _, moved = np.linalg.svd(scaled, full_matrices=False)
    bending = np.count_nonzero(b)
    deflections = np.zeros((bending, size))
    deflections[:, free] = moved[:bending][::-1] / np.sqrt(mass[free])
    nodes = slice(round(places[0] / dx), round(places[-1] / dx) + 1)
    signs = np.sign(np.sum((mass * deflections)[:, nodes] * phi[b.size - bending :], axis=1))
    lengths = weights[:size] * (2.0 if halved else 1.0)
    curvatures = np.zeros_like(phi)
    curvatures[b.size - bending :] = (
        bent[nodes, :bending].T[::-1]
        * (signs * b[b.size - bending :] ** 2)[:, np.newaxis]
        / np.sqrt(lengths[nodes])
    )
    return curvatures
