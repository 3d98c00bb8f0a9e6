"""Timoshenko's example in SI units."""

import pytest

from impactlab.verification.cases import timoshenko_impact


def test_values_are_those_of_the_example_in_si():
    impact = timoshenko_impact()
    assert impact.velocity == 0.01
    assert impact.gravity == 0.0
    assert impact.contact == "hertz"
    assert impact.beam.material.youngs_modulus == pytest.approx(215.75e9, rel=5e-5)
    assert impact.sphere.total_mass == pytest.approx(0.03334, rel=5e-4)
    assert impact.beam.mass_per_length * impact.beam.span == pytest.approx(0.12219, rel=5e-5)
