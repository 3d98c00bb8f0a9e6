"""Rates of false alarms, and of detection, of regimes in responses.

    python tests/benchmarks/regimes.py [SEEDS]

One row per response and one column per number of draws, with the share of seeds in which more than
one regime is detected, or, of a mixture of two, exactly two. Gaps are in widths of one regime.
"""

from __future__ import annotations

import sys

import numpy as np
from functions import g, ishigami

from impactlab.analysis.regimes import cuts

SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 200
SIZES = (64, 128, 256, 512, 1024, 2048)


def smooth(function, parameters=1):
    """Return draws of a function of the unit cube."""
    return lambda rng, size: function(rng.random((size, parameters)))


ONE = {
    "normal": lambda rng, size: rng.normal(size=size),
    "Student's t of 3": lambda rng, size: rng.standard_t(3, size),
    "lognormal, 0.5": lambda rng, size: np.exp(0.5 * rng.normal(size=size)),
    "lognormal, 2": lambda rng, size: np.exp(2 * rng.normal(size=size)),
    "gamma of 0.1": lambda rng, size: rng.gamma(0.1, size=size),
    "two modes 5 deviations apart": lambda rng, size: (
        5 * (rng.random(size) < 0.1) + rng.normal(size=size)
    ),
    "uniform": smooth(lambda x: x[:, 0]),
    "sum of 3": smooth(lambda x: x @ [4, 2, 1], 3),
    "sum of 8": smooth(lambda x: x @ np.arange(1, 9), 8),
    "product of 4": smooth(lambda x: x.prod(axis=1), 4),
    "Ishigami": smooth(ishigami("x0", "x1", "x2").function, 3),
    "G of 5": smooth(g(0, 0.5, 3, 9, 99).function, 5),
    "G of 3, all alike": smooth(g(0, 0, 0).function, 3),
    "sine": smooth(lambda x: np.sin(2 * np.pi * x[:, 0])),
    "square": smooth(lambda x: (x[:, 0] - 0.3) ** 2),
    "tenth power": smooth(lambda x: x[:, 0] ** 10),
    "pole": smooth(lambda x: 1 / (0.01 + x[:, 0])),
    "zero, then a root": smooth(lambda x: np.sqrt(np.maximum(x[:, 0] - 0.3, 0))),
    "zero, then a root, and a sum": smooth(
        lambda x: np.sqrt(np.maximum(x[:, 0] - 0.3, 0)) + 0.05 * x[:, 1], 2
    ),
    "steep rise": smooth(lambda x: 1 / (1 + np.exp(-20 * (x[:, 0] - 0.5)))),
}


def mixture(share, gap):
    """Return draws of a step of one parameter plus another parameter."""
    return smooth(lambda x: (1 + gap) * (x[:, 0] < share) + x[:, 1], 2)


def main():
    """Print the rates."""
    cases = {name: (draw, lambda number: number > 0) for name, draw in ONE.items()}
    for share in (0.05, 0.1, 0.2, 0.5):
        for gap in (1, 2, 5):
            name = f"{share:.0%} of the draws, gap {gap}"
            cases[name] = mixture(share, gap), lambda number: number == 1
    print(f"{'':30}", *(f"{size:5}" for size in SIZES))
    for name, (draw, is_hit) in cases.items():
        rates = [
            np.mean([is_hit(cuts(draw(np.random.default_rng(s), size)).size) for s in range(SEEDS)])
            for size in SIZES
        ]
        print(f"{name:30}", *(f"{rate:5.3f}" for rate in rates), flush=True)


if __name__ == "__main__":
    main()
