"""Odd modes of the simply supported beam loaded at mid-span, and the effects of shear.

y_n (m) is the mid-span deflection in mode n: y_n'' + omega_n^2 y_n = F/m_n; Euler's and Bernoulli's
theory has m_n = rho A L/2 (kg). Even modes have a node at mid-span and are not excited. The modes
left out follow the load F (N) statically, so that any number of modes has the right static
deflection, F L^3/(48 EI) and what shear adds to it.

Timoshenko's theory: rho A w_tt = Q_x + p, rho I psi_tt = M_x + Q, Q = a (w_x - psi), M = EI psi_x,
a = k G A; w = M = 0 at both ends. With w = W sin(q x), psi = Psi cos(q x), q = n pi/L, and the load
2 F/L of a point load F (N) at mid-span (signs make each mode 1 there), n odd:

    rho A W'' = -a q (q W - Psi) + 2 F/L,   rho I Psi'' = a (q W - Psi) - EI q^2 Psi,

two coupled oscillators, and so two frequencies for each n: mostly deflection, and mostly rotation.
Sources: Timoshenko, Vibration Problems in Engineering, on forced vibrations of beams; S.
Timoshenko, Phil. Mag. 41 (1921) 744 and 43 (1922) 125; the second spectrum: R. W. Traill-Nash and
A. R. Collar, Q. J. Mech. Appl. Math. 6 (1953) 186.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from impactlab.model.bodies import Beam
from impactlab.types import Floats


@dataclass(frozen=True)
class BeamModes:
    """Constants of the first odd modes, each of shape (modes,).

    wave_numbers: n pi/L in 1/m. frequencies: omega_n in rad/s. flexibilities: 1/(m_n omega_n^2) in
    m/N. curvatures: of bending at mid-span, over y_n, in 1/m2. statics: deflection (m/N) and
    curvature (1/(m N)) at mid-span per load at rest.
    """

    beam: Beam
    wave_numbers: Floats
    frequencies: Floats
    flexibilities: Floats
    curvatures: Floats
    statics: tuple[float, float]

    @property
    def residual_flexibility(self) -> float:
        """Mid-span deflection per load of the modes left out, in m/N."""
        return float(self.statics[0] - self.flexibilities.sum())

    @property
    def residual_curvature(self) -> float:
        """Mid-span curvature per load of the modes left out, in 1/(m N)."""
        return float(self.statics[1] - self.curvatures @ self.flexibilities)


def odd_modes(beam: Beam, count: int) -> BeamModes:
    """Return the first `count` odd modes of the Euler-Bernoulli beam: n = 1, 3, 5, ..."""
    wave_numbers = _odd_wave_numbers(beam, count)
    squares = wave_numbers**2
    frequencies = squares * math.sqrt(beam.bending_stiffness / beam.mass_per_length)
    mass = 0.5 * beam.mass_per_length * beam.span
    flexibilities = 1.0 / (mass * frequencies**2)
    statics = _bending_statics(beam)
    return BeamModes(beam, wave_numbers, frequencies, flexibilities, -squares, statics)


def _bending_statics(beam: Beam) -> tuple[float, float]:
    EI = beam.bending_stiffness
    return beam.span**3 / (48.0 * EI), -beam.span / (4.0 * EI)


def _odd_wave_numbers(beam: Beam, count: int) -> Floats:
    return np.arange(1, 2 * count, 2, dtype=np.float64) * (math.pi / beam.span)


def modes_on_nodes(
    beam: Beam, nodes: int, stiffness: float, dt: float
) -> tuple[Floats, Floats, Floats]:
    """Return (wave numbers, shapes, inertias) of the odd modes that nodes can tell apart.

    They are half as many as there are spacings. shapes: sin(k x) at the nodes, (nodes, modes).
    inertias: per length in kg/m, those with which central differences in time turn a free mode in
    a step dt (s) by its exact omega dt, or by a quarter of a turn where that is less. stiffness:
    EI in N m2, as the fibres have it.
    """
    k = _odd_wave_numbers(beam, nodes // 2)
    shapes = np.sin(np.outer(np.linspace(0.0, beam.span, nodes), k))
    turn = np.minimum(dt * k**2 * math.sqrt(stiffness / beam.mass_per_length), 0.5 * math.pi)
    return k, shapes, stiffness * k**4 * (0.5 * dt / np.sin(0.5 * turn)) ** 2


def modes_left_out(beam: Beam, nodes: int, stiffness: float, dt: float) -> tuple[float, float]:
    """Return (flexibility in m/N, D) of all odd modes that nodes cannot tell apart, as one.

    flexibility: of mid-span under a static force, summed over them. D: 4 sin^2(omega dt/2) of the
    first, as central differences in time have it, 2 at most. stiffness: EI in N m2.
    """
    k = _odd_wave_numbers(beam, 100_000)[nodes // 2 :]
    turn = min(dt * k[0] ** 2 * math.sqrt(stiffness / beam.mass_per_length), 0.5 * math.pi)
    return float(np.sum(2.0 / (stiffness * beam.span * k**4))), 4.0 * math.sin(0.5 * turn) ** 2


def timoshenko_odd_modes(beam: Beam, count: int) -> BeamModes:
    """Return both spectra of the first `count` odd n: the lower frequencies, then the higher.

    omega^2 are the eigenvalues of ((r, -c), (-c, p)), r and p the squares of each oscillator's own
    frequency, where p > r. Mode masses: 1/m = 2/(rho A L) times W's share in the mode, the square
    of W's entry in the unit eigenvector of (sqrt(rho A) W, sqrt(rho I) Psi); the shares of one n
    add up to 1. Curvatures: psi_x = -q Psi, q Psi = (q^2 - rho A omega^2/a) W, by the first
    equation without load.
    """
    q, a = _odd_wave_numbers(beam, count), shear_stiffness(beam)
    EI, mu = beam.bending_stiffness, beam.mass_per_length
    inertia = beam.section.rotary_inertia(beam.material.density)
    r, p = a * q**2 / mu, (a + EI * q**2) / inertia
    half, coupling = 0.5 * (p - r), (a * q) ** 2 / (mu * inertia)
    root = np.sqrt(half**2 + coupling)
    # Lower root and smaller share without taking differences.
    upper = 0.5 * (p + r) + root
    lower = a * EI * q**4 / (mu * inertia) / upper
    small = coupling / (2.0 * root * (root + half))
    squares, shares = np.concatenate((lower, upper)), np.concatenate((1.0 - small, small))
    wave_numbers = np.tile(q, 2)
    flexibilities = 2.0 * shares / (mu * beam.span * squares)
    curvatures = mu * squares / a - wave_numbers**2
    deflection, curvature = _bending_statics(beam)
    statics = deflection + 0.25 * beam.span * (1.0 / a), curvature
    return BeamModes(beam, wave_numbers, np.sqrt(squares), flexibilities, curvatures, statics)


def strip_odd_modes(beam: Beam, count: int, across: Sequence[float]) -> BeamModes:
    """Return the three spectra of the first `count` odd n of a strip.

    across: stiffness (N m2), inertia (kg m3), lever (m2) and twist (N m4) of s. y_n (m) is that of
    the strip's middle; no mode's deflection is w alone. With s = S sin(q x) beside W and Psi, n
    gives three oscillators: the Hessians of the energies of solver/strip.py are their masses and
    springs. The load is 2 F/L on the middle W - lever S. Statics: 100 times as many n.
    """
    nu, a, mu = beam.material.poissons_ratio, shear_stiffness(beam), beam.mass_per_length
    EI, (stiffness, inertia, lever, twist) = beam.bending_stiffness, across
    middle = np.array([1.0, 0.0, -lever])

    def springs(q: Floats) -> Floats:
        K = np.zeros((q.size, 3, 3))
        K[:, 0, 0], K[:, 1, 1] = a * q**2, a + EI * q**2 + nu**2 * stiffness * q**2
        K[:, 0, 1] = K[:, 1, 0] = -a * q
        K[:, 1, 2] = K[:, 2, 1] = -nu * stiffness * q
        K[:, 2, 2] = stiffness + twist * q**2
        return K

    q = _odd_wave_numbers(beam, count)
    roots = np.sqrt([mu, beam.section.rotary_inertia(beam.material.density), inertia])
    squares, vectors = np.linalg.eigh(springs(q) / np.outer(roots, roots))
    shapes = vectors / roots[:, None]
    y = np.einsum("i,nij->nj", middle, shapes)
    flexibilities = 2.0 / beam.span * y**2 / squares
    curvatures = -q[:, None] * shapes[:, 1, :] / y
    many = _odd_wave_numbers(beam, 100 * count)
    rest = np.linalg.solve(springs(many), np.broadcast_to(middle[:, None], (many.size, 3, 1)))
    statics = 2.0 / beam.span * np.array([np.sum(rest[:, :, 0] @ middle), -many @ rest[:, 1, 0]])
    spectra = np.sqrt(squares), flexibilities, curvatures
    omega, flexible, bent = (spectrum.T.ravel() for spectrum in spectra)
    still = float(statics[0]), float(statics[1])
    return BeamModes(beam, np.tile(q, 3), omega, flexible, bent, still)


def shear_stiffness(beam: Beam) -> float:
    """Return k G A in N, k the shear coefficient, G = E/(2 (1 + nu))."""
    modulus = beam.material.youngs_modulus / (2.0 * (1.0 + beam.material.poissons_ratio))
    return float(beam.shear_correction * modulus * beam.section.area)


def shear_deflection(beam: Beam, load: float) -> float:
    """Return what shear adds to the elastic mid-span deflection, P L/(4 k G A) in m; P in N."""
    return load * beam.span / (4.0 * shear_stiffness(beam))
