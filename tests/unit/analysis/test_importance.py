"""Importance sampling: posteriors of known modes, weights and evidence."""

import numpy as np
import pytest
import scipy.special
import scipy.stats

from impactlab.analysis.importance import modes, posterior
from impactlab.analysis.posterior import FEWEST

PLACES = np.array([0.2, 0.8])


def two_normals(deviations, shares, parameters):
    """The logarithm of a mixture of two normal densities, of centres 0.2 and 0.8 on all axes."""

    def log_density(points):
        rows = [
            np.log(share) + scipy.stats.norm(place, deviation).logpdf(points).sum(axis=1)
            for place, deviation, share in zip(PLACES, deviations, shares, strict=True)
        ]
        assert points.shape[1] == parameters
        return scipy.special.logsumexp(rows, axis=0)

    return log_density


@pytest.mark.parametrize("parameters", [1, 2, 5])
@pytest.mark.parametrize(
    ("deviations", "share"), [((0.02, 0.02), 0.5), ((0.05, 0.01), 0.5), ((0.03, 0.01), 0.95)]
)
def test_separate_modes_have_their_weights(parameters, deviations, share):
    shares = (share, 1 - share)
    found = posterior(two_normals(deviations, shares, parameters), parameters, seed=parameters)
    assert found.weights[found.points[:, 0] < 0.5].sum() == pytest.approx(share, abs=0.015)
    assert found.log_evidence == pytest.approx(0.0, abs=0.03)
    assert found.effective > 5000
    for column in found.points.T:
        ranges, weights = zip(*modes(column, found.weights), strict=True)
        assert weights == pytest.approx(shares, abs=0.015)
        wanted = PLACES[:, None] + 1.96 * np.outer(deviations, [-1, 1])
        assert np.array(ranges) == pytest.approx(wanted, abs=0.15 * max(deviations))


def test_a_posterior_too_thin_to_be_covered_has_few_effective_points():
    # a spherical shell in five parameters, 0.001 thick
    found = posterior(lambda x: -0.5 * ((((x - 0.5) ** 2).sum(axis=1) - 0.09) / 1e-3) ** 2, 5, 1)
    assert found.effective < FEWEST


@pytest.mark.parametrize("effective", [1000, 10_000])
def test_a_single_mode_is_not_split(effective):
    rng = np.random.default_rng(1)
    even = np.full(effective, 1.0 / effective)
    for _ in range(20):
        for column in (rng.normal(0.5, 0.1, effective), rng.random(effective)):
            assert len(modes(np.clip(column, 0, 1), even)) == 1
