"""Elementary effects of functions whose effects are known."""

import numpy as np
import pytest
from SALib.analyze import morris as salib
from SALib.sample import morris as sampler
from scipy.stats import norm

from impactlab.analysis import sensitivity
from impactlab.methods.runs import Sample


def _unit(size, groups=None, number=20):
    names = [f"x{i}" for i in range(size)]
    problem = {"num_vars": size, "names": names, "bounds": [[0, 1]] * size, "groups": groups}
    return sampler.sample(problem, number, num_levels=4, seed=5)


def _runs(drawn, inputs, outputs, **attrs):
    given = {"trajectories": 20, "levels": 4}
    return drawn("morris", inputs, outputs, **(given | attrs))


def test_linear_function_is_exact(drawn):
    unit = _unit(3)
    found = sensitivity.analysis(_runs(drawn, unit, unit @ [3.0, -2.0, 0.0] + 7)).isel(response=0)
    np.testing.assert_allclose(found["morris_mu"], [3, -2, 0], atol=1e-12)
    np.testing.assert_allclose(found["morris_mu_star"], [3, 2, 0], atol=1e-12)
    np.testing.assert_allclose(found["morris_sigma"], 0, atol=1e-12)
    np.testing.assert_allclose(found["morris_mu_star_interval"], 0, atol=1e-12)
    assert found["morris_mu"].dims == ("parameter",)
    assert "units" not in found["morris_mu"].attrs  # those of the response
    assert found["response_units"] == "N"
    # And carry another last digit where they are the same.
    unit = _unit(3)
    physical = 1e9 + 1e8 * norm.ppf(np.clip(unit, 1e-6, 1 - 1e-6))
    physical *= 1 + 1e-16 * np.random.default_rng(1).integers(-2, 3, size=unit.shape)
    runs = _runs(drawn, physical, unit @ [3.0, -2.0, 0.0])
    np.testing.assert_allclose(sensitivity.analysis(runs)["morris_mu"][0], [3, -2, 0], atol=1e-12)
    # groups have no sign
    groups = ["one", "other", "one"]
    unit = _unit(3, groups)
    runs = _runs(drawn, unit, unit @ [3.0, -2.0, 0.0], groups=groups)
    found = sensitivity.analysis(runs).isel(response=0)
    assert found["parameter"].values.tolist() == ["one", "other"]
    np.testing.assert_allclose(found["morris_mu_star"], [3, 2], atol=1e-12)
    np.testing.assert_allclose(found["morris_mu"], [np.nan, -2], atol=1e-12)
    np.testing.assert_allclose(found["morris_sigma"], [np.nan, 0], atol=1e-12)


def test_interaction_shows_in_sigma(drawn):
    """An effect of x0 x1 is the other's value: one of four levels."""
    unit = _unit(3, number=400)
    runs = _runs(drawn, unit, unit[:, 0] * unit[:, 1], trajectories=400)
    found = sensitivity.analysis(runs).isel(response=0)
    np.testing.assert_allclose(found["morris_mu_star"][:2], 0.5, atol=0.06)
    np.testing.assert_allclose(found["morris_sigma"][:2], np.sqrt(5 / 36), atol=0.03)
    assert found["morris_sigma"][2] == 0


@pytest.mark.parametrize("groups", [None, ["one", "other", "one"]])
def test_indices_are_salibs_to_the_last_bit(drawn, ishigami, groups, monkeypatch):
    seeds = lambda *_: np.random.default_rng(3)  # noqa: E731
    monkeypatch.setattr(Sample, "rng", seeds)
    unit = _unit(3, groups, 150)
    outputs = ishigami.of_unit(unit)
    attrs = {"trajectories": 150} | ({"groups": groups} if groups else {})
    runs = _runs(drawn, unit, outputs, **attrs)
    ours = sensitivity.analysis(runs).isel(response=0)
    names = ["x0", "x1", "x2"]
    problem = {"num_vars": 3, "names": names, "groups": groups or names}
    options = {"num_resamples": runs.attrs["resamples"], "seed": seeds()}
    theirs = salib.analyze(problem, unit, outputs, **options)
    np.testing.assert_array_equal(ours["morris_mu_star"], theirs["mu_star"])
    np.testing.assert_array_equal(ours["morris_mu_star_interval"], theirs["mu_star_conf"])
    np.testing.assert_array_equal(ours["morris_sigma"], theirs["sigma"])
    if groups is None:
        np.testing.assert_array_equal(ours["morris_mu"], theirs["mu"])


def test_few_trajectories_of_a_rough_function_are_wide(drawn, verdicts_of, ishigami):
    unit = _unit(3)
    found = sensitivity.analysis(_runs(drawn, unit, ishigami.of_unit(unit)))
    assert verdicts_of(found["sensitivity_verdict"]) == ["wide_intervals"]


def test_refuses_what_is_not_trajectories(drawn):
    unit = _unit(3)
    with pytest.raises(ValueError, match="has 79 runs, but 20 trajectories of 3 steps make 80"):
        sensitivity.analysis(_runs(drawn, unit[1:], unit[1:, 0]))
    rolled = np.roll(unit, 1, axis=0)
    with pytest.raises(ValueError, match="not Morris' trajectories"):
        sensitivity.analysis(_runs(drawn, rolled, rolled[:, 0]))
