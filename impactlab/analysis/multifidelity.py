"""Statistics of a slow model from few of its runs and many of a fast model of the same thing.

A statistic is the mean of a function f of the slow model's output y. A straight line through the
pairs, with the residuals about it, gives from the fast model's output x the expectation g(x) of
f(y). The estimate is the mean of g over all runs of the fast model plus the mean of f - g over the
pairs: a control variate, right whatever g is, and the more accurate the better g predicts.
Gorodetsky and others (2020), J. Comput. Phys. 408, 109257; with f = y it is the regression
estimator of Cochran (1977), Sampling Techniques, section 12.6.

The jackknife over the pairs removes the bias of first order and includes that the line is a fit.
Efron and Tibshirani (1993), An Introduction to the Bootstrap, chapter 11.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its stats and special are loaded when first used

from impactlab.analysis.fidelity_correction import predicted
from impactlab.analysis.fidelity_estimates import (
    FidelityEstimate,
    FidelityPrediction,
    interval_on,
    outputs_of,
    table_of,
)
from impactlab.analysis.multifidelity_distribution import (
    Fit,
    Statistic,
    beyond_limit,
    limits_of,
    line_through,
    outer_quantile,
    parabola_through,
    rising,
    spread,
)
from impactlab.types import Floats

FEWEST_PAIRS = 20
"""Pairs below which no estimate is given."""
FEWEST_EVENTS = 3
"""Pairs beyond a limit, and short of it, below which no probability is given."""
EXPECTED_EVENTS = 6
"""The same, of those that the probability lets expect: fewer bias it by up to a third."""
LEAST_CORRELATION = 0.85
"""Correlation of both models below which no variance is given."""
QUANTILE_EVENTS = 10
"""Pairs expected on either side of a quantile below which it is not given."""
OUTER_EVENTS = 5
"""The same, outside of the quartiles."""
VARIANCE_SAFETY = 1.2  # standard errors of variances of skewed outputs are too small


@dataclass(frozen=True)
class Multifidelity:
    """Mean and variance of a slow model, and its probability beyond a limit, by a fast model.

    Parameters
    ----------
    low : array_like
        Outputs of the fast model, (low runs,), of independently drawn parameters. The first of
        them are at the parameters of the slow model's runs.
    high : array_like
        Outputs of the slow model, (high runs,), at least 20.
    confidence : float, default 0.95
        Of the intervals.
    inputs : array_like, optional
        Parameters of the slow model's runs, (high runs, parameters): `prediction` needs them.

    Raises
    ------
    ValueError
        If there are too few runs, a run has no answer, or outputs do not vary.

    Notes
    -----
    Over 400 repetitions of 40 pairs of Ishigami's function and a copy of correlation 0.5, 0.9 and
    0.99, none of which the rules were chosen on, intervals of 95 % hold the mean in 95 to 97 %, a
    probability of 0.45 in 95 to 97 %, and one of 0.31 in 96 to 98 %. At 0.20, where 8 pairs are
    expected beyond the limit, up to a fifth of the samples are refused; those that are not give 3
    to 14 % too much, and intervals hold in 96 to 98 %. Those of the variance hold in 95 to 100 %,
    of 20 to 100 pairs of normal, parabolic and Ishigami's outputs, with correlations of 0.88 and
    more; where the slow output is an exponential of the fast one, or both are log-normal, in 89 to
    100 % for coefficients of variation of 0.53 to 0.25, and in 85 to 91 % where it is a cubic with
    long tails. Near 0.85, where many samples are refused, the others are up to 9 % off. Means of
    exponentials hold in 91 to 97 %. Those of median and quartiles hold in 93 to 98 %, of 40 to 100
    pairs, those of outer quantiles in 93 to 100 % (92 to 97 % with errors that grow with the
    output). With pairs allocated by 20 pilot ones for a budget, those of Ishigami's function hold
    in 94 to 98 %. Draws have to be independent, as those of `Sobol` and `Latin` are not.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.random.default_rng(1).normal(size=4000)
    >>> low, high = 1.2 * x + 0.3, x[:40] + 0.05 * x[:40] ** 2
    >>> models = il.Multifidelity(low=low, high=high)
    >>> mean = models.mean()
    >>> mean.saving > 20
    True
    >>> models.low_runs_per_high_run(cost_ratio=1000) > 100
    True
    """

    low: Any
    high: Any
    confidence: float = 0.95
    inputs: Any = None

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            object.__setattr__(self, name, outputs_of(name, getattr(self, name)))
        runs = self.high.size
        if runs < FEWEST_PAIRS:
            raise ValueError(f"Multifidelity.high: has {runs} runs: at least {FEWEST_PAIRS}")
        if self.low.size < 2 * runs:
            raise ValueError(
                f"Multifidelity.low: has {self.low.size} runs: at least twice the {runs} of high"
            )
        if np.ptp(self.low[:runs]) == 0.0 or np.ptp(self.high) == 0.0:
            raise ValueError("Multifidelity: outputs that do not vary have no correlation")
        if not 0.0 < self.confidence < 1.0:
            raise ValueError(f"Multifidelity.confidence = {self.confidence}: must be in (0, 1)")
        if self.inputs is not None:
            inputs = table_of("inputs", self.inputs, runs)
            object.__setattr__(self, "inputs", inputs)

    @property
    def correlation(self) -> float:
        """Return the correlation of both models in the pairs.

        Returns
        -------
        float
            From -1 to 1.
        """
        return float(np.corrcoef(self.low[: self.high.size], self.high)[0, 1])

    def low_runs_per_high_run(self, cost_ratio: float) -> float:
        """Return the number that gives the mean the least variance for a budget.

        Peherstorfer, Willcox and Gunzburger (2016), SIAM J. Sci. Comput. 38, A3163.

        Parameters
        ----------
        cost_ratio : float
            Cost of a slow run over that of a fast one.

        Returns
        -------
        float
            Fast runs per slow run, at least 1.

        Raises
        ------
        ValueError
            If the ratio is not positive.
        """
        if not (np.isfinite(cost_ratio) and cost_ratio > 0.0):
            raise ValueError(f"Multifidelity: cost_ratio = {cost_ratio}: must be positive")
        return best_ratio(self.correlation, cost_ratio)

    def mean(self) -> FidelityEstimate:
        """Return the mean of the slow model.

        Returns
        -------
        FidelityEstimate
            In the unit of the output.
        """
        return self._estimate(lambda line, every, errors, high: (every, high, line))

    def variance(self) -> FidelityEstimate:
        """Return the variance of the slow model, interval even in its logarithm.

        It is that about a parabola in the fast output, and its interval as wide as that about a
        line, if that is wider: slow outputs that bend would be covered too seldom.

        Returns
        -------
        FidelityEstimate
            In the square of the unit of the output.

        Raises
        ------
        ValueError
            If the models correlate by less than 0.85: the fast one then hardly saves a run, and
            intervals of skewed outputs are too narrow.
        """
        if abs(self.correlation) < LEAST_CORRELATION:
            raise ValueError(
                f"Multifidelity.variance: the models correlate by {self.correlation:.2f}: below "
                f"{LEAST_CORRELATION} in size the runs of high alone do as well"
            )

        def squares(
            line: Floats, every: Floats, errors: Floats, high: Floats
        ) -> tuple[Floats, Floats, Floats]:
            mean, about = every.mean(), spread(errors) ** 2
            return (every - mean) ** 2 + about, (high - mean) ** 2, (line - mean) ** 2 + about

        settings = squares, np.log, np.exp
        line = self._estimate(*settings, safety=VARIANCE_SAFETY)
        curve = self._estimate(*settings, safety=VARIANCE_SAFETY, fit=parabola_through)
        half = max(np.diff(np.log(fit.interval)).item() / 2 for fit in (line, curve))
        middle = np.log(curve.interval).mean()
        interval = float(np.exp(middle - half)), float(np.exp(middle + half))
        error = max(line.standard_error, curve.standard_error)
        return FidelityEstimate(curve.value, error, interval, line.plain_error)

    def exceedance(self, limit: float) -> FidelityEstimate:
        """Return the probability that the slow model exceeds the limit, interval even in its logit.

        Parameters
        ----------
        limit : float
            In the unit of the output.

        Returns
        -------
        FidelityEstimate
            From 0 to 1.

        Raises
        ------
        ValueError
            If fewer than three of the pairs are on one side of the limit, or the probability is so
            near 0 or 1 that fewer than six are expected there.
        """
        if not np.isfinite(limit):
            raise ValueError(f"Multifidelity.exceedance: limit = {limit}: must be a number")
        beyond = int(np.sum(self.high > limit))
        if min(beyond, self.high.size - beyond) < FEWEST_EVENTS:
            raise ValueError(
                f"Multifidelity.exceedance: limit = {limit:g}: {beyond} of {self.high.size} runs "
                f"of high exceed it: at least {FEWEST_EVENTS} must, and as many must not"
            )

        estimate = self._estimate(beyond_limit(limit), scipy.special.logit, scipy.special.expit)
        # by runs of low above all, so that it hardly selects among samples
        expected = min(estimate.value, 1.0 - estimate.value) * self.high.size
        if expected < EXPECTED_EVENTS:
            raise ValueError(
                f"Multifidelity.exceedance: limit = {limit:g}: {expected:.1f} of {self.high.size} "
                f"runs of high are expected on one side, {EXPECTED_EVENTS} are needed: add runs"
            )
        return estimate

    def quantile(self, probability: float) -> FidelityEstimate:
        """Return the output that a run stays below with a probability, interval by inversion.

        The interval of the distribution function there is read off it: Woodruff (1952), J. Am.
        Stat. Assoc. 47, 635 (recalled, not read).

        Parameters
        ----------
        probability : float
            From 0.05 to 0.95: 0.5 for the median.

        Returns
        -------
        FidelityEstimate
            In the unit of the output.

        Raises
        ------
        ValueError
            If the probability is out of range, or fewer than ten pairs are expected on one side
            (outside of the quartiles: five).
        """
        owner = f"Multifidelity.quantile: probability = {probability!r}"
        if not 0.05 <= probability <= 0.95:
            raise ValueError(f"{owner}: must be from 0.05 to 0.95, where intervals are sound")
        is_outer = not 0.25 <= probability <= 0.75
        needed = OUTER_EVENTS if is_outer else QUANTILE_EVENTS
        expected = min(probability, 1.0 - probability) * self.high.size
        if expected < needed - 1e-9:  # 1 - 0.9 is less than 0.1 in floating point
            raise ValueError(
                f"{owner}: {expected:.3g} of {self.high.size} runs of high are expected on one "
                f"side, {needed} are needed: add runs"
            )
        line, every, errors = line_through(self.low[: self.high.size], self.high, self.low)
        if is_outer:
            settings = probability, self.confidence
            return FidelityEstimate(*outer_quantile(line, every, errors, self.high, *settings))
        limits = limits_of(every, self.high, spread(errors))
        below = np.empty(limits.size)
        for row, limit in enumerate(limits):
            shares, values, pairs = beyond_limit(limit)(line, every, errors, self.high)
            below[row] = 1.0 - shares.mean() - (values - pairs).mean()
        below = rising(below)
        value = float(np.interp(probability, below, limits))
        share = self._estimate(beyond_limit(value), scipy.special.logit, scipy.special.expit)
        width = np.diff(scipy.special.logit(share.interval)).item() / 2
        centre = scipy.special.logit(probability)
        ends = scipy.special.expit([centre - width, centre + width])
        low, high = np.interp(ends, below, limits).tolist()
        slope = (high - low) / np.diff(ends).item()
        return FidelityEstimate(
            value, slope * share.standard_error, (low, high), slope * share.plain_error
        )

    def prediction(self, points: Any, low: Any) -> FidelityPrediction:
        """Return the slow model's answers at points, from the fast model's there.

        Line and Gaussian process through the pairs, with intervals that their misses of left-out
        pairs tell. It needs scikit-learn (``pip install 'impactlab[kriging]'``).

        Parameters
        ----------
        points : array_like
            Parameters, (points, parameters), as in `inputs`.
        low : array_like
            Outputs of the fast model there, (points,).

        Returns
        -------
        FidelityPrediction
            In the unit of the output, NaN beyond the pairs' range of a parameter or fast output.

        Raises
        ------
        ValueError
            If there are no `inputs`, too few pairs for the confidence, or shapes differ.
        OSError
            If scikit-learn is not installed.

        Notes
        -----
        Over 200 repetitions with 20, 40 and 80 pairs of Ishigami's function (correlations of 0.5 to
        0.99), linear, bent, g- and exponential functions of the fast output, of one, three and six
        inputs, intervals of 95 % hold answers at drawn points in 97 to 100 %, and those within 5 %
        of the ends of an input's range in 93 to 100 %; of a slow model with noise, even or growing,
        in 95 to 97 and 97 to 100 %. For smooth models their width is at most 0.2 of that about fast
        outputs corrected by a constant, and below that of the slow runs alone but for smooth models
        of one input or a slight bend. With noise it is 1 to 1.3 of that of the constant correction.
        Anywhere in the ranges of 40 pairs intervals hold in 97 to 100 %, but beyond their fast
        outputs, where there is no prediction, in 59 to 100 %.

        Examples
        --------
        >>> import numpy as np
        >>> x = np.random.default_rng(1).uniform(size=(200, 2))
        >>> low, inputs = x.sum(axis=1), x[:40]
        >>> models = il.Multifidelity(low=low, high=low[:40] + 0.1 * inputs[:, 0], inputs=inputs)
        >>> answer = models.prediction([[0.5, 0.5], [0.5, 2.0]], low=[1.0, 2.5])
        >>> bool(answer.low[0] <= 1.05 <= answer.high[0]), answer.refusal[1]
        (True, 'parameter 2 is beyond those of the pairs')
        """
        owner = "Multifidelity.prediction"
        if self.inputs is None:
            raise ValueError(f"{owner}: state the `inputs` of the pairs")
        fast = outputs_of("prediction: low", low)
        points = table_of("prediction: points", points, fast.size, self.inputs.shape[1])
        return predicted(owner, self.inputs, self.low, self.high, points, fast, self.confidence)

    def _estimate(
        self,
        function: Statistic,
        *scale: Callable[[Floats], Floats],
        safety: float = 1.0,
        fit: Fit = line_through,
    ) -> FidelityEstimate:
        """Return the mean of a function of the output, from pseudo-values of the pairs.

        function: from the line at the pairs and at every low output, the errors about it and the
        outputs: what is expected of every low output, the values of the pairs, and what of them.
        scale: that on which the interval is even, and its inverse. safety: factor of the error.
        fit: the line, or a curve.
        """

        def statistic(low: Floats, high: Floats) -> tuple[float, Floats, Floats]:
            expected, values, pairs = function(*fit(low, high, self.low), high)
            return float(expected.mean() + (values - pairs).mean()), expected, values

        high, runs = self.high, self.high.size
        low = self.low[:runs]
        value, expected, values = statistic(low, high)
        others = [statistic(np.delete(low, i), np.delete(high, i))[0] for i in range(runs)]
        pseudo = runs * value - (runs - 1) * np.array(others)
        variances = np.array([pseudo.var(ddof=1) / runs, expected.var(ddof=1) / self.low.size])
        error = safety * float(np.sqrt(variances.sum()))
        # Welch and Satterthwaite's number. The line takes two degrees of freedom; the error of what
        # is not linear in the output is less certain, and half as many let its intervals cover.
        pairs = runs // 2 - 1 if scale else runs - 2
        freedom = variances.sum() ** 2 / (variances**2 / [pairs, self.low.size - 1]).sum()
        factor = scipy.stats.t.ppf(0.5 + self.confidence / 2, freedom)
        estimate = float(pseudo.mean())
        plain = float(np.sqrt(values.var(ddof=1) / runs))
        return FidelityEstimate(
            estimate, error, interval_on(scale, estimate, factor * error), plain
        )


def best_ratio(correlation: float, cost_ratio: float) -> float:
    """Return fast runs per slow run, at least 1, that serve the mean best for a budget."""
    square = correlation**2
    return max(1.0, float(np.sqrt(cost_ratio * square / max(1.0 - square, 1e-12))))
