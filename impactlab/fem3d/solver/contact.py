"""Impulses that keep matched nodes from passing through each other.

A step's motion is predicted without contact. Where a pair's gap would be below zero at its end, an
impulse on both nodes makes it exactly zero: N. J. Carpenter, R. L. Taylor and M. G. Katona, Int. J.
Numer. Meth. Engng. 32 (1991) 103, for matched nodes and diagonal masses. Impulses only push.
Momentum is kept; a closing pair loses the energy of its approach, as in a perfectly plastic impact
of two nodes, which vanishes with the nodes' mass.
"""

from __future__ import annotations

from impactlab.fem3d.solver.jit import Array, compiled


@compiled
def close_gaps(
    pairs: Array,
    rim: Array,
    inverse_mass: Array,
    x: Array,
    v: Array,
    dt: float,
    approach: Array,
) -> tuple[float, float, bool]:
    """Correct x (m, at the step's end) and v (m/s, at its middle) of pairs that would overlap.

    pairs: (p, 2) nodes, of the upper and the lower body. approach: (p,) their relative velocity in
    m/s in the step before, replaced by this one's. Returns the sum of the impulses in N s, the
    energy lost in J, and whether a pair on the rim touches.
    """
    impulse, lost, beyond = 0.0, 0.0, False
    for p in range(pairs.shape[0]):
        upper, lower = pairs[p]
        gap = x[upper, 2] - x[lower, 2]
        push = 0.0
        if gap < 0.0:
            up, down = inverse_mass[upper, 2], inverse_mass[lower, 2]
            push = -gap / (dt * (up + down))
            v[upper, 2] += push * up
            v[lower, 2] -= push * down
            x[upper, 2] += dt * push * up
            x[lower, 2] = x[upper, 2]
            beyond = beyond or rim[p]
        moving = v[lower, 2] - v[upper, 2]
        impulse += push
        lost += 0.5 * push * (approach[p] + moving)
        approach[p] = moving
    return impulse, lost, beyond
