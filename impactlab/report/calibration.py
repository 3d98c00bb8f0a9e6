"""Findings of a calibration in sentences: the answer first, then what it rests on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.analysis.calibration import CONTRADICTED, FEWEST, NEGLIGIBLE, SILENT, STRONG
from impactlab.analysis.measurements import COVERAGE
from impactlab.figures import labels
from impactlab.figures.calibration import calibration
from impactlab.figures.draw import save
from impactlab.solver.contact import CONTACT_LAWS


def draw_and_tell(found: xr.Dataset, folder: Path) -> list[str]:
    """Draw calibration.svg and .png into a folder; return the sentences."""
    source = {"Title": "Calibration", "Source": f"study {found.attrs.get('study', '?')}"}
    save(calibration(found), folder, "calibration", source)
    return sentences(found)


def sentences(found: xr.Dataset) -> list[str]:
    """Return what the dataset of a calibration says, the main finding first."""
    return list(_sentences(found))


def _sentences(found: xr.Dataset) -> Iterator[str]:
    p_value = float(found["predictive_p"])
    if p_value < CONTRADICTED:
        yield (
            f"The data contradict the model (posterior predictive p = {p_value:.1g}): no "
            "parameters in the sampled ranges reproduce them within their uncertainties. Do not "
            "use the numbers below; state the model's own error (--model-error) if it is known."
        )
    silent, names = [], [str(name) for name in found["parameter"].values]
    for name in names:
        one = found.sel(parameter=name)
        if np.isfinite(one["mode_weight"]).sum() > 1:
            yield f"{labels.sentence(labels.parameter(name))}: {_modes(one)}"
            continue
        if (ratio := float(one["spread_ratio"])) >= SILENT:
            silent.append(f"{labels.parameter(name)} (spread {ratio:.2f} of the prior's)")
            continue
        ends = " to ".join(_value(one, key) for key in ("posterior_low", "posterior_high"))
        yield (
            f"{labels.sentence(labels.parameter(name))}: {_value(one, 'posterior_mean')}"
            f"{_unit(one)} ± {_value(one, 'posterior_deviation')} (standard deviation; 95 %: "
            f"{ends}); before the data {_value(one, 'prior_mean')} ± "
            f"{_value(one, 'prior_deviation')}."
        )
    if silent:
        yield f"The data cannot tell {labels.listing(silent)}."
    correlation = found["posterior_correlation"].values
    pairs = [
        f"{' and '.join(labels.parameter(names[at]) for at in pair)} ({correlation[pair]:+.2f})"
        for pair in combinations(range(len(names)), 2)
        if abs(correlation[pair]) >= STRONG
    ]
    if pairs:
        yield (
            f"Correlated given the data: {labels.listing(pairs)}. Not every pair of values within "
            "their intervals fits the data."
        )
    if found.sizes["model"] > 1:
        order = np.argsort(-found["model_weight"].values, kind="stable")
        told = [_model(found.isel(model=at)) for at in order.tolist()]
        yield f"Weights of the contact laws given the data: {'; '.join(told)}."
    inside = [_inside(found.isel(measurement=at)) for at in range(found.sizes["measurement"])]
    out = sorted({labels.response(name) for name, within in inside if not within})
    yield (
        f"Predictions: {sum(within for _, within in inside)} of {len(inside)} measured values "
        "within the 95 % interval of measurement, surrogate and posterior"
        + f"; not {labels.listing(out)}" * bool(out)
        + f" (posterior predictive p = {p_value:.2g})."
    )
    least = found["effective_samples"].where(found["model_weight"] >= NEGLIGIBLE).min()
    text = f"Effective sample size: {float(least):,.0f} or more (least accepted: {FEWEST:g})."
    if "confirmed_error" in found:
        uncertainty = found["measured_uncertainty"] / COVERAGE
        worst = float((found["confirmed_error"] / uncertainty).max())
        missing = int(found["confirmed_missing"].max())
        text = (
            f"Confirmed by {int(found['confirmed_runs'])} runs of the solver at draws of the "
            f"posterior: there the surrogate is off by {labels.percent(worst)} of the data's "
            "standard uncertainty or less (root mean square)"
            + f", {missing} without an answer" * bool(missing)
            + f". {text}"
        )
    yield text


def _modes(one: xr.Dataset) -> str:
    """Return the separate ranges of a parameter, each with its probability."""
    modes = [one.isel(mode=at) for at in np.flatnonzero(np.isfinite(one["mode_weight"].values))]
    ranges = [
        f"{_value(mode, 'mode_low')} to {_value(mode, 'mode_high')}{_unit(one)} (probability "
        f"{labels.number(float(mode['mode_weight']), 2)})"
        for mode in modes
    ]
    return (
        f"the data allow {len(modes)} separate ranges, {labels.listing(ranges)}; mean and standard "
        "deviation describe none of them."
    )


def _mean(one: xr.Dataset) -> xr.DataArray:
    """Return the posterior mean of a parameter as labels take it, in whose unit all is shown."""
    attrs = {"units": str(one["parameter_units"].item())}
    name = str(one["parameter"].item())
    return xr.DataArray(float(one["posterior_mean"]), name=name, attrs=attrs)


def _unit(one: xr.Dataset) -> str:
    return labels.unit(_mean(one))


def _value(one: xr.Dataset, key: str) -> str:
    unit = labels.display(_mean(one))
    digits = 2 if key.endswith("deviation") else 4
    return labels.number(float(unit(float(one[key]))), digits)


def _model(one: xr.Dataset) -> str:
    """Return a law with its weight, and the parameters under it where it has some weight."""
    weight, doubt = float(one["model_weight"]), str(one["model_doubt"].item())
    text = f"{CONTACT_LAWS[one['model'].item()].short} {labels.number(weight, 2)}"
    text += f", {labels.number(float(one['model_weight_before']), 2)} before"
    if doubt:
        return f"{text} (though {doubt})"
    told = []
    for name in one["parameter"].values if weight >= NEGLIGIBLE else ():
        of = one.sel(parameter=name)
        if float(of["model_deviation"] / of["prior_deviation"]) < SILENT:
            told.append(
                f"{labels.parameter(str(name))} {_value(of, 'model_mean')}{_unit(of)} ± "
                f"{_value(of, 'model_deviation')}"
            )
    return f"{text} ({', '.join(told)})" if told else text


def _inside(one: xr.Dataset) -> tuple[str, bool]:
    keys = "measured_uncertainty", "surrogate_error", "predicted_deviation"
    expanded, error, deviation = (float(one[key]) for key in keys)
    gap = abs(float(one["measured"] - one["predicted_mean"]))
    within = gap <= 1.96 * float(np.sqrt((expanded / COVERAGE) ** 2 + error**2 + deviation**2))
    return str(one["measured_quantity"].item()), within
