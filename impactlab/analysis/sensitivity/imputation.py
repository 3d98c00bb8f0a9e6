"""Values that a surrogate supplies where runs failed, and what it misses there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impactlab.analysis.surrogate.chaos import drawn, fewest_runs
from impactlab.analysis.surrogate.from_runs import GOOD, Divided
from impactlab.methods.runs import Sample, correlations
from impactlab.methods.verdict import SensitivityVerdict
from impactlab.types import Floats

MOST_IMPUTED = 0.2  # largest share of runs that may be supplied
FEWEST_PER_PARAMETER = 10  # good runs that a surrogate needs per parameter
_FEWEST_TESTS = 20
_AT_ONCE = 100_000  # runs that are predicted together


@dataclass(frozen=True)
class Imputation:
    """Outputs (runs,), complete unless the study wants none supplied or there is a refusal.

    share: of runs whose value a surrogate supplied. missed: the share of the variance that this
    surrogate misses, near the failed runs or elsewhere, whichever is more.
    """

    outputs: Floats
    refusal: SensitivityVerdict | None = None
    share: float = 0.0
    missed: float = 0.0

    @property
    def half_width(self) -> float:
        """Part of the half-width of an index that is a share, for the errors of supplied values.

        By the inequality of Cauchy and Schwarz, an index changes in proportion to the root of the
        variance of these errors over all runs.
        """
        return float(np.sqrt(self.share * self.missed))


def imputed(outputs: Floats, sample: Sample, response: str) -> Imputation:
    """Return outputs (runs,) with a surrogate's predictions in the place of NaN.

    They are returned as they are where none is NaN or the study does not ask for it
    (`failed_runs: impute`), and where too few runs are left or the surrogate misses more than a
    tenth of the variance. A mean would take away variance.
    """
    gaps = np.isnan(outputs)
    if not gaps.any() or sample.settings.get("failed_runs") != "impute":
        return Imputation(outputs)
    if sample.words or correlations(sample.runs):
        kind = f"words ({', '.join(sample.words)})" if sample.words else "correlated parameters"
        raise ValueError(
            f"{sample.study}: no surrogate is fitted over {kind}, so it cannot supply "
            "values: set failed_runs: fail"
        )
    parameters, number = len(sample.parameters), int(np.count_nonzero(~gaps))
    share = float(gaps.mean())
    if number < FEWEST_PER_PARAMETER * parameters or share > MOST_IMPUTED:
        return Imputation(outputs, SensitivityVerdict.TOO_FEW_RUNS)
    seed = int(sample.rng("surrogate", response).integers(1, 2**31))
    divided = Divided.of(sample.runs)
    tests = _tests(gaps, divided, seed)
    training = ~gaps
    training[np.concatenate(tests)] = False
    if np.count_nonzero(training) < fewest_runs(parameters):
        return Imputation(outputs, SensitivityVerdict.TOO_FEW_RUNS)
    chaos, _ = divided.fit(outputs, training, seed)
    variance = float(np.var(outputs[~gaps]))
    square = max(float(np.mean((chaos(divided.inputs(t)) - outputs[t]) ** 2)) for t in tests)
    missed = square / variance if variance > 0 else 0.0
    if not missed <= 1 - GOOD:
        return Imputation(outputs, SensitivityVerdict.POOR_SURROGATE)
    chaos, _ = divided.fit(outputs, ~gaps, seed)
    filled, failed = outputs.copy(), np.flatnonzero(gaps)
    for start in range(0, failed.size, _AT_ONCE):
        rows = failed[start : start + _AT_ONCE]
        filled[rows] = chaos(sample.rows(rows))
    return Imputation(filled, None, share, missed)


def _tests(gaps: NDArray[np.bool_], divided: Divided, seed: int) -> list[NDArray[np.int64]]:
    """Return positions of runs to test a surrogate on: those most like the failed, and a part.

    A surrogate reaches into a region where every run fails from outside of it. So do tests on runs
    at its rim, as many as failed: those for which a chaos of the failures predicts most.
    """
    rim, _ = divided.fit(gaps.astype(float), np.ones(gaps.size, bool), seed)
    good = np.flatnonzero(~gaps)
    good = np.random.default_rng(seed).permutation(good)[: drawn(good.size, seed).size]
    count = max(_FEWEST_TESTS, round(good.size * float(gaps.mean())))
    nearest = np.argsort(-rim(divided.inputs(good)), kind="stable")[:count]
    part = np.flatnonzero(~gaps & (divided.part == 0))
    return [np.sort(good[nearest]), part[drawn(part.size, seed)]]
