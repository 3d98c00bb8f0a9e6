"""Hertz's law as a kernel."""

from __future__ import annotations

import pytest

from impactlab.solver.contact import hertz
from impactlab.verification.solutions import hertz as closed_form

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3


@pytest.mark.parametrize("delta", [1e-9, 2e-5, 1e-3])
def test_force_and_a_way_back_that_is_the_way_there(delta):
    F, K, delta_r, n = hertz.curve(delta, E, R, S_y, nu)
    assert closed_form.stiffness(E, R) * delta**1.5 == pytest.approx(F, rel=1e-14)
    assert K * (delta - delta_r) ** n == pytest.approx(F, rel=1e-14)
    assert (delta_r, n) == (0.0, 1.5)


def test_nothing_without_indentation():
    assert hertz.curve(0.0, E, R, S_y, nu)[0] == 0.0
