"""A study beside measurements, comparison and calibration; and studies beside each other."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.analysis.measurements import compared
from impactlab.api.definition import Study
from impactlab.api.folder import CORES, local_engine
from impactlab.model.quantities import Quantity, si
from impactlab.study.schema.measurement_files import MeasurementSource, read_measurements


def compare(
    runs: xr.Dataset, measurements: MeasurementSource, analysis: xr.Dataset | None = None
) -> xr.Dataset:
    """Compare the runs of a grid with measurements: values, uncertainties and verdicts.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs of a grid study.
    measurements : str, pathlib.Path or mapping
        File (docs/measurements.md), or a mapping of its keys.
    analysis : xarray.Dataset, optional
        Analysis of the runs, for their numerical uncertainty; by default `analyse(runs)`.

    Returns
    -------
    xarray.Dataset
        A row per measurement and model on `comparison`, in SI units, with expanded uncertainties
        (k = 2).

    Raises
    ------
    StudyError
        If measurements are wrong.
    ValueError
        If the runs are not a study's.

    References
    ----------
    ASME V&V 20-2009; JCGM 100:2008 (both recalled, not read).

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ours", impact=il.paper_impact("2 m/s"), duration="0.3 ms",
    ...     responses=["peak_force"], sampling=il.Grid(parameters={"nodes": [21, 41, 81]}))
    >>> force = {"quantity": "peak_force", "value": "24.5 kN", "standard_uncertainty": "1 kN"}
    >>> ours = {"title": "Force", "source": "an example, not measured", "measurements": [force]}
    >>> found = il.compare(study.run(workers=1), ours)
    >>> found.compared_verdict.attrs["flag_meanings"].split()[found.compared_verdict.item()]
    'compatible'
    """
    analysis = analyse(runs) if analysis is None else analysis
    return compared(runs, analysis, read_measurements(measurements, runs))


def compare_studies(*studies: Study, path: str | Path | None = None) -> xr.Dataset:
    """Compare solved studies side by side, and write the page.

    It shows what differs in their files, each shared response on common axes, and the sensitivity
    indices of samples with the differences that chance does not explain. `compare` compares one
    study with measurements.

    Parameters
    ----------
    *studies : Study
        Two or more studies with runs, all grids or all samples, in the order of the page.
    path : str or pathlib.Path, optional
        Folder for report.html, comparison.nc and figures; by default one beside the first study's.

    Returns
    -------
    xarray.Dataset
        Differences of the indices on (response, pair, measure, parameter), with half-widths that
        hold together and `is_significant`; `first` and `second` number the studies of a pair. The
        attribute `answer` holds the findings in sentences.

    Raises
    ------
    ValueError
        If a study has no runs, or studies are of different kind or share no response.

    Examples
    --------
    >>> studies, ends = [], il.Uniform("-3.14", "3.14")
    >>> for title, third in {"wide": ends, "narrow": il.Uniform(-1, 1)}.items():
    ...     sampling = il.Sobol(base_samples=1024, parameters={"x1": ends, "x2": ends, "x3": third})
    ...     studies.append(il.Study(title=title, function="ishigami", sampling=sampling))
    ...     runs = studies[-1].run(workers=1)
    >>> print(il.answers(il.compare_studies(*studies))[0])
    From wide to narrow the share of x2 in the scatter of the value rises from ...
    """
    from impactlab.report.comparison import compare_results

    for study in studies:
        study.analyse()
    output = None if path is None else Path(path)
    return compare_results([study.folder for study in studies], output)


def calibrate(
    study: Study,
    measurements: MeasurementSource,
    *,
    contact: Sequence[str] = (),
    model_error: float = 0.0,
    workers: int = CORES,
) -> xr.Dataset:
    """Infer the parameters that a sample varies from measurements, and the weights of contact laws.

    The distributions of the sample are the prior; a parameter that all measurements state is not
    inferred. The dataset is kept as calibration.nc in the study's folder, with the figure
    calibration.svg and the report calibration.html.

    Parameters
    ----------
    study : Study
        Sample whose distributions are the prior.
    measurements : str, pathlib.Path or mapping
        File (docs/measurements.md), or a mapping of its keys.
    contact : sequence of str, optional
        Contact laws to weigh, under each of which the sample is solved; by default those that the
        sample draws.
    model_error : float, default 0
        Relative standard error of the model itself.
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        Posterior on `parameter`, weights on `model`, predictions on `measurement`, and equally
        weighted draws on `draw`, in SI units; the attribute `answer` holds the findings in
        sentences.

    Raises
    ------
    StudyError
        If study or measurements are wrong.
    ValueError
        If there is no posterior, with every reason (docs/measurements.md).

    References
    ----------
    Kennedy and O'Hagan (2001), J. R. Stat. Soc. B 63, 425 (recalled, not read), with a discrepancy
    of given size in place of a fitted one.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Decay", function=lambda rate, start: start - 2 * rate, sampling=il.Pawn(
    ...         samples=128, parameters={"rate": il.Uniform(0, 1), "start": il.Uniform(5, 6)}))
    >>> value = {"quantity": "value", "value": 4.5, "standard_uncertainty": 0.1}
    >>> ours = {"title": "Value", "source": "an example, not measured", "measurements": [value]}
    >>> found = il.calibrate(study, ours, workers=1)
    >>> found.spread_ratio.round(1).values
    array([0.5, 1. ])
    """
    from impactlab.report.calibration import draw_and_tell
    from impactlab.study.calibration import calibrate as calibration

    engine = local_engine(workers)
    posterior = calibration(
        study.declared, study.folder, measurements, engine, contact, model_error
    )
    return posterior.assign_attrs(answer="\n".join(draw_and_tell(posterior, study.folder)))


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
        Number of runs per level, at least 200.
    runs : int, default 6000
        Largest number of all runs, at least 4 `samples`; with `surrogate`, at least 300.
    coefficient_of_variation : float, default 0.1
        Standard error to reach over the probability, from 0.01 to 0.5.
    surrogate : bool, default False
        True to let a Gaussian process place the runs; `samples` is not used then.
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
    from impactlab.report.rare_event import report_rare_event
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
    is small enough, confirms them by runs, and draws the best objective over the probability
    (docs/sensitivity.md). The runs are kept in the study's folder: the same call resumes where it
    stopped.

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
        Number of runs per level of each estimate of a probability, at least 200.
    runs : int, default 6000
        Largest number of runs of an estimate, at least 4 `samples`.
    coefficient_of_variation : float, default 0.1
        Standard error to reach over the probability, from 0.01 to 0.5.
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        The design variables, the `objective` and its interval on `bound`, the `probability` there,
        the front, all designs tried, `verdict`; the attribute `answer` holds the findings in
        sentences. They are kept in the study's folder as sizing.nc, with the report sizing.html.

    Raises
    ------
    StudyError
        If the study has no sample, or not one limit.
    ValueError
        If a variable has no range or correlates with others, a setting is out of range, or another
        study has results of this name.

    References
    ----------
    Sacks, Welch, Mitchell and Wynn (1989), Stat. Sci. 4, 409 (recalled, not read).

    Examples
    --------
    >>> study = il.Study(
    ...     title="Rod", function=lambda load, strength, area: load / area - strength,
    ...     limits={"value": 0}, sampling=il.Pawn(samples=128, parameters={
    ...         "load": il.Normal(5, 1), "strength": il.Normal(6, 0.5), "area": il.Uniform(1, 3)}))
    >>> design = il.size(study, ["area"], probability=1e-3, minimise="area", workers=1)
    >>> exact = 1.477  # its probability is 1e-3
    >>> bool(exact <= design.area[0] < 1.03 * exact)
    True
    """
    from impactlab.report.rare_event import report_sizing
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
    high: Mapping[str, Any],
    *,
    pairs: int = 40,
    runs: int = 0,
    budget: Quantity = 0.0,
    workers: int = CORES,
) -> xr.Dataset:
    """Estimate statistics of a slow model from few of its runs and many of the study's model.

    Both have the distributions of the study (docs/sensitivity.md); `Multifidelity` takes outputs
    instead. The runs are kept in the study's folder: the same call resumes where it stopped.

    Parameters
    ----------
    study : Study
        Sample of any method, of which the distributions, the seed, responses and limits count.
    high : mapping of str to Quantity
        Values of the slow model's parameters in place of the study's, such as
        `{"beam_model": "solid", "elements_per_radius": 2}`.
    pairs : int, default 40
        Number of runs of the slow model, at least 20.
    runs : int, default 0
        Number of runs of the study's model; 0: the best for the costs and the pairs.
    budget : Quantity, default 0
        Time of one core, in s, in place of `pairs`: 20 pairs tell how many it pays for.
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        `estimate` on (response, statistic, bound), `saving`, `correlation`, costs, `verdict` and
        the pairs; the attribute `answer` holds the findings in sentences. They are kept in the
        study's folder as multifidelity.nc, with the report multifidelity.html.

    Raises
    ------
    StudyError
        If the study has no sample, or cannot have these values.
    ValueError
        If a setting is out of range, or another study has results of this name.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Power", function=lambda x, power: (1 + x) ** power, limits={"value": 3},
    ...     sampling=il.Pawn(samples=128, parameters={"x": il.Uniform(0, 1), "power": 1}))
    >>> both = il.multifidelity(study, {"power": 2}, runs=2000, workers=1)
    >>> mean = both.estimate.sel(response="value", statistic="mean")
    >>> bool(mean.sel(bound="low") < 7 / 3 < mean.sel(bound="high"))
    True
    """
    from impactlab.report.rare_event import report_multifidelity
    from impactlab.study.multifidelity import multifidelity as statistics

    seconds, engine = si(budget, "s"), local_engine(workers)
    result = statistics(
        study.declared, study.folder, engine, high, pairs=pairs, runs=runs, budget=seconds
    )
    report_multifidelity(result, study.folder)
    return result
