"""Tables for people: runs, sensitivity indices, comparisons and answers, as frames and as files.

Numbers are in SI units under the names of the datasets, with the unit in the column's head. LaTeX,
which is for print, has the names, units and digits of the figures, for booktabs and siunitx.
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
from impactlab.solver.outputs import GROWING
from impactlab.validation.errors import unknown
from impactlab.variables import FLAGS, MARKED, status_bits

if TYPE_CHECKING:
    from pandas import DataFrame
import re
import textwrap

from impactlab.types import Floats

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
    for name in GROWING if "strike" in runs.dims else ():
        columns[name] = _labelled(access.usable(runs, name), labels.title(name))
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
        raise ValueError(f"to = {kind!r}: {unknown('format', kind, SUFFIXES)}")
    if (package := _NEEDED.get(kind)) and find_spec(package) is None:
        raise OSError(f"to = {kind!r}: needs {package}: pip install 'impactlab[tables]'")
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


_PREAMBLE = r"% Needs \usepackage{booktabs,longtable,siunitx}" + "\n"
_PLAIN = (1e-3, 1e6)  # magnitudes that are written without a power of ten
_SHARE = 0.01  # largest size from which pure numbers have three decimals
_WIDTH = 14  # letters of a line of a head
_WIDTHS = {60: r"0.9\linewidth", 20: "10em"}  # by letters, of texts that break into lines
_RAGGED = r">{\raggedright\arraybackslash}"
_MISSING = "{--}"
_ESCAPES = str.maketrans(
    {letter: rf"\{letter}" for letter in "&%$#_{}"}
    | {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
    | {"<": r"\textless{}", ">": r"\textgreater{}", "\N{NO-BREAK SPACE}": "~"}
    | {"−": "$-$", "×": r"$\times$", "±": r"$\pm$", "∞": r"$\infty$", "≥": r"$\geq$"}
    | {"⁻⁰¹²³⁴⁵⁶⁷⁸⁹"[n]: rf"\textsuperscript{{{'-0123456789'[n]}}}" for n in range(11)}
    | {"ρ": r"$\rho$", "σ": r"$\sigma$", "µ": r"\textmu{}"}
)


def write_latex(
    table: Mapping[str, xr.DataArray], path: Path, caption: str, study: str, name: str
) -> None:
    """Write a table that breaks across pages, labelled `tab:STUDY-NAME`.

    table: columns in SI units by name, each with its `label` and, of words, perhaps their `names`.
    """
    import pandas as pd

    arrays = xr.broadcast(*table.values())
    named = [array.rename(key) for key, array in zip(table, arrays, strict=True)]
    cells, heads, formats = zip(*map(_column, named), strict=True)
    frame = pd.DataFrame(dict(enumerate(cells)))
    text = (
        frame.style.hide(axis="index")
        .format_index(heads.__getitem__, axis="columns")
        .to_latex(
            environment="longtable",
            column_format="".join(formats),
            hrules=True,
            siunitx=True,  # heads of columns of numbers stand in braces
            caption=escaped(caption),
            label=f"tab:{study}-{name}",
        )
    )
    path.write_text(f"{_PREAMBLE}\\begingroup\\small\n{text}\\endgroup\n", encoding="utf-8")


def escaped(text: str) -> str:
    """Return a text as LaTeX prints it."""
    return text.translate(_ESCAPES)


def _column(array: xr.DataArray) -> tuple[list[str], str, str]:
    """Return the cells of a column, its head and its format."""
    label, flat = str(array.attrs["label"]), range(array.size)
    if array.dtype.kind not in "if":
        names = array.attrs.get("names", {})
        texts = labels.values(array, flat, short=True)
        cells = [
            escaped(names.get(str(value), text))
            for value, text in zip(array.values.flat, texts, strict=True)
        ]
        longest = max(map(len, cells), default=0)
        width = next((width for least, width in _WIDTHS.items() if longest > least), "")
        return cells, _head(label), rf"{_RAGGED}p{{{width}}}" if width else "l"
    display = labels.display(array)
    cells = _numbers(display(array.values.ravel()), pure=not display.symbol)
    return cells, _head(label, _unit(display.symbol)), f"S[table-format={_shape(cells)}]"


def _head(label: str, unit: str = "") -> str:
    """Return a head of short lines, its unit in the last."""
    lines = [escaped(line) for line in textwrap.wrap(label, _WIDTH, break_long_words=False)]
    if unit:
        lines.append(rf"(\unit{{{unit}}})")
    return r"\shortstack{" + r"\\".join(lines) + "}" if len(lines) > 1 else "".join(lines)


def _unit(symbol: str) -> str:
    """Return a unit as siunitx reads it: "m/s^{2}" for "m/s²"."""
    plain = symbol.translate(str.maketrans("²³", "23"))
    raised = re.sub(r"(?<=[a-zA-Z])(-?\d+)", r"^{\1}", plain)
    return raised.replace(" ", ".").replace("%", r"\percent").replace("µ", r"\micro ")


def _numbers(values: Floats, *, pure: bool) -> list[str]:
    """Return numbers of four digits, pure ones (shares, counts) of three decimals or none.

    All have a power of ten where one of them needs it.
    """
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    least, largest = sizes.min(initial=1.0), sizes.max(initial=0.0)
    if (sizes == np.round(sizes)).all() and largest < _PLAIN[1]:
        texts = [f"{value:.0f}" for value in values]
    elif pure and largest >= _SHARE:
        texts = [f"{value:.3f}" for value in values]
    elif _PLAIN[0] <= least and largest < _PLAIN[1]:
        exact = all(float(f"{value:.4g}") == value for value in values[np.isfinite(values)])
        texts = [f"{value:.4g}" if exact else f"{value:#.4g}".rstrip(".") for value in values]
        texts = [f"{float(text):.0f}" if "e" in text else text for text in texts]
    else:
        texts = [f"{value:.3e}" for value in values]
    finite = np.isfinite(values).tolist()
    return [text if given else _MISSING for text, given in zip(texts, finite, strict=True)]


def _shape(cells: list[str]) -> str:
    """Return the sign and the digits that a column of numbers needs, as siunitx writes them."""
    parts = [re.fullmatch(r"(-?)(\d+)\.?(\d*)(?:e([+-])(\d+))?", cell) for cell in cells]
    numbers = [part.groups(default="") for part in parts if part]
    if not numbers:
        return "1.0"
    sign = "-" if any(negative for negative, *_ in numbers) else ""
    digits = [max(len(number[place]) for number in numbers) for place in (1, 2, 4)]
    power = f"e-{digits[2]}" if digits[2] else ""
    return f"{sign}{digits[0]}.{digits[1]}{power}"
