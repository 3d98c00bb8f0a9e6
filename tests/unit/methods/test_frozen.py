"""Frozen distributions of SciPy are those of the package, and others are named."""

import numpy as np
import pytest
import scipy

import impactlab as il

SHARES = np.array([0.001, 0.2, 0.5, 0.9, 0.999])


@pytest.mark.parametrize(
    "frozen",
    [
        scipy.stats.uniform(1.0, 2.0),
        scipy.stats.loguniform(1.0, 8.0),
        scipy.stats.norm(loc=3.0, scale=0.2),
        scipy.stats.truncnorm(-1.0, 2.0, loc=3.0, scale=0.5),
        scipy.stats.lognorm(0.25, scale=2.0),
        scipy.stats.triang(0.3, 1.0, 2.0),
    ],
    ids=lambda frozen: frozen.dist.name,
)
def test_draws_have_the_quantiles_of_scipy(frozen):
    sampling = il.Latin(samples=64, indices=["delta"], parameters={"velocity": frozen, "a": 1.0})
    entry = sampling.stated()["parameters"]["velocity"]
    kind = {kind.__name__.lower(): kind for kind in (il.Uniform, il.Normal, il.Lognormal)}
    kind |= {"log_uniform": il.LogUniform, "truncated_normal": il.TruncatedNormal}
    kind |= {"triangular": il.Triangular}
    name = entry.pop("distribution")
    np.testing.assert_allclose(kind[name](**entry).quantile(SHARES), frozen.ppf(SHARES), rtol=1e-9)


def test_families_without_a_counterpart_are_named():
    for frozen, reason in (
        (scipy.stats.gamma(2.0), "parameters.velocity is SciPy's gamma, which has no counterpart"),
        (scipy.stats.lognorm(0.2, loc=1.0), "lognorm with loc = 1"),
    ):
        with pytest.raises(ValueError, match=reason):
            il.Delta(samples=64, parameters={"velocity": frozen}).stated()
