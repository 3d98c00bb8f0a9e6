"""Findings of a calibration in sentences: the answer first, then what it rests on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.analysis.measurements import COVERAGE
from impactlab.analysis.posterior import CONTRADICTED, FEWEST, NEGLIGIBLE, SILENT, STRONG
from impactlab.figures import labels, measures
from impactlab.figures.calibration import calibration
from impactlab.figures.draw import save
from impactlab.solver.contact import CONTACT_LAWS


def draw_and_tell(results: xr.Dataset, folder: Path) -> list[str]:
    """Draw calibration.svg and .png into a folder; return the sentences."""
    source = {"Title": "Calibration", "Source": f"study {results.attrs.get('study', '?')}"}
    save(calibration(results), folder, "calibration", source)
    return sentences(results)


def sentences(results: xr.Dataset) -> list[str]:
    """Return what the dataset of a calibration says, the main finding first."""
    return list(_sentences(results))


def _sentences(results: xr.Dataset) -> Iterator[str]:
    p_value = float(results["predictive_p"])
    if p_value < CONTRADICTED:
        yield (
            f"The data contradict the model (posterior predictive p = {p_value:.1g}): no "
            "parameters in the sampled ranges reproduce them within their uncertainties. Do not "
            "use the numbers below; state the model's own error (--model-error) if it is known."
        )
    silent, meanings = [], measures.meanings(results)
    for number, meaning in enumerate(meanings):
        marginal = results.isel(parameter=number)
        if np.isfinite(marginal["mode_weight"]).sum() > 1:
            yield f"{labels.sentence(meaning)}: {_modes(marginal)}"
            continue
        if (ratio := float(marginal["spread_ratio"])) >= SILENT:
            silent.append(f"{meaning} (spread {ratio:.2f} of the prior's)")
            continue
        ends = " to ".join(_value(marginal, key) for key in ("posterior_low", "posterior_high"))
        yield (
            f"{labels.sentence(meaning)}: {_value(marginal, 'posterior_mean')}"
            f"{_unit(marginal)} ± {_value(marginal, 'posterior_deviation')} (standard deviation; "
            f"95 %: {ends}); before the data {_value(marginal, 'prior_mean')} ± "
            f"{_value(marginal, 'prior_deviation')}."
        )
    if silent:
        yield f"The data cannot tell {labels.listing(silent)}."
    correlation = results["posterior_correlation"].values
    pairs = [
        f"{' and '.join(meanings[i] for i in pair)} ({correlation[pair]:+.2f})"
        for pair in combinations(range(len(meanings)), 2)
        if abs(correlation[pair]) >= STRONG
    ]
    if pairs:
        yield (
            f"Correlated given the data: {labels.listing(pairs)}. Not every pair of values within "
            "their intervals fits the data."
        )
    if results.sizes["model"] > 1:
        order = np.argsort(-results["model_weight"].values, kind="stable")
        texts = [_model(results.isel(model=number)) for number in order.tolist()]
        yield f"Weights of the contact laws given the data: {'; '.join(texts)}."
    inside = [
        _inside(results.isel(measurement=number)) for number in range(results.sizes["measurement"])
    ]
    outside = sorted({labels.response(name) for name, within in inside if not within})
    exceptions = f"; not {labels.listing(outside)}" if outside else ""
    yield (
        f"Predictions: {sum(within for _, within in inside)} of {len(inside)} measured values "
        "within the 95 % interval of measurement, surrogate and posterior"
        f"{exceptions} (posterior predictive p = {p_value:.2g})."
    )
    least = results["effective_samples"].where(results["model_weight"] >= NEGLIGIBLE).min()
    text = f"Effective sample size: {float(least):,.0f} or more (least accepted: {FEWEST:g})."
    if "confirmed_error" in results:
        uncertainty = results["measured_uncertainty"] / COVERAGE
        worst = float((results["confirmed_error"] / uncertainty).max())
        missing = int(results["confirmed_missing"].max())
        gaps = f", {missing} without an answer" if missing else ""
        text = (
            f"Confirmed by {int(results['confirmed_runs'])} runs of the solver at draws of the "
            f"posterior: there the surrogate is off by {labels.percent(worst)} of the data's "
            "standard uncertainty or less (root mean square)"
            f"{gaps}. {text}"
        )
    yield text


def _modes(marginal: xr.Dataset) -> str:
    """Return the separate ranges of a parameter, each with its probability."""
    modes = [
        marginal.isel(mode=number)
        for number in np.flatnonzero(np.isfinite(marginal["mode_weight"].values))
    ]
    ranges = [
        f"{_value(mode, 'mode_low')} to {_value(mode, 'mode_high')}{_unit(marginal)} (probability "
        f"{labels.number(float(mode['mode_weight']), 2)})"
        for mode in modes
    ]
    return (
        f"the data allow {len(modes)} separate ranges, {labels.listing(ranges)}; mean and standard "
        "deviation describe none of them."
    )


def _mean(marginal: xr.Dataset) -> xr.DataArray:
    """Return the posterior mean of a parameter as labels take it, in whose unit all is shown."""
    attrs = marginal.attrs | {"units": str(marginal["parameter_units"].item())}
    name = str(marginal["parameter"].item())
    return xr.DataArray(float(marginal["posterior_mean"]), name=name, attrs=attrs)


def _unit(marginal: xr.Dataset) -> str:
    return labels.unit(_mean(marginal))


def _value(marginal: xr.Dataset, key: str) -> str:
    unit = labels.display(_mean(marginal))
    digits = 2 if key.endswith("deviation") else 4
    return labels.number(float(unit(float(marginal[key]))), digits)


def _model(law: xr.Dataset) -> str:
    """Return a law with its weight, and the parameters under it where it has some weight."""
    weight, doubt = float(law["model_weight"]), str(law["model_doubt"].item())
    text = f"{CONTACT_LAWS[law['model'].item()].short} {labels.number(weight, 2)}"
    text += f", {labels.number(float(law['model_weight_before']), 2)} before"
    if doubt:
        return f"{text} (though {doubt})"
    texts = []
    for number, meaning in enumerate(measures.meanings(law) if weight >= NEGLIGIBLE else ()):
        marginal = law.isel(parameter=number)
        if float(marginal["model_deviation"] / marginal["prior_deviation"]) < SILENT:
            texts.append(
                f"{meaning} {_value(marginal, 'model_mean')}{_unit(marginal)}"
                f" ± {_value(marginal, 'model_deviation')}"
            )
    return f"{text} ({', '.join(texts)})" if texts else text


def _inside(prediction: xr.Dataset) -> tuple[str, bool]:
    keys = "measured_uncertainty", "surrogate_error", "predicted_deviation"
    expanded, error, deviation = (float(prediction[key]) for key in keys)
    gap = abs(float(prediction["measured"] - prediction["predicted_mean"]))
    within = gap <= 1.96 * float(np.sqrt((expanded / COVERAGE) ** 2 + error**2 + deviation**2))
    return str(prediction["measured_quantity"].item()), within
