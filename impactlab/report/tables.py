"""Tables for people: runs, sensitivity indices, comparisons and answers, as frames and as files.

Numbers are in SI units under the names of the datasets, with the unit in the column's head. LaTeX,
which is for print, has the names, units and digits of the figures (latex.py).
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.files import replaced
from impactlab.methods import FAMILIES, INDICES
from impactlab.report.answer import answers
from impactlab.report.latex import write_latex
from impactlab.validation.errors import unknown
from impactlab.variables import FLAGS, MARKED, status_bits

if TYPE_CHECKING:
    from pandas import DataFrame

log = logging.getLogger(__name__)

Columns = dict[str, xr.DataArray]
SUFFIXES = {"csv": ".csv", "xlsx": ".xlsx", "parquet": ".parquet", "latex": ".tex"}
"""Suffixes of the formats of `export`."""
_NEEDED = {"xlsx": "openpyxl", "parquet": "pyarrow"}
_SHEET = 1_048_575  # most rows of a sheet, beside its head
_PRINTED = 1000  # most rows of a table for print


def table(data: xr.Dataset, responses: Sequence[str] = ()) -> DataFrame:
    """Return runs, sensitivity indices or comparisons as a table.

    Parameters
    ----------
    data : xarray.Dataset
        Runs of a study, of `il.simulate` or `il.simulate_many`, the result of `il.analyse`, or the
        findings of a verification.
    responses : sequence of str, optional
        Names of the responses; by default all that the study asks for.

    Returns
    -------
    pandas.DataFrame
        One row per run, with the varied parameters and the responses; per response and parameter,
        with the indices and the half-widths of their intervals; or per comparison. In SI units,
        which the heads state: ``peak_force (N)``. ``status`` and ``remarks`` name the flags of each
        run, where any is set.

    Raises
    ------
    ValueError
        If a response is unknown, or an analysis has no sensitivity indices.

    Examples
    --------
    >>> runs = il.simulate_many(
    ...     il.paper_impact(), il.Discretisation(nodes=41), duration="10 ms",
    ...     varied={"velocity": ["1 m/s", "2 m/s"]})
    >>> il.table(runs, ["peak_force"]).columns.tolist()
    ['run', 'velocity (m s-1)', 'peak_force (N)']
    """
    return _frame(columns(data, responses))


def _frame(table: Columns) -> DataFrame:
    import pandas as pd

    heads = [
        name if (unit := array.attrs.get("units", "1")) == "1" else f"{name} ({unit})"
        for name, array in table.items()
    ]
    arrays = xr.broadcast(*table.values())
    return pd.DataFrame(
        {head: array.values.ravel() for head, array in zip(heads, arrays, strict=True)}
    )


def columns(data: xr.Dataset, responses: Sequence[str] = ()) -> Columns:
    """Return the columns of a table by name, in SI units, each with its `label` for print.

    data, responses: see `table`, and its errors.
    """
    if "comparison" in data.dims:
        names = [str(name) for name in (*data.coords, *data.data_vars)]
        return {
            name: _labelled(data[name], labels.title(name))
            for name in names
            if data[name].dims == ("comparison",)
        }
    is_analysis = "response" in data.coords
    known = data["response"].values.tolist() if is_analysis else access.responses(data)
    for name in responses:
        if name not in known:
            raise ValueError(f"responses: {name!r}: {unknown('response', name, known)}")
    names = [name for name in known if name in responses or not responses]
    return _of_indices(data, names) if is_analysis else _of_runs(data, names)


def _labelled(array: xr.DataArray, label: str, **names: str) -> xr.DataArray:
    return array.assign_attrs(label=label, names=names)


def _of_runs(runs: xr.Dataset, names: list[str]) -> Columns:
    dims = {*access.design_dims(runs)}
    varied = access.varied(runs) or [
        str(name) for name, array in runs.coords.items() if dims.intersection(array.dims)
    ]
    keys = dict.fromkeys([*(["run"] if "run" in runs.coords else []), *varied])
    columns = {
        name: _labelled(runs[name], labels.sentence(labels.parameter(runs[name]))) for name in keys
    }
    for name in names:
        values = access.usable(runs, name)
        columns[name] = _labelled(values.assign_attrs(runs[name].attrs), labels.title(name))
    for name, bits in (("status", status_bits(names) | MARKED), ("remarks", -1)):
        if name in runs and bool((flags := runs[name] & bits).any()):
            columns[name] = _labelled(_named(flags, name), labels.title(name))
    return columns


def _named(flags: xr.DataArray, name: str) -> xr.DataArray:
    """Return the names of the flags that are set in each run, "" where none is."""
    values, places = np.unique(flags.values, return_inverse=True)
    meanings = FLAGS[name][1].items()
    texts = [" ".join(flag for flag, (bit, _) in meanings if value & bit) for value in values]
    return xr.DataArray(np.array(texts)[places].reshape(flags.shape), dims=flags.dims)


def _of_indices(analysis: xr.Dataset, names: list[str]) -> Columns:
    families = [family for family in FAMILIES if family.given(analysis)]
    shown = [measure for family in families for measure in family.measures_in(analysis)]
    if not shown:
        raise ValueError("the analysis has no sensitivity indices: samples have some, grids none")
    of_these = analysis.sel(response=names)
    parameters = dict(zip(measures.parameters(analysis), measures.meanings(analysis), strict=True))
    titles = {name: labels.title(name) for name in names}
    columns = {
        "response": _labelled(of_these["response"], "Response", **titles),
        "parameter": _labelled(of_these["parameter"], "Parameter", **parameters),
    }
    own_units = all("units" in analysis[measure.name].attrs for measure in shown)
    if "response_units" in analysis and not own_units:
        columns["units"] = _labelled(of_these["response_units"], "Unit")
    for measure in shown:
        columns[measure.name] = _labelled(of_these[measure.name], labels.sentence(measure.label))
        if (interval := f"{measure.name}_interval") in analysis:
            columns[interval] = _labelled(of_these[interval], "±")
    verdicts = [f"{name}_verdict" for name in INDICES if f"{name}_verdict" in analysis]
    for name in verdicts or [access.VERDICT]:
        words = np.array(analysis[name].attrs["flag_meanings"].split())[of_these[name].values]
        columns[name] = _labelled(xr.DataArray(words, dims="response"), labels.title(name))
    return columns


def export(
    runs: xr.Dataset,
    analysis: xr.Dataset | None,
    folder: Path,
    kind: str,
    responses: Sequence[str] = (),
) -> list[Path]:
    """Write the tables of a study: runs or comparisons, indices if there are any, and answers.

    runs, analysis: as in runs.nc and analysis.nc, or as in findings.nc and None. folder: gets a
    file per table, or a workbook named after the study. kind: one of SUFFIXES. responses: see
    `table`. Returns the files.

    Raises ValueError for an unknown format or response, and for too many rows of a workbook;
    OSError where a package is not installed, or a file cannot be written.
    """
    if kind not in SUFFIXES:
        raise ValueError(f"--to = {kind!r}: {unknown('format', kind, SUFFIXES)}")
    if (package := _NEEDED.get(kind)) and find_spec(package) is None:
        raise OSError(f"--to {kind}: needs {package}: pip install 'impactlab[tables]'")
    tables = {"runs" if analysis is not None else "comparisons": columns(runs, responses)}
    if analysis is not None and access.VERDICT in analysis:
        tables["indices"] = columns(analysis, responses)
    sentences = xr.DataArray(answers(runs, analysis), dims="answer")
    tables["answers"] = {"answer": _labelled(sentences, "Answer")}
    study, title = str(runs.attrs["study"]), str(runs.attrs.get("title", ""))
    if kind == "xlsx":
        path = folder / f"{study}.xlsx"
        _write_workbook({name: _frame(table) for name, table in tables.items()}, path)
        return [path]
    paths = []
    for name, table in tables.items():
        path = folder / f"{name}{SUFFIXES[kind]}"
        rows = xr.broadcast(*table.values())[0].size
        if kind == "latex" and (name == "comparisons" or rows > _PRINTED):
            log.warning("%s: not written: the table is too long for print: take csv", path)
            continue
        with replaced(path) as unfinished:
            if kind == "latex":
                write_latex(table, unfinished, f"{labels.sentence(name)}: {title}", study, name)
            elif kind == "parquet":
                _frame(table).to_parquet(unfinished, index=False)
            else:
                _frame(table).to_csv(unfinished, index=False, lineterminator="\n")
        paths.append(path)
    return paths


def _write_workbook(frames: Mapping[str, DataFrame], path: Path) -> None:
    """Write a sheet per table, its head frozen. Raises ValueError where one has too many rows."""
    import pandas as pd

    if (rows := max(map(len, frames.values()))) > _SHEET:
        raise ValueError(f"{path}: {rows:,} rows, but a sheet has at most {_SHEET:,}: take csv")
    with replaced(path) as unfinished, pd.ExcelWriter(unfinished, engine="openpyxl") as writer:
        for name, frame in frames.items():
            frame.to_excel(writer, sheet_name=name, index=False, freeze_panes=(1, 0))
            sheet = writer.sheets[name]
            for column in sheet.iter_cols():
                sheet.column_dimensions[column[0].column_letter].width = (
                    len(str(column[0].value)) + 3
                )
                for cell in column:
                    if cell.data_type == "f":  # a text that begins with "=" is no formula
                        cell.data_type = "s"
