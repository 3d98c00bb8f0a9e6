"""The kink that a dent leaves in the beam: with `contact_prestress: bending`.

Metal that flows beneath the contact is pushed along the beam, too, which stretches the struck face
and kinks the beam upwards by an angle theta:

    d theta = z dV/I, z = H/2 - 1.41 sqrt(R delta_m),
    dV = 1.07 R (1 - 1.57 s - 4.65 s^2) d(delta_m delta_r)/(1 + <x - 75>/94),

as long as it grows. V: plastic strain along the beam, summed over the volume beneath the contact;
s: compression of the struck face by bending over the yield stress; x = delta_m/delta_y; I: second
moment of the section. Under more compression (s > 0.32) metal flows across the beam, and in the end
weakens the section: that is left out, since kinks that shrink made the impulse at 20 m/s worse, but
between the sides of a narrow beam, where the whole width flows. There dV is less by the share
18 s sigma/(1 + <x - 75>/94) of 1.07 R d(delta_m delta_r), with sigma as in contact/prestress.py.
The numbers were fitted to 3-D finite elements, three beams from 0.5 to 10 m/s, 15 <= x <= 250,
whose theta they meet within 6 % up to 5 m/s; at 10 m/s it is 1.7 times too large. All are of two
like steels. On other metals theta is 0.6 (soft copper) to 1.1 times (under glass) that of 3-D, 0.8
with aluminium, titanium and hardening (5 m/s, copper 1 m/s; 5 elements over the contact's radius).
Where the sphere flows as well, dV is the beam's share in that (contact/metals.py), without which
theta was 1.7 times too large under a sphere as soft as the beam; with it, it is 0.8 times.

The kink needs no stress where both ends are pinned: a beam of two straight parts, of which the
left one turns by theta (L - x_0)/L. So the kernels hold the deflection beyond that, which is
`w + theta (L - x_0)/L x` up to the struck section at x_0; all moments are as they were, and the
velocity is that of the beam. Against the moment M there the kink takes the work M d theta from the
contact. Other ends, and a foundation, would hold it: there the kink is left out. It changes
force, duration and indentations of a first contact by 0.6 % at most (three beams, 0.99 to 20 m/s);
what a held kink does to the deflection after it has not been compared with 3-D.
"""

import math

from impactlab.solver.beam import PINNED, SYMMETRIC, BeamGrid, BeamState, mirror
from impactlab.solver.contact.history import Pair, sideways, softer_share, yield_stress
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.jit import compiled
from impactlab.solver.timoshenko import mirror_rotation
from impactlab.solver.types import Array, Record

VOLUME, SHALLOW, WIDTH, DEPTH = 1.07, 75.0, 94.0, 1.41
BENDING = 1.57, 4.65
SHARED = 18.0


@compiled
def growth(case: Record, contact: Record, pair: Pair) -> float:
    """Return how far the kink (rad) has grown since the last call; keeps what it has seen."""
    area = contact.delta_m * contact.delta_r
    grown, contact.dent_area = area - contact.dent_area, area
    hinged = case.support_left == PINNED and case.support_right == PINNED
    if grown <= 0.0 or not hinged or case.foundation_stiffness > 0.0:
        return 0.0
    S_y = yield_stress(contact, pair)
    deeper = contact.delta_m / yield_indentation(pair.E, pair.R, S_y) - SHALLOW
    s = contact.stress_along / S_y
    deep = 1.0 + max(deeper, 0.0) / WIDTH
    share = max((1.0 - s * (BENDING[0] + BENDING[1] * abs(s))) / deep, 0.0)
    share -= SHARED * sideways(contact, pair) * max(s, 0.0) / deep
    z = max(0.5 * case.beam_depth - DEPTH * math.sqrt(pair.R * contact.delta_m), 0.0)
    share *= softer_share(contact, pair, S_y)
    second_moment = case.beam_width * case.beam_depth**3 / 12.0
    return float(VOLUME * pair.R * share * grown * z / second_moment)


@compiled
def left_share(grid: BeamGrid) -> float:
    """Return the share of the kink by which the part left of it turns."""
    return 0.5 if grid.right == SYMMETRIC else (grid.stop - grid.mid) / (grid.stop - 1)


@compiled
def height(grid: BeamGrid, kink: float) -> float:
    """Return how far the kink (rad) raises the struck node (m)."""
    return left_share(grid) * kink * (grid.mid - 1) * grid.dx


@compiled
def height_of(grid: BeamGrid, kink: float, i: int) -> float:
    """Return how far a kink at the struck node (rad) raises node i of the whole beam (m)."""
    left = left_share(grid) * kink
    return float(min(left * (i - 1), (kink - left) * (grid.stop - i)) * grid.dx)


@compiled
def bend_back(beam: BeamState, now: int, psi: Array, grid: BeamGrid, growth: float) -> None:
    """Let the beam keep its place while its kink grows by so much (rad)."""
    left = left_share(grid) * growth
    for i in range(1, grid.mid):
        beam.w[now, i + 1] += left * i * grid.dx
        psi[i] += left
    if grid.right != SYMMETRIC:
        right = growth - left
        for i in range(grid.mid, grid.stop):
            psi[i] -= right
        for i in range(grid.mid + 1, grid.stop):
            beam.w[now, i] += right * (grid.stop - i) * grid.dx
    mirror(beam.w, 1 - now, beam.u, grid)
    mirror_rotation(psi, grid)


@compiled
def straighten(w: Array, grid: BeamGrid, kink: float) -> None:
    """Make of the deflection beyond the kink that of the beam."""
    left = left_share(grid) * kink
    for row in range(2):
        for i in range(1, grid.mid + 1):
            w[row, i] -= left * (i - 1) * grid.dx
        if grid.right != SYMMETRIC:
            for i in range(grid.mid + 1, grid.stop):
                w[row, i] -= (kink - left) * (grid.stop - i) * grid.dx
