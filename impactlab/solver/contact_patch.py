"""The contact force spread over the circle of contact: the load `contact_patch`.

Hertz's pressure on a circle of radius a, summed over the width, is a parabola along the beam,

    p(x) = F phi(x), phi = 3/(4 a) (1 - (x/a)^2) for |x| <= a,

whose integral is F (Johnson, Contact Mechanics, eq. 3.39, integrated). The circle is the contact
law's own: while loading as its file has it, while unloading as Hertz's on the dented bodies,
a = a_m (F/F_m)^(1/3).

The sphere indents the beam by what does the pressure's work: the indentation changes at the rate

    delta' = w_s' - integral of phi w' dx,

of the deflection's mean under the present pressure. Then F delta' is the power that sphere and beam
lose, however the circle grows and shrinks, so the contact laws and the audit of the energy hold as
they are; in time steps but for the change of phi within one. What the form neglects: pressure is
flatter than Hertz's where the contact yields (uniform, it takes 13 % more off the moment), the
beam's curvature is nothing beside the sphere's, and its depth spreads no load.

At the nodes p becomes forces by hat functions, which keep sum and centre: the moments of a beam at
rest are exact at the nodes, even where the circle is smaller than a spacing.
"""

import math

from impactlab.solver.beam import SYMMETRIC, BeamGrid, BeamState, mirror
from impactlab.solver.contact.history import Pair, pair_radius, yield_stress
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record


@compiled
def contact_radius(contact: Record, pair: Pair, F: float) -> float:
    """Return the radius (m) of the circle of contact under the force F (N), damping apart."""
    a = pair_radius(pair, contact.delta_m, yield_stress(contact, pair))
    return float(a * min((F - contact.damping) / contact.F_m, 1.0) ** (1.0 / 3.0))


@compiled
def _twice_integrated(x: float, a: float) -> float:
    """Return the second integral of phi, even, in m."""
    if x >= a:
        return 0.5 * x - 0.1875 * a
    return 0.375 * x * x / a * (1.0 - x * x / (6.0 * a * a))


@compiled
def node_share(k: int, dx: float, a: float) -> float:
    """Return the share of the force on the node k spacings from the struck one."""
    x = k * dx
    beside = _twice_integrated(x + dx, a) + _twice_integrated(abs(x - dx), a)
    return (beside - 2.0 * _twice_integrated(x, a)) / dx


@compiled
def wave_share(z: float) -> float:
    """Return the integral of phi(x) cos(k x), z = k a: the share of the force on that mode."""
    if z < 0.1:
        return 1.0 - z * z / 10.0 * (1.0 - z * z / 28.0 * (1.0 - z * z / 54.0))
    return 3.0 * (math.sin(z) - z * math.cos(z)) / z**3


@compiled
def fading_share(z: float) -> float:
    """Return the integral of phi(x) cosh(k x), z = k a."""
    if z < 0.1:
        return 1.0 + z * z / 10.0 * (1.0 + z * z / 28.0 * (1.0 + z * z / 54.0))
    return 3.0 * (z * math.cosh(z) - math.sinh(z)) / z**3


@compiled
def spread_over_nodes(
    beam: BeamState, grid: BeamGrid, now: int, F: float, a: float
) -> tuple[float, float, int]:
    """Spread a force F (N), with which a step was made at the struck node, over the radius a (m).

    It is not spread beyond an end. Returns (how far the mean under the pressure has moved beyond
    the struck node, m; half the work of F beside it, J; number of nodes pushed on either side).
    """
    u, du, after, mid = beam.u, beam.du, beam.w[1 - now], grid.mid
    halved, room = grid.right == SYMMETRIC, mid - grid.first
    if not halved:
        room = min(room, grid.stop - 1 - mid)
    shares, mean, pushed = 0.0, 0.0, 0
    while pushed < room and pushed * grid.dx < a:
        pushed += 1
        left, share = mid - pushed, node_share(pushed, grid.dx, a)
        right = left if halved else mid + pushed
        change = grid.push * F * share
        for i in range(left, right + 1, max(right - left, 1)):
            du[i] += change
            u[i] += change
            after[i] += change
        shares += share
        mean += share * (0.5 * (u[left] + u[right]))
    back = 2.0 * shares * grid.push * F
    du[mid] -= back
    u[mid] -= back
    after[mid] -= back
    mirror(beam.w, now, u, grid)
    return 2.0 * (mean - shares * u[mid]), F * mean, pushed
