"""A study beside measurements, comparison and calibration; and studies beside each other."""

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.analysis.measurements import compared
from impactlab.api.definition import Study
from impactlab.api.folder import CORES, local_engine
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
