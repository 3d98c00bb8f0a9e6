"""Sobol indices with bootstrap intervals, by SALib, which sees complete and varying outputs only.

SALib answers a NaN or a constant output with indices of zero, and takes seed 0 as no seed.
Estimators: Saltelli et al. (2010), Comput. Phys. Commun. 181, 259 (first and total order);
Saltelli (2002), Comput. Phys. Commun. 145, 280 (second order).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import xarray as xr
from SALib.analyze import sobol

from impactlab.analysis.responses import usable
from impactlab.analysis.sobol_sample import SobolSample
from impactlab.analysis.verdicts import ROUND_OFF, Verdict, flagged

Array = npt.NDArray[np.float64]

MOSTLY = 0.9
"""Share of runs with one and the same value from which on a response is mostly constant."""
_SALIB = {"first_order": "S1", "total_order": "ST", "second_order": "S2"}


class SensitivityVerdict(Verdict):
    """Whether the indices of a response may be used."""

    USABLE = 0, True, "every run answered and the response varies"
    MOSTLY_CONSTANT = 1, False, "nine runs in ten share one value: the indices hang on the others"
    CONSTANT = 2, False, "the response does not vary: indices are undefined"
    FAILED_RUNS = 3, False, "runs are missing (see missing_runs): no index is given"


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a Sobol sample."""
    return runs.attrs.get("method") == "sobol"


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Sobol indices of every response.

    Returns first_order and total_order on (response, parameter), second_order on (response,
    parameter, other_parameter), symmetric with NaN on the diagonal, where it was sampled; each
    with <name>_interval, the half-width of the confidence interval; sensitivity_verdict
    (response). All without unit; NaN where the verdict is failed_runs or constant. Raises
    ValueError when the number of runs does not fit the sample.
    """
    sample = SobolSample.of(runs)
    values = usable(runs).sortby("run").transpose("response", "run")
    verdicts = [verdict(row, sample.step) for row in values.values]
    rows = [
        indices(row, sample, sample.seed_of(name))
        if judgement in (SensitivityVerdict.USABLE, SensitivityVerdict.MOSTLY_CONSTANT)
        else {}
        for name, row, judgement in zip(
            values["response"].values.tolist(), values.values, verdicts, strict=True
        )
    ]
    dataset = xr.Dataset(_variables(rows, sample), coords=_coordinates(values, sample))
    codes = xr.DataArray([int(judgement) for judgement in verdicts], dims="response")
    return dataset.assign(
        sensitivity_verdict=flagged(codes, SensitivityVerdict, "verdict on the Sobol indices")
    )


def verdict(outputs: Array, step: int) -> SensitivityVerdict:
    """What may be made of one response; outputs: (runs,) in Saltelli's order, `step` a sample.

    The variance comes from the two base samples (first and last of each step), so that these
    have to vary.
    """
    if not np.isfinite(outputs).all():
        return SensitivityVerdict.FAILED_RUNS
    base = np.concatenate([outputs[::step], outputs[step - 1 :: step]])
    still = np.ptp(base) <= ROUND_OFF * np.abs(outputs).max()
    if still or np.var(base) <= ROUND_OFF * np.var(outputs):
        return SensitivityVerdict.CONSTANT
    most = np.unique(outputs, return_counts=True)[1].max()
    mostly = most >= MOSTLY * outputs.size
    return SensitivityVerdict.MOSTLY_CONSTANT if mostly else SensitivityVerdict.USABLE


def indices(outputs: Array, sample: SobolSample, seed: int) -> dict[str, Array]:
    """Indices of one response and half-widths of their intervals, by variable name.

    outputs: (runs,) in Saltelli's order, finite and not constant. Returns arrays (parameter,) or
    (parameter, parameter).
    """
    found = sobol.analyze(
        {"num_vars": len(sample.parameters), "names": list(sample.parameters)},
        outputs,
        calc_second_order=sample.second_order,
        num_resamples=sample.resamples,
        conf_level=sample.confidence,
        seed=seed,
    )
    result = {}
    for name in sample.indices:
        result[name] = _symmetric(found[_SALIB[name]])
        result[f"{name}_interval"] = _symmetric(found[f"{_SALIB[name]}_conf"])
    return result


def _symmetric(values: Array) -> Array:
    """SALib fills the upper triangle of a matrix; vectors stay as they are."""
    return np.where(np.isnan(values), values.T, values)


def _variables(
    rows: list[dict[str, Array]], sample: SobolSample
) -> dict[str, tuple[tuple[str, ...], Array, dict[str, object]]]:
    """Dataset variables from one dict of indices a response; an empty dict stands for NaN."""
    count = len(sample.parameters)
    variables = {}
    for name, dims in sample.indices.items():
        gap = np.full((count,) * len(dims), np.nan)
        for key, attrs in _attributes(name, sample).items():
            stacked = np.array([row.get(key, gap) for row in rows])
            variables[key] = (("response", *dims), stacked, attrs)
    return variables


def _attributes(name: str, sample: SobolSample) -> dict[str, dict[str, object]]:
    words, percent = f"{name.replace('_', '-')} Sobol index", 100 * sample.confidence
    return {
        name: {"long_name": words, "units": "1"},
        f"{name}_interval": {
            "long_name": f"half-width of the {percent:g} % interval of the {words}",
            "units": "1",
            "confidence": sample.confidence,
            "resamples": sample.resamples,
        },
    }


def _coordinates(values: xr.DataArray, sample: SobolSample) -> dict[str, object]:
    names = list(sample.parameters)
    coordinates: dict[str, object] = {
        str(name): array for name, array in values.coords.items() if array.dims == ("response",)
    }
    coordinates["parameter"] = ("parameter", names, {"long_name": "varied parameter"})
    if sample.second_order:
        other = {"long_name": "the other varied parameter"}
        coordinates["other_parameter"] = ("other_parameter", names, other)
    return coordinates
