"""Findings of a calibration in sentences: the answer first, then what it rests on."""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from shutil import copyfile

import numpy as np
import xarray as xr

from impactlab.analysis.measurements import COVERAGE
from impactlab.analysis.posterior import CONTRADICTED, FEWEST, NEGLIGIBLE, SILENT, STRONG
from impactlab.figures import labels, measures, record
from impactlab.figures.draw import draw
from impactlab.figures.questions import calibration, measured_words
from impactlab.report.page import Cell, Entry, Row, Section, Table, write_listed
from impactlab.solver.contact import CONTACT_LAWS, LawRecord
from impactlab.study import CALIBRATION

_FIGURE = record.Figure(
    "calibration",
    "Parameters before and given the data, and predictions",
    lambda *_: True,
    lambda results, _: calibration(results),
    lambda *_: (
        "Grey: before the data, blue: given the data; predictions of the measured values with "
        "intervals of 95 %, from the measured value."
    ),
)
_LINES = 4  # of the answer on the page beside the headline; the others follow in a section


def draw_and_tell(results: xr.Dataset, folder: Path) -> list[str]:
    """Draw calibration.svg and .png into a folder, write the report; return the sentences."""
    figures = folder / CALIBRATION / "figures"
    for path in draw([(_FIGURE, (results, results))], figures, str(results.attrs.get("study"))):
        if path.suffix in (".svg", ".png"):
            copyfile(path, folder / path.name)
    write_calibration(results, figures, folder / "calibration.html")
    return sentences(results)


def write_calibration(results: xr.Dataset, figures: Path, path: Path) -> None:
    """Write the report of a calibration. Raises OSError where it cannot be written.

    results: as of study.calibration.calibrate. figures: the folder of its figure.
    """
    headline, *rest = (text.removesuffix(".") for text in sentences(results))
    attrs = {key: str(value) for key, value in results.attrs.items()}
    file, title = attrs.get("study_file", "").replace("../", ""), attrs.get("title", "")
    about = results.assign_attrs(title=f"Calibration: {title}", content="calibration")
    command = f"impactlab calibrate {file or 'STUDY'} {attrs.get('measurements') or 'MEASUREMENTS'}"
    contradicted = float(results["predictive_p"]) < CONTRADICTED
    basis = Section("basis", "What it rests on", sentences=[f"{line}." for line in rest[_LINES:]])
    write_listed(
        path,
        about,
        figures,
        headline=headline,
        answers=[_entry(line) for line in rest[:_LINES]],
        sections=[
            Section("parameters", "Parameters", tables=[_parameters(results)]),
            Section("predictions", "Predictions", tables=[_predictions(results)]),
            *([basis] if basis.sentences else []),
        ],
        size=labels.counted(results.sizes["measurement"], "measurement"),
        failed="contradicted by the data" if contradicted else "",
        reproduce=[(command, "repeats the calibration")],
        index=path.parent.with_name("index.html"),
    )


def _entry(line: str) -> Entry:
    """Return the subject of a sentence, and what it says."""
    silent = "The data cannot tell"
    if line.startswith(silent):
        return silent, line.removeprefix(f"{silent} ")
    subject, _, text = line.partition(": ")
    return subject, text


def _parameters(results: xr.Dataset) -> Table:
    """Return one row per parameter: mean, standard deviation and range, before and after."""
    rows: list[Row] = []
    for number, meaning in enumerate(measures.meanings(results)):
        marginal = results.isel(parameter=number)
        texts = [
            f"{_value(marginal, f'{stage}_mean')} ± {_value(marginal, f'{stage}_deviation')}"
            for stage in ("prior", "posterior")
        ]
        ends = " to ".join(_value(marginal, f"posterior_{end}") for end in ("low", "high"))
        ratio = labels.number(float(marginal["spread_ratio"]), 2)
        cells = [Cell(text, "number") for text in (*texts, ends, ratio)]
        rows.append([labels.sentence(meaning), _unit(marginal).strip() or "–", *cells])
    head = ["Parameter", "Unit", "Before the data", "Given the data", "95 %", "Ratio of spreads"]
    return Table("Parameters: mean ± standard deviation", head, rows)


def _predictions(results: xr.Dataset) -> Table:
    """Return one row per measurement: measured, predicted, and whether they agree."""
    rows: list[Row] = []
    for number, text in enumerate(measured_words(results)):
        row = results.isel(measurement=number)
        name, units = (str(row[f"measured_{key}"].item()) for key in ("quantity", "units"))
        unit = labels.display(
            xr.DataArray(float(row["measured"]), name=name, attrs={"units": units})
        )
        cells = []
        for mean, width in (
            ("measured", "measured_uncertainty"),
            ("predicted_mean", "predicted_deviation"),
        ):
            value, half = (float(unit(float(row[key]))) for key in (mean, width))
            cells.append(Cell(f"{labels.number(value)} ± {labels.number(half, 2)}", "number"))
        verdict = Cell("yes") if _inside(row)[1] else Cell("no", "warning")
        rows.append([labels.sentence(text), unit.symbol or "–", *cells, verdict])
    head = ["Quantity", "Unit", "Measured (k = 2)", "Predicted ± standard deviation", "Within 95 %"]
    return Table("Measured values beside their predictions", head, rows)


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
    name = law["model"].item()
    record = CONTACT_LAWS.get(name, LawRecord(name=name, short=name))
    text = f"{record.short} {labels.number(weight, 2)}"
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
