"""Closed-form modes of beams of any supports, and the response that they sum up to."""

import functools
import itertools
from dataclasses import replace

import numpy as np
from scipy.integrate import cumulative_trapezoid, simpson
from scipy.optimize import brentq

import impactlab as il
from impactlab.solver import SUPPORTS

PLAIN = SUPPORTS[:3]
"""Supports without springs."""
PAIRS = list(itertools.product(PLAIN, PLAIN))
IMPACT = replace(il.paper_impact(1.0, "hertz"), beam_model="elastic")


def held(left, right, place, impact=IMPACT):
    beam = replace(impact.beam, support_left=left, support_right=right)
    return replace(impact, beam=beam, strike_position=place)


def characteristic(left, right):
    """(function of beta L whose roots are the modes, estimate of the n-th root).

    Rayleigh's equations, divided by cosh, with free and clamped ends alike.
    """
    kinds = sorted("pinned" if end == "pinned" else end for end in (left, right))
    if kinds == ["pinned", "pinned"]:
        return np.sin, lambda n: n * np.pi
    if "pinned" in kinds:
        return lambda b: np.sin(b) - np.tanh(b) * np.cos(b), lambda n: (n + 0.25) * np.pi
    sign = 1.0 if kinds == ["clamped", "free"] else -1.0
    shift = -0.5 if sign > 0 else 0.5
    return lambda b: np.cos(b) + sign / np.cosh(b), lambda n: (n + shift) * np.pi


def roots(left, right, number):
    function, near = characteristic(left, right)
    return np.array(
        [brentq(function, near(n) - 0.4, near(n) + 0.4, xtol=1e-13) for n in range(1, number + 1)]
    )


SPEEDS, TURNS = np.linalg.eig(np.roll(np.eye(4), 1, axis=1))
"""Of the matrix by which a derivative over b^order is that of the next order."""


def determinant(springs, b):
    """Zero at a mode: phi and its derivatives, each over b^order, across the span.

    springs: k_t and k_r of the left end and of the right one, over EI and span.
    """
    across = ((TURNS * np.exp(b * SPEEDS)) @ TURNS.conj().T).real
    rows = []
    for (k_t, k_r), inwards, end in zip(springs, (1.0, -1.0), (np.eye(4), across), strict=True):
        t, r = (1.0 if np.isinf(k) else k / (k + b**n) for k, n in ((k_t, 3), (k_r, 1)))
        rows.append((1.0 - t) * inwards * end[3] + t * end[0])
        rows.append((1.0 - r) * end[2] - r * inwards * end[1])
    return np.linalg.det(np.array(rows))


@functools.cache
def sprung_roots(springs, number):
    """The first roots of the characteristic equation."""
    grid = np.linspace(0.3, 3.5 * (number + 2), 70 * (number + 2))
    values = np.array([determinant(springs, b) * np.exp(-b) for b in grid])
    signs = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    found = [brentq(lambda b: determinant(springs, b), *grid[k : k + 2], xtol=1e-13) for k in signs]
    return np.array(found[:number])


def basis(b, x, derivative):
    """Four solutions of y'''' = b^4 y on (0, 1), of size one each: rows x, columns solutions."""
    quarter = derivative * np.pi / 2
    falling, rising = np.exp(-b * x), np.exp(-b * (1 - x))
    columns = np.sin(b * x + quarter), np.cos(b * x + quarter), (-1) ** derivative * falling, rising
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


CONDITIONS = {"pinned": (0, 2), "clamped": (0, 1), "free": (2, 3)}


def modes(left, right, number, x):
    """(beta L, shapes on x, with unit mean square) of the bending modes."""
    betas, shapes, fine = roots(left, right, number), [], np.linspace(0, 1, 8001)
    for b in betas:
        rows = [basis(b, 0.0, order) for order in CONDITIONS[left]]
        rows += [basis(b, 1.0, order) for order in CONDITIONS[right]]
        coefficients = np.linalg.svd(np.array(rows))[2][-1]
        shape = basis(b, fine, 0) @ coefficients
        shapes.append(basis(b, x, 0) @ coefficients / np.sqrt(simpson(shape**2, x=fine)))
    return betas, np.array(shapes)


def rigid_shapes(left, right, x):
    """Shapes in which the beam moves without bending, with unit mean square."""
    if (left, right) == ("free", "free"):
        return [np.ones_like(x), np.sqrt(12) * (x - 0.5)]
    if {left, right} == {"pinned", "free"}:
        return [np.sqrt(3) * (x if left == "pinned" else 1 - x)]
    return []


def response_errors(left, right, place, nodes, scheme="leapfrog"):
    """Return errors of history and last shape, over the largest deflection, under the same force.

    Every closed-form mode is integrated exactly under that force.
    """
    impact = held(left, right, place)
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    run = il.simulate(impact, grid, duration=3e-3, samples=6001)
    beam, t, x = impact.beam, run.time.values, run.x.values / impact.beam.span
    force, mass = run.contact_force.values, beam.mass_per_length * beam.span
    places = np.append(x, place)
    betas, shapes = modes(left, right, 60, places)
    speeds = betas**2 * np.sqrt(beam.bending_stiffness / (mass * beam.span**3))
    turns = np.exp(-1j * np.outer(speeds, t))
    sums = cumulative_trapezoid(force * turns, t, initial=0.0) / turns
    amplitudes = sums.imag / (mass * speeds[:, np.newaxis])
    twice = cumulative_trapezoid(cumulative_trapezoid(force, t, initial=0.0), t, initial=0.0)
    for shape in rigid_shapes(left, right, places):
        shapes, amplitudes = np.vstack([shapes, shape]), np.vstack([amplitudes, twice / mass])
    amplitudes *= shapes[:, -1:]
    history, profile = shapes[:, -1] @ amplitudes, amplitudes[:, -1] @ shapes[:, :-1]
    size = np.abs(history).max()
    assert size > 2e-5
    errors = run.midspan_deflection.values - history, run.deflection.values - profile
    return np.array([np.abs(error).max() for error in errors]) / size
