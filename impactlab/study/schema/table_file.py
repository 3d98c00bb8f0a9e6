"""Study files of a table: a CSV file of runs made elsewhere, its columns, and their indices."""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainValidator,
    StrictStr,
    ValidationInfo,
)

from impactlab.methods.distributions import CHOICE, DISTRIBUTIONS, ENTRIES
from impactlab.methods.entries import Distribution, Entry
from impactlab.model.parameters import Parameter
from impactlab.model.quantities import si, si_units
from impactlab.study.schema.declarations import Declared, Intervals
from impactlab.study.schema.yaml_file import Source
from impactlab.study.table import GIVEN_DATA, OF_LIMITS, runs_of_table
from impactlab.validation.errors import Problem, StudyError, unknown
from impactlab.validation.fields import (
    FileSection,
    Heading,
    Text,
    Whole,
    by_name,
    name_at,
    names,
    quantity,
    validated,
)

_GAPS = ("", "na", "n/a", "nan", "null", "none")  # cells that hold no value, in small letters
_COMMA = re.compile(r"[+-]?\d+,\d+")
Cells = list[tuple[int, str]]
"""The cells of a column, each with its line in the file."""


def _check_unit(units: str) -> str:
    if units not in ("1", "%") and si_units(f"1 {units}") == "1":
        raise ValueError(f"unknown unit {units!r}: write one such as mm or kN, or leave it out")
    return units


class Column(FileSection):
    """A column of the CSV file. column: its head; "" for the name. units: those of its numbers."""

    column: Text = ""
    units: Annotated[Text, AfterValidator(_check_unit)] = "1"

    @property
    def si_units(self) -> str:
        """The units that the values have in results."""
        return si_units(f"1 {self.units}")


class InputColumn(Column):
    """The column of an input. distribution: the one that its values are said to have."""

    distribution: Any = None


def _stated(data: Any) -> Any:
    """Return the mapping that a column is, where a unit alone stands for it, or nothing."""
    return {} if data is None else {"units": data} if isinstance(data, str) else data


def _read_input(data: Any, info: ValidationInfo) -> InputColumn:
    """Read an input: nothing, its unit, or a mapping of head, unit and distribution."""
    stated = _stated(data)
    section = stated if isinstance(stated, dict) else {}
    section = {key: value for key, value in section.items() if key not in Column.model_fields}
    if not section:
        return InputColumn.model_validate(stated, context=info.context)
    about = {key: value for key, value in stated.items() if key not in section}
    column = Column.model_validate(about, context=info.context)
    kind = ENTRIES[name_at("distribution", [*DISTRIBUTIONS, CHOICE], section)]
    own = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    info.context["keys"][id(data)] = (*Column.model_fields, "distribution", *own)  # type: ignore[index]
    parameter = Parameter("value", column.si_units, "value", (), any_word=True)
    entry = kind.read(section, {**(info.context or {}), "parameter": parameter})
    return InputColumn(column=column.column, units=column.units, distribution=entry)


def _read_limits(data: Any, info: ValidationInfo) -> dict[str, float]:
    """Read limits by output, in SI units; the outputs are read before."""
    outputs = info.data.get("outputs")
    if outputs is None:
        return {}  # their mistakes are told
    units = {name: quantity(column.si_units) for name, column in outputs.items()}
    return by_name("Limits", units, data, info)


_Input = Annotated[InputColumn, PlainValidator(_read_input)]
_Output = Annotated[Column, BeforeValidator(_stated)]
_SOME = Field(min_length=1)


class TableFile(Heading):
    """The keys of a study of a table."""

    table: Annotated[Text, Field(min_length=1)]
    inputs: Annotated[dict[StrictStr, _Input], _SOME]
    outputs: Annotated[dict[StrictStr, _Output], _SOME]
    indices: Annotated[tuple[str, ...], names("index", GIVEN_DATA, OF_LIMITS)] = ("delta",)
    limits: Annotated[dict[str, float], PlainValidator(_read_limits)] = Field(default_factory=dict)
    seed: Annotated[Whole, Field(ge=0, le=2**32 - 1)] = 1
    analysis: Intervals = Field(default_factory=Intervals)


@dataclass(frozen=True)
class TableStudy(Declared):
    """Runs that are made already: the rows of a CSV file, and the indices that are wanted of them.

    table: the CSV file, as seen from the folder of the study. inputs, outputs: its columns, by
    their names in results. limits: of outputs, in SI units. seed: of the order of the rows, and of
    resamples.
    """

    table: str
    inputs: Mapping[str, InputColumn]
    outputs: Mapping[str, Column]
    indices: tuple[str, ...]
    limits: Mapping[str, float]
    seed: int
    analysis: Intervals

    @property
    def csv(self) -> Path:
        """The CSV file."""
        return self.path.parent / self.table

    @property
    def size(self) -> str:
        """Describe the amount of work."""
        return f"table {Path(self.table).name}"


def table_study(source: Source) -> TableStudy:
    """Return the study of a file with the key `table`. Raises StudyError naming the keys."""
    file = validated(TableFile, source.data, str(source.path))
    return TableStudy(name=source.name, path=source.path, text=source.text, **dict(file))


def runs_of_file(study: TableStudy) -> Any:
    """Return the runs of a study of a table, as `runs_of_table` makes them, with units.

    Raises StudyError naming line and column of the CSV file, or what does not suit the indices.
    """
    heads, rows = _read_csv(study.csv)
    cells = _columns(study, heads, rows)
    inputs = {name: _input(study, name, cells[name]) for name in study.inputs}
    outputs = {
        name: _numbers(study.csv, name, column, cells[name], gaps=True)
        for name, column in study.outputs.items()
    }
    options: Any = {"indices": study.indices, "limits": study.limits, "seed": study.seed}
    try:
        runs = runs_of_table(inputs, outputs, title=study.name, **options)
    except ValueError as error:
        raise StudyError(Problem(str(study.csv), "", str(error))) from None
    for name, column in {**study.inputs, **study.outputs}.items():
        if runs[name].dtype.kind == "f":
            runs[name].attrs["units"] = column.si_units
    for name, column in study.inputs.items():
        if column.distribution is not None:
            runs[name].attrs |= column.distribution.arguments()
    settings = study.analysis.model_dump() | {"table": study.table}
    return runs.assign_attrs(study.attributes() | settings)


def _read_csv(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the heads, and the rows that are not blank, each with its line in the file."""
    problem = ""
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        problem = f"cannot be read: {error.strerror}"
    except UnicodeDecodeError:
        problem = "is not text in UTF-8: save it as such"
    if problem:
        raise StudyError(Problem(str(path), "", problem))
    first = text.lstrip().partition("\n")[0]
    reader = csv.reader(io.StringIO(text), delimiter=max(",;\t", key=first.count), strict=True)
    try:
        lines = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise StudyError(Problem(str(path), f"line {reader.line_num}", f"{error}")) from None
    lines = [(number, row) for number, row in lines if any(row)]
    if len(lines) < 2:
        reason = "has a line of heads and no rows" if lines else "is empty"
        raise StudyError(Problem(str(path), "", f"{reason}: give heads, and a row per run"))
    heads = lines[0][1]
    if twice := [head for place, head in enumerate(heads) if head and head in heads[:place]]:
        raise StudyError(
            Problem(str(path), "", f"has two columns {twice[0]!r}: give each a head of its own")
        )
    for number, row in lines[1:]:
        if len(row) != len(heads):
            reason = f"has {len(row)} cells, and the heads are {len(heads)}: give as many"
            raise StudyError(Problem(str(path), f"line {number}", reason))
    return heads, lines[1:]


def _columns(
    study: TableStudy, heads: Sequence[str], rows: Sequence[tuple[int, list[str]]]
) -> dict[str, Cells]:
    """Return the cells of each column. Raises StudyError with every one that is missing."""
    problems, cells = [], {}
    for kind, columns in (("inputs", study.inputs), ("outputs", study.outputs)):
        for name, column in columns.items():
            head = column.column or name
            if head in heads:
                place = heads.index(head)
                cells[name] = [(number, row[place]) for number, row in rows]
            else:
                reason = f"{unknown('column', head, heads)} ({study.csv})"
                problems.append(Problem(str(study.path), f"{kind}.{name}", reason))
    if problems:
        raise StudyError(*problems)
    return cells


def _input(study: TableStudy, name: str, cells: Cells) -> NDArray[Any]:
    """Return the words or numbers of an input, which its distribution can have if one is stated."""
    column = study.inputs[name]
    distribution, path = column.distribution, study.csv
    if empty := [line for line, cell in cells if cell.lower() in _GAPS]:
        reason = "is empty, and an input has a value in every run: leave out the row"
        raise _at_cell(path, name, empty[0], reason)
    worded = not any(_is_number(cell) for _, cell in cells)
    if isinstance(distribution, Entry) and not isinstance(distribution, Distribution):
        listed = distribution.arguments()["values"]
        for line, cell in cells:
            if cell not in listed:
                reason = unknown("word", cell, listed)
                raise StudyError(Problem(str(path), f"line {line}, {name}", reason, cell))
        if absent := set(listed) - {cell for _, cell in cells}:
            reason = f"no row holds {min(absent)!r}: leave it out"
            raise StudyError(Problem(str(study.path), f"inputs.{name}.values", reason))
        return np.array([cell for _, cell in cells])
    if worded and distribution is None and column.units == "1":
        return np.array([cell for _, cell in cells])
    values = _numbers(path, name, column, cells)
    if distribution is not None:
        low, high = (distribution.bounds().get(key, np.nan) for key in ("low", "high"))
        for (line, cell), value in zip(cells, values, strict=True):
            if value < low or value > high:
                unit = "" if column.units == "1" else f" {column.units}"
                reason = f"{cell}{unit} is outside the distribution that the study states"
                raise _at_cell(path, name, line, f"{reason}: correct one of them")
    return values


def _numbers(
    path: Path, name: str, column: Column, cells: Cells, *, gaps: bool = False
) -> NDArray[np.float64]:
    """Return a column's numbers in SI units, exact in decimals; NaN where a cell is empty."""
    values = np.full(len(cells), np.nan)
    unit = "" if column.units == "1" else f" {column.units}"
    for place, (line, cell) in enumerate(cells):
        if gaps and cell.lower() in _GAPS:
            continue
        if not _is_number(cell):
            hint = f": write {cell.replace(',', '.')}" if _COMMA.fullmatch(cell) else ""
            raise _at_cell(path, name, line, f"{cell!r} is no finite number{hint}")
        values[place] = si(f"{cell}{unit}", column.si_units) if unit else float(cell)
    return values


def _is_number(cell: str) -> bool:
    try:
        return isfinite(float(cell)) and "_" not in cell
    except ValueError:
        return False


def _at_cell(path: Path, name: str, line: int, reason: str) -> StudyError:
    return StudyError(Problem(str(path), f"line {line}, {name}", reason))
