"""Calibration of a study: its sample under each contact law, its posterior, runs to confirm it."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.analysis import surrogate
from impactlab.analysis.measurements import Measurement
from impactlab.analysis.posterior import calibrated
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.files import read_netcdf, write_netcdf
from impactlab.methods.distributions import Choice
from impactlab.methods.hypercube import Hypercube
from impactlab.methods.runs import in_order, listed, usable
from impactlab.methods.sampling import RandomSample
from impactlab.model.contact_law import LAW_NAMES
from impactlab.provenance import provenance
from impactlab.study import CALIBRATION, steps
from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.ownership import study_file
from impactlab.study.schema.declarations import AnyStudy, ImpactStudy
from impactlab.study.schema.measurement_files import MeasurementSource, read_measurements
from impactlab.study.schema.readers import of_impacts, study_of_content
from impactlab.study.schema.yaml_file import read_mapping
from impactlab.validation.errors import Problem, StudyError, unknown

CONFIRMING = "confirming"
"""Folder in that of calibration, of the runs that confirm."""
RUNS = 16
"""Draws of the posterior that are solved."""
OFF = 2.0
"""Error of a surrogate at these draws over that on runs held out from which on it is refused."""


def calibrate(
    study: AnyStudy,
    folder: Path,
    measured: MeasurementSource,
    engine: Engine,
    laws: Sequence[str] = (),
    model_error: float = 0.0,
) -> xr.Dataset:
    """Solve a study's sample, calibrate it on measurements, confirm by runs of the solver.

    laws: contact laws that are weighed against each other, by default those that the sample draws;
    the sample is solved under each. model_error: see analysis.posterior.calibrated, whose dataset
    is written to calibration.nc in `folder`. It has besides confirmed_error (measurement), the root
    mean squared difference of surrogate and solver at draws of the posterior, confirmed_missing
    (measurement), how many of these gave no answer, and confirmed_runs.

    Raises StudyError where study or measurements are wrong, ValueError with every reason for which
    there is no posterior.
    """
    if not isinstance(study.sampling, RandomSample):
        reason = "calibration needs a sample (any method but grid), whose ranges are the prior"
        raise StudyError(Problem(str(study.path), "sampling.method", reason))
    weights = _drawn(study)
    if categories := [name for name in study.sampling.words if name != "contact" or not weights]:
        reason = (
            "draws words, and no surrogate is fitted over words: fix it (contact laws alone are "
            "weighed against each other)"
        )
        raise StudyError(Problem(str(study.path), f"sampling.parameters.{categories[0]}", reason))
    if isinstance(study.sampling, Hypercube) and study.sampling.correlations:
        reason = f"{study.sampling.no_surrogate}: take them out"
        raise StudyError(Problem(str(study.path), "sampling.correlations", reason))
    models = list(_models(study, folder, laws))  # all of them right before one is solved
    runs = {name: _solved(variant, place, engine) for name, variant, place in models}
    first = next(iter(runs.values()))
    measurements = read_measurements(measured, first)
    surrogates, numerical = {}, {}
    for name, solved in runs.items():
        if (fitted := surrogate.packed(solved, surrogate.analysis(solved))) is None:
            raise ValueError(
                f"study {study.name!r}: its sample has no surrogate: draw numbers from "
                "distributions (contact laws are weighed by --contact)"
            )
        surrogates[name] = Surrogate(fitted)
    if resolution := steps.evidence(study, folder / "runs.nc").get("resolution"):
        grid = read_netcdf(resolution, "resolution")["grid_relative"]
        numerical = dict(zip(grid["response"].values.tolist(), grid.values.tolist(), strict=True))
    before = weights if weights.keys() == surrogates.keys() else None
    posterior = calibrated(surrogates, measurements, numerical, model_error, before)
    posterior = _confirmed(posterior, runs, measurements, folder / CALIBRATION, engine)
    keys = ("study", "title", "study_text", "study_sha256", "function")
    about = {key: first.attrs[key] for key in keys if key in first.attrs}
    names = posterior["parameter"].values.tolist()
    meanings = [str(first[name].attrs["long_name"]) for name in names]
    posterior = posterior.assign(parameter_long_name=("parameter", meanings))
    source = "" if isinstance(measured, Mapping) else str(measured)
    about |= {"study_file": study_file(study, folder), "measurements": source} | provenance()
    posterior = posterior.assign_attrs(about | {"model_error": model_error})
    write_netcdf(posterior, folder / "calibration.nc", "calibration")
    return posterior


def _models(
    study: AnyStudy, folder: Path, laws: Sequence[str]
) -> Iterator[tuple[str, AnyStudy, Path]]:
    """Yield name, study and folder of each model: of each law listed, or else in the sample."""
    choice = _drawn(study)
    laws = laws or tuple(choice)
    if not laws:
        yield "", study, folder
        return
    impacts = of_impacts(study)
    for law in laws:
        if law not in LAW_NAMES:
            raise ValueError(f"contact = {law!r}: {unknown('contact law', law, LAW_NAMES)}")
        if not choice and law == impacts.sampling.fixed.get("contact", impacts.impact.contact):
            yield law, study, folder
            continue
        data = read_mapping(study.text, str(study.path))
        if "contact" in impacts.sampling.parameters:
            entry = {"distribution": "fixed", "value": law}
            data["sampling"]["parameters"]["contact"] = entry
        else:
            data["impact"]["contact"] = law
        under = study_of_content(study.name, data, study.path)
        yield law, replace(under, path=Path(f"{study.name}_{law}.yaml")), folder / CALIBRATION / law


def _drawn(study: AnyStudy) -> dict[str, float]:
    """Return the contact laws that a sample draws, with their probabilities; else {}."""
    law = study.sampling.parameters.get("contact")
    if not isinstance(study, ImpactStudy) or not isinstance(law, Choice):
        return {}
    arguments = law.arguments()
    return dict(zip(arguments["values"], arguments["weights"], strict=True))


def _solved(study: AnyStudy, folder: Path, engine: Engine) -> xr.Dataset:
    path = folder / "runs.nc"
    runs = read_netcdf(path, "runs") if path.exists() else None
    if runs is None or runs.attrs.get("study_sha256") != study.sha256:
        folder.mkdir(parents=True, exist_ok=True)
        steps.run(study, path, engine)
        runs = read_netcdf(path, "runs")
    return runs


def _confirmed(
    posterior: xr.Dataset,
    runs: dict[str, xr.Dataset],
    measurements: Sequence[Measurement],
    folder: Path,
    engine: Engine,
) -> xr.Dataset:
    """Add what runs at draws of the posterior say of the surrogates.

    Raises ValueError where these are further off than on the runs held out, or no run answers.
    """
    draws = posterior.isel(draw=slice(RUNS))
    square, answered = np.zeros(len(measurements)), np.zeros(len(measurements), int)
    solved = 0
    for name in runs:
        mine = draws.isel(draw=np.flatnonzero(draws["draw_model"].values == name))
        if not (count := mine.sizes["draw"]):
            continue
        sample = in_order(runs[name])
        stated = [
            {
                key: value
                for key, value in measurement.conditions.items()
                if key in listed(sample, "varied")
            }
            for measurement in measurements
        ]
        for conditions in {json.dumps(item): item for item in stated}.values():
            answers = execute(_design(sample, mine, conditions), folder / CONFIRMING / name, engine)
            solved += count
            for row, measurement in enumerate(measurements):
                if stated[row] == conditions:
                    ours = usable(answers, measurement.quantity).values[0]
                    error = (ours - mine["draw_predicted"].values[:, row]) ** 2
                    square[row] += np.nansum(error)
                    answered[row] += np.isfinite(error).sum()
    if lacking := [
        measurement.quantity
        for measurement, n in zip(measurements, answered, strict=True)
        if n < RUNS / 2
    ]:
        raise ValueError(
            f"{', '.join(dict.fromkeys(lacking))}: most runs at the posterior gave no answer, so "
            "that nothing confirms it: sample another range"
        )
    error = np.sqrt(square / answered)
    ratio = error / np.maximum(
        posterior["surrogate_error"], 0.1 * posterior["measured_uncertainty"] / 2
    )
    if (ratio > OFF).any():
        row = int(np.asarray(ratio).argmax())
        measurement = measurements[row]
        raise ValueError(
            f"{measurement.quantity}: at the posterior the surrogate is off by {error[row]:.3g} "
            f"{measurement.units}, {float(ratio[row]):.2g} times its stated error: "
            "draw more runs, or narrower ranges"
        )
    long_name = "root mean squared difference of surrogate and solver at draws of the posterior"
    missing = RUNS - answered, {"long_name": "draws without an answer"}
    return posterior.assign(
        confirmed_error=("measurement", error, {"long_name": long_name}),
        confirmed_missing=("measurement", *missing),
        confirmed_runs=((), solved, {"long_name": "runs solved at draws of the posterior"}),
    )


def _design(sample: xr.Dataset, draws: xr.Dataset, conditions: Mapping[str, object]) -> xr.Dataset:
    """Return the design of one run per draw, of all else as in the sample."""
    count = draws.sizes["draw"]
    beside = [name for name, values in sample.coords.items() if set(values.dims) - {"run"}]
    selection = sample.isel(run=np.arange(count) % sample.sizes["run"])
    selection = selection.drop_vars([*selection.data_vars, *beside]).assign_coords(
        run=np.arange(count)
    )
    for name in listed(sample, "varied"):
        if name in conditions:
            values = np.full(count, float(str(conditions[name])))
        else:
            values = draws["draws"].sel(parameter=name).values
        selection = selection.assign_coords({name: ("run", values, sample[name].attrs)})
    return selection.assign_attrs(histories=0, profiles=0)
