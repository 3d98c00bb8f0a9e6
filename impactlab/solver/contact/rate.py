"""The contact's yield stress at its own strain rate.

The contact has Tabor's representative strain, 0.2 a/R, and flows as a fibre of that strain does
(strain_rate.py): its stress grows by the modulus times the strain until it yields, and then is the
yield stress of the law at this instant, with the contact's overstress. The modulus is that of
Hertz's mean pressure 4 E a/(3 pi R) over the hardness, 2.8 yield stresses, so that the stress
cannot fall faster than the bodies recover. While the contact unloads it keeps its yield stress.

The unloading curve is the law's at the yield stress of now. What is dissipated is what the free
energy loses when the state of the contact changes under its force, see contact/prestress.py.

Sources: Tabor, The Hardness of Metals (1951), as remembered. That this stress and no other follows
the impact was tried against 3-D finite elements (tests/benchmarks/strain_rate.py): the yield stress
at one rate per impact is right in either the largest force or the indentation, not in both.
"""

import math

from impactlab.solver.contact.history import Pair, load, pair_radius
from impactlab.solver.contact.prestress import complementary
from impactlab.solver.contact.stronge import MEAN_PRESSURE
from impactlab.solver.jit import compiled
from impactlab.solver.strain_rate import overstress
from impactlab.solver.types import Record, Unloading

STRAIN = 0.2
"""Representative strain over a/R."""
MODULUS = 4.0 / (3.0 * math.pi * MEAN_PRESSURE * STRAIN)
"""Over E: of the representative stress and strain."""
_TOUCH, _ROUND_OFF = 1e-6, 1e-12


@compiled
def strain(contact: Record, pair: Pair, approach: float, dt: float) -> None:
    """Let the contact's stress follow a step of dt (s) to `approach` (m), if it is loaded on."""
    if approach <= contact.approach_m:
        return
    if contact.delta_m == 0.0:
        load(contact, pair, _TOUCH * approach)
    delta = contact.delta_m + approach - contact.approach_m
    before = pair_radius(pair, contact.delta_m, pair.S_y)
    after = pair_radius(pair, delta, pair.S_y)
    modulus = MODULUS * pair.E
    trial = contact.stress + modulus * STRAIN * (after - before) / pair.R
    if trial > pair.S_y * (1.0 + _ROUND_OFF):
        s, _ = overstress(trial, pair.S_y, 0.0, modulus, dt, pair.rate)
        trial = pair.S_y * (1.0 + s)
    contact.stress = trial


@compiled
def curve_of(contact: Record) -> Unloading:
    """Return the contact's unloading curve, see contact/hertz.py."""
    return contact.F_m, contact.K, contact.delta_r, contact.n


@compiled
def dissipate(contact: Record, before: Unloading) -> None:
    """Add what a step of loading dissipates; before: the unloading curve until then."""
    F, K, delta_r, n = before
    mean = 0.5 * (F + contact.F_m)
    contact.work += complementary(mean, contact.K, contact.delta_r, contact.n)
    contact.work -= complementary(mean, K, delta_r, n)
