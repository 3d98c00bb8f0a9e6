"""Functions of the user: as responses of an impact, or as a model in place of the solver.

A study holds them by keys, NAME@FINGERPRINT, under which this process knows them; workers are sent
what they need with each batch.
"""

import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from numbers import Real
from threading import Lock
from typing import Any

import cloudpickle
import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import PARAMETERS, SECTION, WORDS, with_values
from impactlab.model.section import section_values
from impactlab.study.schema.declarations import AnyStudy, FunctionStudy
from impactlab.study.shard import Array, Columns
from impactlab.study.solvers import Solver, flattened, on_design
from impactlab.study.solvers.fingerprint import fingerprint
from impactlab.study.store import OutputSpec
from impactlab.variables import FLAGS, RESPONSES, STILL_GROWING

_NUMBERS = {"f": "f8", "i": "i8"}
"""Types of numbers in cases, by the kind of those that are drawn."""
_COST = 3e6  # cost of calling functions once, about 10 ms


@dataclass(frozen=True)
class Function:
    """A Python function as a response or as a model, with the unit of its result.

    Parameters
    ----------
    call : callable
        Function of the dataset of one impact (see `simulate`), or of a model's parameters by name;
        returns a number, NaN where there is none.
    units : str or mapping of str to str, optional
        SI unit of the result, as "N" or "m s-1", or of each response by name where a model returns
        several. By default an array of xarray keeps its attribute `units`, and a number has "1".
        Arithmetic with arrays drops units, so its results need one.
    long_name : str, optional
        Name for labels.
    version : str, optional
        Stored answers of another version are not reused; by default a hash of the code and of all
        that it uses.
    vectorized : bool, default False
        Whether a model takes many runs at once: arrays, (runs,), of its parameters, and returns
        arrays as long. The runs of a call are those of a batch, in any number.

    Examples
    --------
    >>> def mean_force(run):
    ...     return run.impulse / run.total_contact_time
    >>> force = il.Function(mean_force, units="N", long_name="mean contact force")
    """

    call: Callable[..., Any]
    units: str | Mapping[str, str] | None = None
    long_name: str = ""
    version: str | None = None
    vectorized: bool = False

    def unit(self, response: str) -> str:
        """Return the stated unit of a response.

        Parameters
        ----------
        response : str
            Name of the response.

        Returns
        -------
        str
            SI unit; empty where none is stated.
        """
        stated = self.units.get(response) if isinstance(self.units, Mapping) else self.units
        return stated or ""


@dataclass(frozen=True)
class Task:
    """The functions of a study, by the name of the response, or one under "" for a model.

    samples: of the histories that responses are given. parameters, responses: of a model.
    """

    functions: Mapping[str, Function]
    samples: int = 0
    parameters: tuple[str, ...] = ()
    responses: tuple[str, ...] = ()

    @property
    def unit_columns(self) -> list[str]:
        """Return the columns for units that are not stated."""
        functions = {name: self.functions[""] for name in self.responses} or self.functions
        return [_UNIT + name for name, function in functions.items() if not function.unit(name)]


KNOWN: dict[str, Function] = {}
"""Functions that studies of this process were built with, by their keys."""
TASKS: dict[str, Task] = {}
"""The same for solvers, by their names."""
_UNIT = "unit of "
"""Prefix of the column with the units that a function returned; no answer can have such a name."""
_UNITS = np.dtype("U64")  # the same in every shard


def register(name: str, function: Function | Callable[..., Any]) -> str:
    """Return the key of a function. Raises ValueError with the reason where it cannot be used."""
    function = function if isinstance(function, Function) else Function(function)
    if not callable(function.call):
        raise ValueError(
            f"is of type {type(function.call).__name__}: expected a function, or il.Function"
        )
    version = function.version or fingerprint(function.call)
    try:
        cloudpickle.dumps(function.call)
    except Exception as error:  # whatever its content raises
        raise ValueError(f"cannot be sent to workers ({error})") from None
    kind = " vectorized" * function.vectorized
    digest = sha256(f"{version} {function.units}{kind}".encode()).hexdigest()[:16]
    KNOWN[f"{name}@{digest}"] = function
    return f"{name}@{digest}"


def solver_name(study: AnyStudy) -> str:
    """Return the name of the solver of a study with functions of the user; it is known from now.

    Raises ValueError where a function, or what it uses, has changed since the study was built.
    """
    keys = [study.function] if isinstance(study, FunctionStudy) else list(study.python.values())
    for key in keys:
        if register(key.partition("@")[0], KNOWN[key]) != key:
            raise ValueError(f"{key}: has changed since the study was built: build it again")
    if isinstance(study, FunctionStudy):
        names = tuple(study.sampling.parameters)
        task = Task({"": KNOWN[study.function]}, 0, names, study.responses)
    else:
        functions = {name: KNOWN[key] for name, key in study.python.items()}
        task = Task(functions, study.store.samples)
    form = f"{keys} {task.samples} {task.parameters} {task.responses} with units"
    name = f"own {sha256(form.encode()).hexdigest()}"
    TASKS[name] = task
    return name


def solver(name: str) -> Solver:
    """Return the solver of this name. Raises ValueError where its functions are not known."""
    if name not in TASKS:
        raise ValueError(
            "these runs are of Python functions, which no file holds: build the study in Python"
        )
    task = TASKS[name]
    if "" in task.functions:
        return Solver(
            version=name,
            columns=lambda design: (*task.responses, "status", *task.unit_columns),
            cases=partial(_points, task),
            cost=lambda cases: np.full(cases.size, _COST),
            values=lambda cases, output: len(task.responses) + 1,
            solve=partial(_model, task),
            labelled=partial(_labelled_model, task),
            functions=task,
        )
    # late, here and below: a study is stated without the compiler, which is slow to load
    from impactlab.study.solvers.kernels import SOLVER as IMPACT

    return replace(
        IMPACT,
        version=f"{IMPACT.version} {name}",
        columns=lambda design: (*IMPACT.columns(design), *task.unit_columns),
        cost=lambda cases: IMPACT.cost(cases) + _COST,
        solve=partial(_responses, task),
        labelled=partial(_labelled_responses, task),
        functions=task,
    )


_CALLS = ExitStack(), Lock()
_calls = 0


@contextmanager
def _units_dropped() -> Iterator[None]:
    """Let arithmetic of xarray drop units during a call; calls may overlap in threads.

    xarray passes on the unit of N * m/s as N: a unit that is left afterwards is that of a variable
    as it is, or one that the function has set.
    """
    global _calls
    stack, lock = _CALLS
    with lock:
        if not _calls:
            stack.enter_context(xr.set_options(keep_attrs=False))
        _calls += 1
    try:
        yield
    finally:
        with lock:
            _calls -= 1
            if not _calls:
                stack.close()


def _number(function: Function, name: str, /, *args: Any, **values: Any) -> Any:
    """Return what a function gives. Raises ValueError where it raises."""
    try:
        with _units_dropped():
            return function.call(*args, **values)
    except Exception as error:
        where = f" at {values}" if values else ""
        raise ValueError(f"{name}{where}: raised {type(error).__name__}: {error}") from error


def _real(value: Any, name: str) -> float:
    plain = value.item() if hasattr(value, "item") and np.size(value) == 1 else value
    if not isinstance(plain, int | float | Real) or type(plain) is bool:
        raise ValueError(f"{name}: gave {str(value)[:80]!r}, not one real number")
    return float(plain)


def _unit(value: Any, name: str) -> str:
    """Return the unit of an array of xarray, "1" for a number, "" for NaN, which has any unit."""
    if not isinstance(value, xr.DataArray):
        return "" if np.isnan(value) else "1"
    if "units" not in value.attrs:
        raise ValueError(
            f"{name}: gave an array without a unit, which arithmetic drops: "
            'state its unit, il.Function(..., units="N")'
        )
    return str(value.attrs["units"])


def _responses(task: Task, cases: Array, output: OutputSpec) -> Columns:
    from impactlab.simulate import run_dataset
    from impactlab.study.solvers.kernels import kept

    if not cases.size:
        return {}
    rows: list[dict[str, Any]] = []
    for case in cases:
        values = {
            name: entry.choices[case[name]] if entry.choices else case[name].item()
            for name, entry in PARAMETERS.items()
            if name in (cases.dtype.names or ()) and name not in (*SECTION, *WORDS)
        } | section_values(case)
        repeated = values["strikes"] > 1  # among others, a single strike may have an interval
        values["strike_interval"] = (repeated and values["strike_interval"]) or None
        values["further_spheres"] = case["further_spheres"][: case["further"]].tolist() or None
        impact, grid = with_values(paper_impact(), Discretisation(), values)
        with warnings.catch_warnings():  # told before
            warnings.simplefilter("ignore")
            run = run_dataset(
                impact,
                grid,
                duration=case["duration"].item(),
                samples=task.samples,
                strikes=output.strikes,
            )
        names = (*RESPONSES, *FLAGS, *kept(output))
        row: dict[str, Any] = {name: run[name].values for name in names}
        row["status"] = row["status"] | row["remarks"] & STILL_GROWING  # of listed responses
        for name, function in task.functions.items():
            value = _number(function, f"responses.{name}", run)
            row[name] = _real(value, f"responses.{name}")
            if not function.unit(name):
                row[_UNIT + name] = _unit(value, f"responses.{name}")
        rows.append(row)
    kinds = dict.fromkeys(task.unit_columns, _UNITS)
    return {name: np.array([row[name] for row in rows], kinds.get(name)) for name in rows[0]}


def _units_apart(answers: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the answers without the columns of units, and the one unit of each such response.

    Raises ValueError where runs have different units.
    """
    columns = {name: values for name, values in answers.items() if not name.startswith(_UNIT)}
    units = {}
    for name in columns:
        if (column := answers.get(_UNIT + name)) is not None:
            names = sorted({*np.unique(np.asarray(column)).tolist()} - {""})
            if len(names) > 1:
                raise ValueError(
                    f"{name}: is in {' and in '.join(names)}, depending on the run: return one unit"
                )
            units[name] = names[0] if names else "1"
    return columns, units


def _attributes(function: Function, name: str, units: Mapping[str, str]) -> dict[str, str]:
    long_name = function.long_name or name.replace("_", " ")
    return {"long_name": long_name, "units": function.unit(name) or units[name]}


def _labelled_responses(task: Task, design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    from impactlab.study.solvers.kernels import SOLVER as IMPACT

    columns, units = _units_apart(answers)
    runs = IMPACT.labelled(design, columns)
    for name, function in task.functions.items():
        runs[name].attrs = _attributes(function, name, units)
    return runs


def _points(task: Task, design: xr.Dataset, runs: Array) -> Array:
    choices = {
        name: np.atleast_1d(design[name].attrs.get("values", [])) for name in task.parameters
    }
    # as wide as the longest word of the study, so that equal cases have equal bytes in any batch
    kinds = [
        (name, np.asarray(words, str).dtype if words.size else _NUMBERS[design[name].dtype.kind])
        for name, words in choices.items()
    ]
    table = np.zeros(runs.size, kinds)
    for name in task.parameters:
        table[name] = flattened(design, name, runs)
    return table


def _model(task: Task, cases: Array, output: OutputSpec) -> Columns:
    """Return the answers of the model, one row per case: a number, or a mapping of numbers."""
    if task.functions[""].vectorized:
        return _vectorized(task, cases)
    columns: Columns = {name: np.empty(cases.size) for name in task.responses}
    units: dict[str, list[str]] = {name: [] for name in task.unit_columns}
    for row, case in enumerate(cases):
        values = {name: case[name].item() for name in task.parameters}
        answer = _number(task.functions[""], "function", **values)
        answer = _by_response(task, answer)
        for name in task.responses:
            columns[name][row] = _real(answer[name], f"function: {name}")
            if _UNIT + name in units:
                units[_UNIT + name].append(_unit(answer[name], f"function: {name}"))
    columns |= {name: np.array(column, _UNITS) for name, column in units.items()}
    return columns | {"status": np.zeros(cases.size, dtype=np.int32)}


def _by_response(task: Task, answer: Any) -> Mapping[str, Any]:
    """Return what a model gave by response. Raises ValueError where names differ."""
    answers: Mapping[str, Any] = {task.responses[0]: answer}
    if isinstance(answer, Mapping):
        answers = answer
    if set(answers) != set(task.responses):
        names, responses = ", ".join(map(str, answers)), ", ".join(task.responses)
        raise ValueError(f"function: gave {names}, but `responses` of the study are {responses}")
    return answers


def _vectorized(task: Task, cases: Array) -> Columns:
    """Return the answers of a model that takes many cases at once: arrays of as many."""
    values = {name: cases[name].copy() for name in task.parameters}
    answer = _by_response(task, _number(task.functions[""], "function", **values))
    columns: Columns = {"status": np.zeros(cases.size, dtype=np.int32)}
    for name in task.responses:
        column = np.asarray(answer[name])
        if column.dtype.kind not in "iufb" or column.shape != (cases.size,):
            raise ValueError(
                f"function: {name}: gave {column.dtype} of shape {column.shape} for {cases.size} "
                "runs: a vectorized function returns one number for each"
            )
        columns[name] = column.astype(float)
        if _UNIT + name in task.unit_columns:
            is_array = isinstance(answer[name], xr.DataArray)
            unit = _unit(answer[name], f"function: {name}") if is_array else "1"
            columns[_UNIT + name] = np.full(cases.size, unit, _UNITS)
    return columns


def _labelled_model(task: Task, design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    columns, units = _units_apart(answers)
    function = task.functions[""]
    attrs = {name: _attributes(function, name, units) for name in task.responses}
    return on_design(design, columns, attrs)
