"""Load and deflection beyond yield against the closed form, integrals and balances of energy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions import bending

BEAM = paper_impact().beam
HARDENING = replace(BEAM, material=replace(BEAM.material, kinematic_hardening_modulus=5e9))
AT_YIELD = 4 * bending.yield_moment(BEAM) / BEAM.span
W_YIELD = bending.static_deflection(BEAM, AT_YIELD)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 1.1, 1.3, 1.49, 1.4999])
def test_deflection_is_the_closed_form_without_hardening(ratio):
    """w/w_y = (5 - (3 + p) sqrt(3 - 2 p))/p^2, p = P/P_y: Prager and Hodge."""
    expected = (5 - (3 + ratio) * np.sqrt(3 - 2 * ratio)) / ratio**2 if ratio > 1 else ratio
    deflection = bending.midspan_deflection(BEAM, ratio * AT_YIELD)
    assert deflection == pytest.approx(expected * W_YIELD, rel=1e-9)


def test_deflection_is_the_integral_along_a_hardening_beam():
    load = 1.7 * AT_YIELD

    def curvature(x):
        target = load * x / 2
        return brentq(lambda kappa: float(bending.moment(HARDENING, kappa)) - target, 0, 10)

    edge = 2 * bending.yield_moment(BEAM) / load
    expected, _ = quad(lambda x: curvature(x) * x, 0, BEAM.span / 2, points=[edge])
    found = bending.midspan_deflection(HARDENING, load)
    assert found == pytest.approx(expected, rel=1e-8)


def test_collapse_begins_at_20_9_of_the_deflection_at_yield():
    limit = bending.collapse_load(BEAM)
    assert bending.load_at(BEAM, 2.23 * W_YIELD) == pytest.approx(limit, rel=1e-9)
    assert bending.load_at(BEAM, 2.2 * W_YIELD) < limit * (1 - 1e-5)
    assert bending.load_at(HARDENING, 10 * W_YIELD) > 1.1 * limit
    # what the beam cannot carry is refused
    with pytest.raises(ValueError, match="cannot carry a moment"):
        bending.midspan_deflection(BEAM, 1.001 * bending.collapse_load(BEAM))


BASE = paper_impact(2.0)
IMPACT = replace(BASE, sphere=replace(BASE.sphere, mass=200.0))


def test_mode_mass_is_that_of_the_triangle():
    """Integral of mu (x/(L/2))^2 over the beam, and the striker."""
    beam = IMPACT.beam
    half, _ = quad(lambda x: beam.mass_per_length * (2 * x / beam.span) ** 2, 0, beam.span / 2)
    assert bending.mode_mass(IMPACT) == pytest.approx(200 + 2 * half, rel=1e-12)
    # mode leaves the least kinetic energy of the difference
    beam, v = IMPACT.beam, bending.mode_velocity(IMPACT)

    def difference(velocity):
        triangle = beam.mass_per_length * beam.span / 3 * velocity**2
        return 0.5 * (200 * (2.0 - velocity) ** 2 + triangle)

    assert difference(v) < min(difference(v * 1.001), difference(v * 0.999))
    # a constant force brakes it
    w, v, t = (
        getattr(bending, name)(IMPACT)
        for name in ("mode_deflection", "mode_velocity", "mode_duration")
    )
    assert w == pytest.approx(0.5 * v * t, rel=1e-12)
    work = 4 * 345e6 * 0.06 * 0.0278**2 / 4 / 0.78 * w
    assert bending.mode_energy(IMPACT) == pytest.approx(work, rel=1e-12)
    # energy ratio by hand
    load = bending.collapse_load(IMPACT.beam)
    stored = load**2 * 0.78**3 / (96 * 210e9 * 0.06 * 0.0278**3 / 12)
    assert bending.energy_ratio(IMPACT) == pytest.approx(400 / stored, rel=1e-12)
