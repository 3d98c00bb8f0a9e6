"""Load and deflection beyond yield against the closed form and an integral along the beam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from impactlab.model.paper import paper_impact
from impactlab.verification.solutions import bending, static_loading

BEAM = paper_impact().beam
HARDENING = replace(BEAM, material=replace(BEAM.material, kinematic_hardening_modulus=5e9))
AT_YIELD = 4 * bending.yield_moment(BEAM) / BEAM.span
W_YIELD = bending.static_deflection(BEAM, AT_YIELD)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 1.1, 1.3, 1.49, 1.4999])
def test_deflection_is_the_closed_form_without_hardening(ratio):
    """w/w_y = (5 - (3 + p) sqrt(3 - 2 p))/p^2, p = P/P_y: Prager and Hodge."""
    expected = (5 - (3 + ratio) * np.sqrt(3 - 2 * ratio)) / ratio**2 if ratio > 1 else ratio
    deflection = static_loading.midspan_deflection(BEAM, ratio * AT_YIELD)
    assert deflection == pytest.approx(expected * W_YIELD, rel=1e-9)


def test_deflection_is_the_integral_along_a_hardening_beam():
    load = 1.7 * AT_YIELD

    def curvature(x):
        target = load * x / 2
        return brentq(lambda kappa: float(bending.moment(HARDENING, kappa)) - target, 0, 10)

    edge = 2 * bending.yield_moment(BEAM) / load
    expected, _ = quad(lambda x: curvature(x) * x, 0, BEAM.span / 2, points=[edge])
    found = static_loading.midspan_deflection(HARDENING, load)
    assert found == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("beam", [BEAM, HARDENING], ids=["perfect", "hardening"])
@pytest.mark.parametrize("ratio", [0.1, 0.999, 1.001, 1.2, 1.499])
def test_load_is_the_inverse(beam, ratio):
    deflection = static_loading.midspan_deflection(beam, ratio * AT_YIELD)
    assert static_loading.load_at(beam, deflection) == pytest.approx(ratio * AT_YIELD, rel=1e-9)


def test_collapse_begins_at_20_9_of_the_deflection_at_yield():
    collapse = bending.collapse_load(BEAM)
    assert static_loading.load_at(BEAM, 2.23 * W_YIELD) == pytest.approx(collapse, rel=1e-9)
    assert static_loading.load_at(BEAM, 2.2 * W_YIELD) < collapse * (1 - 1e-5)
    assert static_loading.load_at(HARDENING, 10 * W_YIELD) > 1.1 * collapse


def test_missing_work_is_the_area_above_the_curve():
    collapse = bending.collapse_load(BEAM)
    area, _ = quad(
        lambda w: collapse - static_loading.load_at(BEAM, w), 1e-9, 20 / 9 * W_YIELD, limit=200
    )
    assert static_loading.missing_work(BEAM) == pytest.approx(area, rel=1e-5)


def test_what_the_beam_cannot_carry_is_refused():
    with pytest.raises(ValueError, match="cannot carry a moment"):
        static_loading.midspan_deflection(BEAM, 1.001 * bending.collapse_load(BEAM))
    with pytest.raises(ValueError, match="load = 0"):
        static_loading.midspan_deflection(BEAM, 0.0)
    with pytest.raises(ValueError, match="deflection = -1"):
        static_loading.load_at(BEAM, -1.0)
