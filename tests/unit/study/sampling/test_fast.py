from __future__ import annotations

import numpy as np
import pytest


def spectra(draws):
    """Magnitudes of each parameter's frequencies along a curve: (frequency, parameter)."""
    return np.abs(np.fft.rfft(draws - draws.mean(axis=0), axis=0))


@pytest.mark.parametrize(("samples", "harmonics"), [(257, 4), (513, 6)])
def test_each_parameter_has_the_high_frequency_in_its_curve_alone(
    sampled, cube, samples, harmonics
):
    """Saltelli, Tarantola and Chan (1999): the others keep below 1/(2 M) of it."""
    draws = cube(sampled("fast", samples=samples, harmonics=harmonics))
    high = (samples - 1) // (2 * harmonics)
    curves = np.split(draws, 4)
    for at, curve in enumerate(curves):
        loudest = spectra(curve).argmax(axis=0)
        for parameter, frequency in enumerate(loudest):
            if parameter == at:
                assert frequency == high
            else:
                assert frequency <= high // (2 * harmonics)


def test_the_last_curve_is_that_of_a_dummy(sampled, cube):
    """In it no parameter has the high frequency, so that what is found there is noise."""
    curves = np.split(cube(sampled("fast", samples=257)), 4)
    assert (spectra(curves[3]).argmax(axis=0) <= 4).all()
    assert [spectra(curve).argmax(axis=0).max() for curve in curves[:3]] == [32] * 3


def test_each_curve_fills_the_ranges_evenly(sampled, cube):
    for curve in np.split(cube(sampled("fast", samples=1025)), 4):
        for column in curve.T:
            counts, _ = np.histogram(column, bins=8, range=(0, 1))
            assert counts.min() > 0.8 * 1025 / 8
