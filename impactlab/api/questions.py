"""Questions to a study that need runs of their own: rare events, designs, two models."""

from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from impactlab.api.definition import Study
from impactlab.api.folder import CORES, local_engine
from impactlab.model.quantities import Quantity, si


def rare_event(
    study: Study,
    *,
    samples: int = 500,
    runs: int = 6000,
    coefficient_of_variation: float = 0.1,
    surrogate: bool = False,
    workers: int = CORES,
) -> xr.Dataset:
    """Estimate the small probability that a response exceeds its limit, and the likeliest way.

    Importance sampling by cross-entropy: samples of the solver move towards the limit, and a last
    one gives the estimate (docs/sensitivity.md). With `surrogate`, a Gaussian process places the
    runs, of which a smooth response then takes a tenth. The runs are kept in the study's folder:
    the same call resumes where it stopped.

    Parameters
    ----------
    study : Study
        Sample of any method, of which the distributions and the seed count, with one limit.
    samples : int, default 500
        Number of runs per level, at least 200, and 25 per parameter that varies.
    runs : int, default 6000
        Largest number of all runs, at least 4 `samples`; with `surrogate`, at least 300.
    coefficient_of_variation : float, default 0.1
        Standard error to reach over the probability, from 0.01 to 0.5.
    surrogate : bool, default False
        True to let a Gaussian process place the runs, which needs scikit-learn
        (``pip install 'impactlab[kriging]'``); `samples` is not used then.
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        Numbers `probability`, `low`, `high`, `coefficient_of_variation`, `verdict` and others;
        `design_point` on `parameter` in standard normal scores; the attribute `answer` holds the
        findings in sentences. They are kept in the study's folder as rare_event.nc, with the report
        rare_event.html.

    Raises
    ------
    StudyError
        If the study has no sample, or not one limit.
    ValueError
        If a setting is out of range, or another study has results of this name.
    OSError
        If scikit-learn is needed and not installed.

    References
    ----------
    Rubinstein (1999), Methodol. Comput. Appl. Probab. 1, 127; Kurtz and Song (2013), Struct. Saf.
    42, 35; with `surrogate`: Echard, Gayton and Lemaire (2011), Struct. Saf. 33, 145; Dubourg,
    Sudret and Deheeger (2013), Probab. Eng. Mech. 33, 47 (all recalled, not read).

    Examples
    --------
    >>> study = il.Study(
    ...     title="Load", function=lambda load, strength: load - strength, limits={"value": 0},
    ...     sampling=il.Pawn(samples=128, parameters={
    ...         "load": il.Normal(5, 1), "strength": il.Normal(11, 1)}))
    >>> rare = il.rare_event(study, workers=1)  # exactly 1.1e-5
    >>> bool(rare.low < 1.1e-5 < rare.high)
    True
    """
    from impactlab.report.questions import report_rare_event
    from impactlab.study.rare_event import rare_event as probability

    engine = local_engine(workers)
    settings = samples, runs, coefficient_of_variation
    result = probability(study.declared, study.folder, engine, *settings, surrogate=surrogate)
    report_rare_event(result, study.folder)
    return result


def size(
    study: Study,
    variables: Sequence[str],
    *,
    probability: float,
    minimise: str = "mass",
    maximise: str = "",
    samples: int = 500,
    runs: int = 6000,
    coefficient_of_variation: float = 0.1,
    workers: int = CORES,
) -> xr.Dataset:
    """Choose the values of parameters so that a response seldom exceeds its limit.

    Of all values of the design variables, of which the study states ranges, this finds the ones
    with the lightest beam (or the least or greatest value of one of them) for which the probability
    is small enough, and confirms them by runs (docs/sensitivity.md), which the same call resumes.

    Parameters
    ----------
    study : Study
        Sample of any method with one limit. The distributions of the design variables are
        `Uniform` or `LogUniform`, and state their ranges.
    variables : sequence of str
        Names of the design variables, one or two.
    probability : float
        Largest probability wanted, from 1e-6 to 0.3.
    minimise : str, default "mass"
        Mass of the beam, or a design variable.
    maximise : str, optional
        Design variable that is to be large instead.
    samples : int, default 500
        Number of runs per level of each estimate, at least 200, and 25 per parameter that scatters.
    runs : int, default 6000
        Largest number of runs of an estimate, at least 4 `samples`.
    coefficient_of_variation : float, default 0.1
        Standard error to reach over the probability, from 0.01 to 0.5.
    workers : int, optional
        Number of threads; all cores by default.

    Returns
    -------
    xarray.Dataset
        Design variables, `objective` and its interval, `probability` there, the front, all designs
        tried, `verdict`, the attribute `answer`. Kept as sizing.nc, with the report sizing.html.

    Raises
    ------
    StudyError
        If the study has no sample, or not one limit.
    ValueError
        If a variable has no range or correlates, a setting is out of range, or the name is taken.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Rod", function=lambda load, strength, area: load / area - strength,
    ...     limits={"value": 0}, sampling=il.Pawn(samples=128, parameters={
    ...         "load": il.Normal(5, 1), "strength": il.Normal(6, 0.5), "area": il.Uniform(1, 3)}))
    >>> design = il.size(study, ["area"], probability=1e-3, minimise="area", workers=1)
    >>> bool(1.477 <= design.area[0] < 1.03 * 1.477)  # 1.477 is exact
    True
    """
    from impactlab.report.questions import report_sizing
    from impactlab.study.sizing import sizing

    result = sizing(
        study.declared,
        study.folder,
        local_engine(workers),
        list(variables),
        probability,
        minimise=minimise,
        maximise=maximise,
        samples=samples,
        runs=runs,
        target=coefficient_of_variation,
    )
    report_sizing(result, study.folder)
    return result


def multifidelity(
    study: Study,
    high: Mapping[str, Any] | None = None,
    *,
    pairs: int = 40,
    runs: int = 0,
    budget: Quantity = 0.0,
    indices: bool = False,
    predict: Mapping[str, Any] | None = None,
    workers: int = CORES,
) -> xr.Dataset:
    """Estimate statistics of a slow model from few of its runs and many of the study's model.

    Both have the distributions of the study (docs/sensitivity.md); see `Multifidelity` for outputs
    of models of one's own. The runs are kept in the study's folder: the same call resumes where it
    stopped.

    Parameters
    ----------
    study : Study
        Sample of any method, of which the distributions, the seed, responses and limits count.
    high : mapping of str to Quantity, optional
        Values of the slow model's parameters in place of the study's, such as
        `{"beam_model": "solid", "elements_per_radius": 2}`; by default all settings are those that
        the study states (docs/studies.md).
    pairs : int, default 40
        Number of runs of the slow model, at least 20.
    runs : int, default 0
        Number of runs of the study's model; 0: the best for the costs and correlations of the
        pairs.
    budget : Quantity, default 0
        Time of one core, in s, in place of `pairs`: 20 pairs tell how many it pays for.
    indices : bool, default False
        True for Sobol indices of the slow model, too: they take 2,048 further runs of the study's
        model per parameter, and more.
    predict : mapping of str to Quantity or list of Quantity, optional
        Values of drawn parameters, such as `{"velocity": [5, 10], "beam_depth": "27 mm"}`, at which
        the slow model's answers are predicted from one run of the study's model each; lists have
        one length, and other parameters lie at their medians. It needs scikit-learn
        (``pip install 'impactlab[kriging]'``).
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        `estimate` on (response, statistic, bound), `saving`, `correlation`, costs, `verdict` and
        the pairs; with `indices`, `slow_index` on (response, order, parameter, bound); with
        `predict`, `prediction` on (response, point, bound), NaN beyond the pairs, for the reason in
        `prediction_refusal`; the attribute `answer` holds the findings in sentences. They are kept
        in the study's folder as multifidelity.nc, with the report multifidelity.html.

    Raises
    ------
    StudyError
        If the study has no sample, or cannot have these values.
    ValueError
        If a setting is out of range, or another study has results of this name.
    OSError
        If scikit-learn is needed and not installed.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Power", function=lambda x, power: (1 + x) ** power, limits={"value": 3},
    ...     sampling=il.Pawn(samples=128, parameters={"x": il.Uniform(0, 1), "power": 1}))
    >>> both = il.multifidelity(study, {"power": 2}, runs=2000, predict={"x": 0.5}, workers=1)
    >>> mean = both.estimate.sel(response="value", statistic="mean")
    >>> bool(mean.sel(bound="low") < 7 / 3 < mean.sel(bound="high"))
    True
    """
    from impactlab.report.questions import report_multifidelity
    from impactlab.study.multifidelity import multifidelity as statistics

    seconds, engine = si(budget, "s"), local_engine(workers)
    result = statistics(
        study.declared, study.folder, engine, high, pairs=pairs, runs=runs, budget=seconds,
        indices=indices, predict=predict,
    )  # fmt: skip
    report_multifidelity(result, study.folder)
    return result
