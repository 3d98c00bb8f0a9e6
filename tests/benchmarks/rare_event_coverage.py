"""Coverage of probabilities of rare events over seeds, on limit states with exact ones.

    python rare_event_coverage.py CASE [SEEDS] [--surrogate]

A line per case: coverage of the 95 % interval, sound verdicts, coefficients of variation stated
(mean, largest) and true, and runs (mean, largest).
"""

import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2, norm

from impactlab.analysis.limit_state import learned_estimate
from impactlab.analysis.rare_event import Runs, estimate


class Case(NamedTuple):
    """A limit state of standard normal scores, its number of parameters, limit and probability."""

    response: Runs
    parameters: int
    limit: float
    probability: float


def plane(parameters: int, probability: float) -> Case:
    """Return a plane that all parameters move alike."""
    return Case(
        lambda scores: scores.sum(axis=1) / np.sqrt(parameters),
        parameters, norm.isf(probability), probability,
    )  # fmt: skip


def opposite(parameters: int) -> Case:
    """Return two regions on opposite sides, of 1.3e-5 and 5.4e-6."""
    direction = np.ones(parameters) / np.sqrt(parameters)
    ends = 4.2, 4.4

    def response(scores):
        along = scores @ direction
        return np.maximum(along / ends[0], -along / ends[1])

    return Case(response, parameters, 1.0, float(norm.sf(ends).sum()))


CASES: dict[str, Callable[[], Case]] = {
    "plane8": lambda: plane(8, 1e-5),
    "plane20": lambda: plane(20, 1e-5),
    "plane40": lambda: plane(40, 1e-5),
    "opposite6": lambda: opposite(6),
    "ring3": lambda: Case(lambda u: (u**2).sum(axis=1), 3, chi2.isf(1e-3, 3), 1e-3),
}


def measure(name: str, seeds: int, surrogate: bool) -> str:
    """Return the line of a case."""
    case, results = CASES[name](), []
    samples = max(500, 25 * case.parameters)
    settings = {"most": max(6000, 10 * samples), "target": 0.1, "confidence": 0.95}
    for seed in range(1000, 1000 + seeds):
        event = case.response, case.parameters, case.limit
        results.append(
            learned_estimate(*event, seed=seed, **settings)
            if surrogate
            else estimate(*event, seed=seed, samples=samples, **settings)
        )
    covered = [result.low <= case.probability <= result.high for result in results]
    stated = [result.coefficient_of_variation for result in results]
    values = np.array([result.probability for result in results]) / case.probability
    runs = [result.runs for result in results]
    verdicts = [result.verdict.name for result in results]
    counts = {kind: verdicts.count(kind) for kind in sorted(set(verdicts))}
    return (
        f"{name}: {np.mean(covered):.3f} of {seeds}, sound "
        f"{sum(result.verdict.sound for result in results)} {counts}, stated "
        f"{np.nanmean(stated):.3f} {np.nanmax(stated):.3f}, true {np.nanstd(values):.3f}, mean "
        f"{np.nanmean(values):.3f}, runs {np.mean(runs):.0f} {max(runs)}"
    )


if __name__ == "__main__":
    names = [name for name in sys.argv[1:] if name in CASES] or [*CASES]
    seeds = next((int(word) for word in sys.argv[1:] if word.isdecimal()), 100)
    for name in names:
        print(measure(name, seeds, "--surrogate" in sys.argv), flush=True)
