"""Runs from a table: a design made elsewhere, or measurements, for the indices of given data."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray

from impactlab.methods import INDICES, SAMPLES
from impactlab.methods.distributions import CHOICE
from impactlab.methods.hypercube import FEWEST_OF_WORD, Hypercube
from impactlab.methods.record import Indices
from impactlab.methods.sampling import Table as TableSample
from impactlab.validation.errors import unknown
from impactlab.validation.fields import LABEL

_OF_CLASSES = ("delta", "pawn")  # indices that divide the values into classes
_LARGEST_TIE = 0.05  # share of the runs with one value, from which on classes would mix values
_TAKEN = ("run", "row", "status", "response", "parameter")  # names of the dataset's own
_UNLIKELY = 4.0  # standard errors of a rank correlation that chance does not make

_RECORDS = [
    record for kind in SAMPLES.values() if issubclass(kind, Hypercube) for record in kind.records
]
GIVEN_DATA = tuple(record.name for record in _RECORDS if not record.of_limits)
"""Names of the indices that any table can have."""
OF_LIMITS = tuple(record.name for record in _RECORDS if record.of_limits)
"""Names of those that need the limit of a response."""
Table = Mapping[str, Any]
"""Columns by name: a mapping, a pandas DataFrame or an xarray Dataset."""


def runs_of_table(
    inputs: Table,
    outputs: Table,
    *,
    indices: str | Sequence[str] = "delta",
    limits: Mapping[str, float] | None = None,
    seed: int = 1,
    title: str = "table",
) -> xr.Dataset:
    """Make runs of a table of inputs and outputs, for `analyse`, `answers`, `table` and `plot`.

    The rows may come from any design, or from measurements, provided that they are independent
    draws or spread more evenly; each counts the same, so weighted rows have to be drawn again by
    their weights. The answers name pairs of inputs whose rank correlation is too large for chance.

    Parameters
    ----------
    inputs : mapping, pandas.DataFrame or xarray.Dataset
        Numbers or words by name of the parameter, (rows,).
    outputs : mapping, pandas.DataFrame or xarray.Dataset
        Numbers by name of the response, (rows,); with a NaN its verdict is `failed_runs`.
    indices : str or sequence of str, default "delta"
        Indices of given data, as those of `Latin`; the first one ranks the parameters.
    limits : mapping of str to float, optional
        Limit by response, for "target_hsic": what decides whether the response exceeds it.
    seed : int, default 1
        Seed of the resamples and of the order of the rows.
    title : str, default "table"
        Name for messages and answers.

    Returns
    -------
    xarray.Dataset
        The table on `run`, in random order (rows that are sorted by one input would else add its
        share to equal values), with each row's number on the coordinate `row`.

    Raises
    ------
    ValueError
        If the table does not suit the indices: the message names the column.

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> inputs = {"speed": rng.uniform(1, 5, 200), "law": rng.choice(["a", "b"], 200)}
    >>> outputs = {"force": inputs["speed"] + (inputs["law"] == "a")}
    >>> runs = il.runs_of_table(inputs, outputs, indices=["delta", "pawn"])
    >>> il.analyse(runs).delta.isel(response=0).argmax("parameter").item()
    0
    """
    limits = dict(limits or {})
    records = _records(indices, limits)
    parameters = {str(name): np.asarray(inputs[name]) for name in inputs}
    responses = {str(name): np.asarray(outputs[name]) for name in outputs}
    rows = _check_shape(parameters, responses)
    for name in [name for name in limits if name not in responses]:
        raise ValueError(f"limits: {name!r} {unknown('response', name, responses)}")
    _check_size(records, title, rows, len(parameters))
    order = np.random.default_rng(seed).permutation(rows)
    columns = {
        name: ("run", *_column(name, values, records, order)) for name, values in parameters.items()
    }
    variables = {
        name: ("run", _outputs(name, values)[order], {"units": "1", "long_name": name})
        for name, values in responses.items()
    }
    numbers = {n: parameters[n] for n, entry in columns.items() if "distribution" not in entry[2]}
    attrs = {"study": title, "title": title, "method": TableSample.name(), "seed": seed} | {
        "indices": [record.name for record in records],
        "varied": list(parameters),
        "responses": list(responses),
        "analyses": "sensitivity",
    }
    if limits:
        attrs |= {"limited": list(limits), "limits": list(map(float, limits.values()))}
    status = {"status": ("run", np.zeros(rows, np.int32))}
    axes = {"run": np.arange(rows), "row": ("run", order, {"long_name": "row of the table"})}
    attrs |= _correlations(numbers)
    return xr.Dataset(variables | status, axes | columns, attrs)


def _records(indices: str | Sequence[str], limits: Mapping[str, float]) -> list[Indices]:
    names, choices = (
        [indices] if isinstance(indices, str) else list(indices),
        GIVEN_DATA + OF_LIMITS,
    )
    if not names:
        raise ValueError(f"indices is empty: choose from {', '.join(choices)}")
    for name in names:
        if name not in choices:
            raise ValueError(f"indices: {name!r} {unknown('index of given data', name, choices)}")
        if names.count(name) > 1:
            raise ValueError(f"indices names {name} more than once: name it once")
    if missing := not limits and [name for name in names if name in OF_LIMITS]:
        raise ValueError(f"indices: {missing[0]} needs `limits`: state that of a response")
    if limits and not set(names) & set(OF_LIMITS):
        raise ValueError(
            f"limits are for {', '.join(OF_LIMITS)}: list it in indices, or leave them out"
        )
    return [INDICES[name] for name in names]


def _check_size(records: list[Indices], title: str, rows: int, inputs: int) -> None:
    for record in records:
        if rows < record.fewest:
            raise ValueError(
                f"{title}: {rows} rows are too few for {record.name}: give {record.fewest} or more"
            )
        if record.most and inputs > record.most:
            raise ValueError(
                f"{title}: {inputs} inputs are too many for {record.name}: give at most "
                f"{record.most}"
            )


def _check_shape(inputs: dict[str, NDArray[Any]], outputs: dict[str, NDArray[Any]]) -> int:
    """Return the number of rows. Raises ValueError for a table without columns or of odd ones."""
    for kind, columns in (("inputs", inputs), ("outputs", outputs)):
        if not columns:
            raise ValueError(f"{kind} has no columns: give one or more")
        for name, values in columns.items():
            if not LABEL.fullmatch(name) or name in _TAKEN:
                raise ValueError(
                    f"{kind}: {name!r} cannot name a column: use letters, digits, _ and -, "
                    f"starting with a letter or a digit, and not {', '.join(_TAKEN)}"
                )
            if values.ndim != 1:
                raise ValueError(f"{kind}: {name} has {values.ndim} dimensions: give it one")
    if twice := inputs.keys() & outputs.keys():
        raise ValueError(f"outputs: {min(twice)} names an input, too: rename it")
    sizes = {name: values.size for name, values in (inputs | outputs).items()}
    first, rows = next(iter(sizes.items()))
    for name, size in sizes.items():
        if size != rows:
            raise ValueError(f"{name} has {size} rows and {first} has {rows}: give as many")
    return rows


def _column(
    name: str, values: NDArray[Any], records: Sequence[Indices], order: NDArray[np.int64]
) -> tuple[NDArray[Any], dict[str, Any]]:
    """Return an input in the order of the runs, and its attributes."""
    long_name = {"long_name": name.replace("_", " ")}
    if values.dtype.kind in "OUSTb":
        words, counts = _words(name, values)
        if ordered := [record for record in records if record.order]:
            raise ValueError(
                f"inputs: {name} holds words, which have no order, and {ordered[0].name} "
                f"{ordered[0].order}: leave out the column or these indices"
            )
        attrs = {
            "distribution": CHOICE,
            "values": list(np.unique(words)),
            "weights": counts / len(words),
        }
        return words[order], long_name | attrs
    if values.dtype.kind not in "iuf" or not np.isfinite(values).all():
        raise ValueError(
            f"inputs: {name} holds a value that is no finite number: leave out its row"
        )
    _, counts = np.unique(values, return_counts=True)
    if len(counts) < 2:
        raise ValueError(f"inputs: {name} holds one value alone: leave out the column")
    tied = counts.max() > _LARGEST_TIE * len(values)
    if classes := [record.name for record in records if tied and record.name in _OF_CLASSES]:
        raise ValueError(
            f"inputs: {name} holds one number in {counts.max()} of {len(values)} rows, which the "
            f"classes of {classes[0]} cannot divide: give it as words, such as 'n=3'"
        )
    return values.astype(float)[order], long_name | {"units": "1"}


def _words(name: str, values: NDArray[Any]) -> tuple[NDArray[np.str_], NDArray[np.int64]]:
    """Return words, (rows,), and how many rows hold each, in the order of `np.unique`."""
    if odd := [value for value in values if not isinstance(value, str | bool | np.bool_)]:
        raise ValueError(f"inputs: {name} holds {odd[0]!r} among words: leave out its row")
    words = values.astype(str)
    unique, counts = np.unique(words, return_counts=True)
    if len(unique) < 2:
        raise ValueError(f"inputs: {name} holds one word alone: leave out the column")
    if counts.min() < FEWEST_OF_WORD:
        raise ValueError(
            f"inputs: {name} holds {str(unique[counts.argmin()])!r} in {counts.min()} rows, and "
            f"{FEWEST_OF_WORD} are needed: leave out these rows, or join it with another word"
        )
    return words, counts


def _outputs(name: str, values: NDArray[Any]) -> NDArray[np.float64]:
    if values.dtype.kind not in "iufb":
        raise ValueError(
            f"outputs: {name} holds no numbers: give numbers, NaN where one is missing"
        )
    return values.astype(float)


def _correlations(numbers: Mapping[str, NDArray[np.float64]]) -> dict[str, Any]:
    """Return the attributes that name pairs whose rank correlation chance does not explain."""
    names, ranks = [], []
    for (first, values), (second, others) in combinations(numbers.items(), 2):
        rank = float(scipy.stats.spearmanr(values, others).statistic)
        if abs(rank) > _UNLIKELY / np.sqrt(len(values) - 1):
            names.append(f"{first} {second}")
            ranks.append(round(rank, 2))
    return {"correlated": names, "rank_correlations": ranks} if names else {}
