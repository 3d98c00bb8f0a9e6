"""Reports of questions to a study: rare events, designs, two models; the answer first."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.draw import Drawing, draw
from impactlab.figures.questions import FIGURES
from impactlab.files import read_netcdf
from impactlab.report.page import Cell, Row, Section, Table, write_listed
from impactlab.study import MULTIFIDELITY, RARE_EVENT, SIZING


def report_rare_event(result: xr.Dataset, folder: Path) -> Path:
    """Write the report of a rare event into a study's folder; return its path."""
    figures = folder / RARE_EVENT / "figures"
    draw(_drawings(result), figures, str(result.attrs.get("study")))
    names = ("probability", "low", "high", "if_none", "if_all", "check", "first_order",
             "coefficient_of_variation", "runs", "placed", "last_sample", "missing")  # fmt: skip
    numbers: list[Row] = [
        [labels.sentence(str(result[name].attrs["long_name"])), _cell(result[name].item())]
        for name in names
    ]
    unit = labels.display(result["level"])
    levels: list[Row] = [
        [str(number), _cell(value)]
        for number, value in enumerate(unit(result["level"].values).tolist(), 1)
    ]
    tables = [Table("All numbers", ["Number", "Value"], numbers)]
    if levels:
        head = ["Level", f"Limit ({unit.symbol or '–'})"]
        tables.append(Table("Limits of the levels", head, levels))
    sections = [Section("numbers", "The estimate", tables=tables)]
    return _written(result, folder, figures, RARE_EVENT, "Rare event", "rare", sections)


def report_sizing(result: xr.Dataset, folder: Path) -> Path:
    """Write the report of a design into a study's folder; return its path."""
    figures = folder / SIZING / "figures"
    draw(_drawings(result), figures, str(result.attrs.get("study")))
    last = ("tried_objective", "tried_probability", "tried_low", "tried_high")
    columns = [*(name for name in result if str(name).startswith("tried_") and name not in last)]
    columns += last
    units = [labels.display(result[name]) for name in columns]
    rows: list[Row] = [
        [
            str(row + 1),
            *(
                _cell(float(unit(result[name].values[row])))
                for name, unit in zip(columns, units, strict=True)
            ),
        ]
        for row in range(result.sizes["estimate"])
    ]
    heads = [
        labels.axis(str(result[name].attrs["long_name"]), unit.symbol)
        for name, unit in zip(columns, units, strict=True)
    ]
    tables = [Table("All designs tried, in order", ["Design", *heads], rows)]
    sections = [Section("designs", "Designs", tables=tables)]
    return _written(result, folder, figures, SIZING, "Design", "size", sections)


def report_multifidelity(result: xr.Dataset, folder: Path) -> Path:
    """Write the report of statistics by two models into a study's folder; return its path."""
    figures = folder / MULTIFIDELITY / "figures"
    draw(_drawings(result), figures, str(result.attrs.get("study")))
    sections = [Section("numbers", "The estimates", tables=_slow_model(result))]
    return _written(result, folder, figures, MULTIFIDELITY, "Two models", "multifidelity", sections)


def slow_model_sections(runs: xr.Dataset, folder: Path) -> list[Section]:
    """Return the section on the slow model that a study asks for, and write its page beside."""
    path = folder / f"{MULTIFIDELITY}.nc"
    if "slow_model" not in runs.attrs or not path.is_file():
        return []
    result = read_netcdf(path, MULTIFIDELITY)
    if result.attrs["study_sha256"] != runs.attrs["study_sha256"]:
        return []
    report_multifidelity(result, folder)
    title = f"With {runs.attrs['slow_model']}"
    return [Section(MULTIFIDELITY, title, tables=_slow_model(result))]


def _slow_model(result: xr.Dataset) -> list[Table]:
    """Return the tables of statistics by two models, and of their runs and costs."""
    from impactlab.study.multifidelity_answer import stated  # late: the other questions do without

    rows: list[Row] = []
    for row, response in enumerate(result["response"].values):
        for column, statistic in enumerate(result["statistic"].values):
            text, reason = (
                stated(result, row, statistic),
                str(result["refusal"].values[row, column]),
            )
            if text or reason:
                cell = Cell(text, "number") if text else Cell("none", "warning", reason)
                saving = _cell(float(result["saving"].values[row, column]))
                kind = str(statistic).replace("_", " ").replace("exceedance", "above the limit")
                names = labels.title(str(response)), labels.sentence(kind)
                rows.append([*names, cell, saving])
    head = ["Response", "Statistic", "Estimate and interval", "Slow runs alone per slow run"]
    numbers: list[Row] = []
    for name in ("pairs", "runs", "slow_seconds", "fast_seconds", "best_ratio"):
        units = result[name].attrs["units"].replace("1", "")
        meaning = labels.axis(labels.sentence(str(result[name].attrs["long_name"])), units)
        numbers.append([meaning, _cell(result[name].item())])
    tables = [
        Table("Statistics of the slow model", head, rows),
        Table("Runs and costs", ["Number", "Value"], numbers),
    ]
    if "slow_index" in result:
        tables.insert(1, _slow_indices(result))
    if "prediction" in result:
        tables.insert(0, _predictions(result))
    return tables


def _predictions(result: xr.Dataset) -> Table:
    """Return one row per point and response: its prediction, or why there is none."""
    from impactlab.study.multifidelity_prediction import interval_text, predicted_at

    rows: list[Row] = []
    for point in range(result.sizes["point"]):
        for response in result["response"].values:
            there = result.sel(response=response).isel(point=point)
            reason, units = (str(there[n].item()) for n in ("prediction_refusal", "response_units"))
            text = interval_text(there["prediction"].values.tolist(), units)
            cell = Cell("none", "warning", reason) if reason else Cell(text, "number")
            place = labels.sentence(", ".join(predicted_at(result, point)))
            rows.append([place, labels.title(str(response)), cell])
    title = "Predictions of the slow model, other parameters at their medians"
    return Table(title, ["Point", "Response", "Prediction and interval"], rows)


def _slow_indices(result: xr.Dataset) -> Table:
    """Return one row per response and parameter: its indices, or why there are none."""
    from impactlab.study.multifidelity_indices import stated_index

    rows: list[Row] = []
    for response in result["response"].values:
        alone, name = result.sel(response=response), labels.title(str(response))
        if reason := str(alone["index_refusal"].item()):
            rows.append([name, "all", *[Cell("none", "warning", reason)] * 2])
            continue
        for parameter in result["parameter"].values:
            shares = alone.sel(parameter=parameter)
            texts = [stated_index(values) for values in shares["slow_index"].values]
            text = labels.sentence(str(shares["parameter_long_name"].item()))
            rows.append([name, text, *(Cell(text, "number") for text in texts)])
    head = ["Response", "Parameter", "First order", "Total order"]
    return Table("Sobol indices of the slow model: shares of its variance", head, rows)


def answers_beside(runs: xr.Dataset, folder: Path) -> Iterator[tuple[str, str, str]]:
    """Yield subject, finding and page of the answers to questions in a study's folder.

    A result of another text of the study than the runs' says so in place of its finding.
    """
    for name, subject in (
        (RARE_EVENT, "Rare event"),
        (SIZING, "Design"),
        (MULTIFIDELITY, "Two models"),
    ):
        path = folder / f"{name}.nc"
        if not path.is_file():
            continue
        with suppress(ValueError, OSError):  # a damaged file has no answer
            result = read_netcdf(path, name)
            if not path.with_suffix(".html").is_file():
                if name != RARE_EVENT:
                    continue
                report_rare_event(result, folder)  # of runs that `until` has placed
            attrs = result.attrs
            headline, *lines = (line.removesuffix(".") for line in attrs["answer"].splitlines())
            cautions = [line for line in lines if line.startswith("Caution: ")]
            finding = ". ".join([headline, *cautions])
            if name == MULTIFIDELITY and "slow_model" in runs.attrs:
                finding = "every statistic, the pairs and the costs"
            if name == RARE_EVENT and "until_probability" in runs.attrs:
                finding = "the runs, the interval and the likeliest way"
            if attrs.get("study_sha256") != runs.attrs.get("study_sha256"):
                finding = "of an earlier text of this study, not of these runs"
            yield subject, finding, f"{name}.html"


def _drawings(result: xr.Dataset) -> list[Drawing]:
    return [(figure, (result, result)) for figure in FIGURES if figure.applies(result, result)]


def _cell(value: float) -> Cell:
    return Cell("–" if np.isnan(value) else labels.number(value), "number")


def _written(
    result: xr.Dataset,
    folder: Path,
    figures: Path,
    name: str,
    kind: str,
    command: str,
    sections: list[Section],
) -> Path:
    """Write the page of a result, whose answer's first sentence is the headline."""
    attrs = result.attrs
    headline, *rest = (line.removesuffix(".") for line in str(attrs["answer"]).splitlines())
    verdict = result["verdict"]
    word = str(verdict.attrs["flag_meanings"]).split()[int(verdict)]
    is_sound = word in str(verdict.attrs["sound_flags"]).split()
    study = attrs["study_file"].replace("../", "") or "STUDY"
    path = folder / f"{name}.html"
    write_listed(
        path,
        result.assign_attrs(title=f"{kind}: {attrs.get('title', '')}", content=name),
        figures,
        headline=headline,
        answers=[(subject, text) for subject, _, text in (line.partition(": ") for line in rest)],
        sections=sections,
        size=labels.counted(int(result["runs"]), "run"),
        failed="" if is_sound else word.replace("_", " "),
        reproduce=[(f"impactlab {command} {study}{attrs.get('arguments', '')}", "repeats it")],
        index=path.parent.with_name("index.html"),
    )
    return path
