"""Morris' and Latin hypercube draws, bit by bit against SALib's."""

import numpy as np
import pytest
from SALib.sample import latin, morris

import impactlab as il

SEEDS = (0, 1, 2**32 - 1)


def drawn(sampling):
    runs = il.Study(title="-", function="g", sampling=sampling).design()
    return np.column_stack([runs[name] for name in sampling.parameters])


def drawn_by_salib(sampler, number, size, seed, **options):
    names = [f"x{i + 1}" for i in range(size)]
    groups = options.pop("groups", None)
    problem = {"num_vars": size, "names": names, "bounds": [[0.0, 1.0]] * size, "groups": groups}
    generator = np.random.default_rng(seed)
    sample = sampler.sample(problem, number, seed=generator, **options)
    return np.clip(sample, 2.0**-31, 1 - 2.0**-31)


def uniform(size):
    return {f"x{i + 1}": il.Uniform(0, 1) for i in range(size)}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("size", "samples"), [(1, 64), (3, 1000), (8, 101)])
def test_a_latin_hypercube_has_the_same_bits(seed, size, samples):
    ours = drawn(il.Delta(samples=samples, seed=seed, parameters=uniform(size)))
    np.testing.assert_array_equal(ours, drawn_by_salib(latin, samples, size, seed))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("levels", [2, 4, 10])
@pytest.mark.parametrize("groups", [None, ["a", "b", "a", "c"]])
def test_trajectories_have_the_same_bits(seed, levels, groups):
    members = {"a": ["x1", "x3"], "b": ["x2"], "c": ["x4"]} if groups else {}
    sampling = il.Morris(
        trajectories=20, levels=levels, seed=seed, parameters=uniform(4), groups=members
    )
    theirs = drawn_by_salib(morris, 20, 4, seed, num_levels=levels, groups=groups)
    np.testing.assert_array_equal(drawn(sampling), theirs)
