"""Contacts and peaks between steps."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.fem3d.solver.responses import contacts, peak


def test_start_and_end_between_steps_and_short_pauses_do_not_count():
    time = np.arange(0.0, 10.0, 0.1)
    force = np.maximum(3.03 - time, 0.0) + np.where(time > 6.0, np.maximum(8.07 - time, 0.0), 0.0)
    force[12] = 0.0
    found = contacts(time, force, 0.5)
    np.testing.assert_allclose(found, [[0.0, 3.03], [6.1, 8.07]], atol=1e-9)


def test_a_contact_at_the_end_has_no_end():
    time = np.arange(0.0, 1.0, 0.1)
    assert np.isnan(contacts(time, np.ones(10), 0.25)[0, 1])
    force = np.where(time < 0.85, 1.0, 0.0)
    assert np.isnan(contacts(time, force, 0.25)[0, 1])


def test_no_contact():
    assert contacts(np.arange(3.0), np.zeros(3), 1.0).shape == (0, 2)


def test_a_parabolas_peak_is_exact_between_steps():
    time = np.linspace(0.0, 1.0, 12)
    at, largest = peak(time, 5.0 - 3.0 * (time - 0.337) ** 2)
    assert at == pytest.approx(0.337, rel=1e-12)
    assert largest == pytest.approx(5.0, rel=1e-12)
    assert peak(time, time) == (1.0, 1.0)
