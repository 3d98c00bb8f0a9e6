"""The cost of a study, before anything is drawn or solved, and its limits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import disk_usage
from typing import Any, Protocol

import numpy as np
from distributed.system import MEMORY_LIMIT

from impactlab import wings
from impactlab.model import cost as beam_cost
from impactlab.model.cost import A_SECOND
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import SOLID
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS, Value, with_values
from impactlab.simulate import case_table
from impactlab.study.declaration import FunctionStudy, Grid, Sample, Sobol, Study
from impactlab.study.declaration.plausible import doubts, ends_of, stated_at
from impactlab.study.declaration.solid import asks_for_solid
from impactlab.study.errors import Problem, StudyError
from impactlab.study.quantities import amount, time
from impactlab.study.runs import disk_size
from impactlab.variables import HISTORIES, PROFILES, RESPONSES

Array = np.ndarray[Any, Any]
_NUMBER = 8
_HELD = 2
"""Times that answers are in memory: read, and in order. One column, or all of a growing sample."""
_A_RUN = 60.0
"""Bytes of a run in memory beside: its key, place and cost."""
_KEPT = 2
"""Times that they are on disk: in shards, and in runs.nc."""
_ITSELF = 4e8
"""Bytes of the program and its compiler."""
_FUNCTION = 1e-6
"""Seconds of a test function."""
_USUAL_RUNS, _USUAL_DURATION, _USUAL_SAMPLES = 10_000, 0.012, 1000
_USUAL_SIZE = 1e-3


@dataclass(frozen=True)
class Estimate:
    """What a study costs: core-seconds, bytes of memory and of disk.

    runs: all, or the most that a growing sample may come to. largest: seconds of the largest run;
    largest_run: what is varied, there. slow and large: the keys that drive time and room. auto:
    whether the discretisation is still to be found, and the default stands in its place.
    """

    file: str
    runs: int
    seconds: float
    memory: float
    disk: float
    largest: float
    largest_run: Mapping[str, Any]
    slow: str
    large: str
    auto: bool = False

    def wall(self, workers: int) -> float:
        """Seconds on so many cores: at least those of the largest run."""
        return max(self.seconds / workers, self.largest)


def estimate(study: Study | FunctionStudy, workers: int) -> Estimate:
    """The cost of a study on so many workers of this machine, within a factor of about three.

    Where there are many runs, some are drawn (always the same ones) and looked at; the largest is
    sought among the ends. What trials of `auto` and the analysis take is not in it. Raises
    StudyError where a drawn run is impossible.
    """
    until = study.sampling.until if isinstance(study.sampling, Sobol) else None
    runs = max(study.runs, until.runs if until else 0)
    if isinstance(study, FunctionStudy):
        room = runs * float(_NUMBER * (len(study.sampling.varied) + 2))
        return _estimate(study, runs, np.full(1, _FUNCTION), room, room, 0.0, {})
    looked, priced = looked_at(study), costs(study)
    cases = tabled(study, looked)
    work = priced.work(cases)
    largest = costliest(study, looked, work)
    end = tabled(study, {name: [value] for name, value in largest.items()})[:1]
    answers = runs * float(_NUMBER * _values(study, end))
    return _estimate(
        study,
        runs,
        np.append(work, priced.work(end)) / A_SECOND,
        answers,
        answers if until else runs * float(_NUMBER * _widest(study, end)),
        workers * float(priced.memory(np.append(cases, end)).max()),
        largest,
        slow=_key(study, _slow(study, end, runs)),
        large=_key(study, _large(study, end, runs)),
    )


def _estimate(
    study: Study | FunctionStudy,
    runs: int,
    seconds: Array,
    answers: float,
    held: float,
    working: float,
    largest_run: Mapping[str, Any],
    slow: str = "sampling",
    large: str = "sampling",
) -> Estimate:
    """seconds: of runs looked at, the largest one last; answers, held, working: bytes.

    held: of the answers that are in memory together.
    """
    others = seconds[:-1] if seconds.size > 1 else seconds
    return Estimate(
        file=str(study.path),
        runs=runs,
        seconds=max(float(others.mean()) * runs, float(seconds[-1])),
        memory=_ITSELF + _HELD * (held + _parameters(study, runs)) + runs * _A_RUN + working,
        disk=_KEPT * answers,
        largest=float(seconds[-1]),
        largest_run=largest_run,
        slow=slow,
        large=large,
        auto=isinstance(study, Study) and study.auto is not None,
    )


def _values(study: Study, case: Array) -> int:
    """Numbers kept of a run: its parameters, responses, histories and profiles."""
    store = study.store
    history = len(HISTORIES) * store.samples * store.histories
    profile = len(PROFILES) * int(case["nodes"][0] * case["points"][0]) * store.profiles
    return len(study.sampling.varied) + len(RESPONSES) + 2 + history + profile


def _widest(study: Study, case: Array) -> int:
    """Numbers of a run in its widest column."""
    store = study.store
    profile = int(case["nodes"][0] * case["points"][0]) * store.profiles
    return max(1, store.samples * store.histories, profile)


def _parameters(study: Study | FunctionStudy, runs: int) -> float:
    """Bytes of what is varied."""
    return runs * float(_NUMBER * len(study.sampling.varied))


def _slow(study: Study, case: Array, runs: int) -> dict[str, float]:
    """How much less time each would take at the paper's value, by parameter or key."""
    work, impact = costs(study).work, paper_impact()
    if asks_for_solid(study) and wings.load(wings.SOLID["cases"]).is_solid(case).all():
        impact = replace(impact, beam_model=SOLID)
    grid = Discretisation(element_size=_USUAL_SIZE)
    usual = table(study)(impact, grid, duration=_USUAL_DURATION, varied={})
    gains = {"sampling": runs / _USUAL_RUNS}
    for name in usual.dtype.names or ():
        changed = case.copy()
        changed[name] = usual[name]
        gains[name] = float((work(case) / work(changed))[0])
    return gains


def _large(study: Study, case: Array, runs: int) -> dict[str, float]:
    """How much less room each would take at its usual value, by parameter or key."""
    gains = {"sampling": runs / _USUAL_RUNS}
    if study.store.histories:
        gains["store.samples"] = study.store.samples / _USUAL_SAMPLES
    for name in ("nodes", "points"):
        gains[name] = float(case[name][0]) / getattr(Discretisation(), name)
    return gains


def _key(study: Study, gains: Mapping[str, float]) -> str:
    """Where in the file the largest of them stands."""
    name = max(gains, key=gains.__getitem__)
    return stated_at(name, study.sampling) if name in PARAMETERS else name


_MOST = 4096
_TAIL = 1e-3
"""Of a distribution, on either side: left out."""


class Costs(Protocol):
    """What tells the costs of a table of cases."""

    def work(self, cases: Array) -> Array:
        """Time of each run, in node-steps of the paper's beam."""
        ...

    def memory(self, cases: Array) -> Array:
        """Bytes that each run takes."""
        ...


def costs(study: Study) -> Costs:
    """Of the runs of a study."""
    found: Costs = wings.load(wings.SOLID["costs"]) if asks_for_solid(study) else beam_cost
    return found


def table(study: Study) -> Callable[..., Array]:
    """What makes the table of its cases: simulate.case_table, or as that."""
    if not asks_for_solid(study):
        return case_table
    found: Callable[..., Array] = wings.load(wings.SOLID["cases"]).table
    return found


def looked_at(study: Study) -> dict[str, Array]:
    """Values by varied parameter, one a run: all of a small grid, else some 4096 drawn ones."""
    sampling, random = study.sampling, np.random.default_rng(0)
    if isinstance(sampling, Sample):
        number = min(study.runs, _MOST)
        return {
            name: given.quantile(random.uniform(_TAIL, 1 - _TAIL, number))
            for name, given in sampling.varied.items()
        }
    values = {name: np.array(listed) for name, listed in sampling.parameters.items()}
    if study.runs <= _MOST:
        all_of_them = np.meshgrid(*values.values(), indexing="ij")
        return {name: grid.ravel() for name, grid in zip(values, all_of_them, strict=True)}
    return {name: random.choice(listed, _MOST) for name, listed in values.items()}


def tabled(study: Study, columns: Mapping[str, Sequence[Value] | Array]) -> Array:
    """The table of cases of these runs. Raises StudyError where one of them is impossible."""
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    try:
        return table(study)(*base, duration=study.duration, varied=columns)
    except ValueError as error:
        reason = f"gives runs that are impossible ({error}): take bounded distributions"
        raise StudyError(Problem(str(study.path), "sampling.parameters", reason)) from None


def costliest(study: Study, looked: Mapping[str, Array], cost: Array) -> dict[str, Value]:
    """The largest run, by parameter: from the largest one looked at, each to its costliest end."""
    found = {name: column[int(np.argmax(cost))].item() for name, column in looked.items()}
    for name in found:
        ends = _ends(study, name)
        columns = {key: [value] * len(ends) for key, value in found.items()} | {name: ends}
        found[name] = ends[int(np.argmax(costs(study).work(tabled(study, columns))))]
    return found


def _ends(study: Study, name: str) -> list[Value]:
    """A parameter's least and greatest value, or all its words."""
    sampling = study.sampling
    if isinstance(sampling, Grid):
        values = sampling.parameters[name]
        return list(values) if isinstance(values[0], str) else [min(values), max(values)]
    ends: list[Value] = sampling.varied[name].quantile(np.array([_TAIL, 1 - _TAIL])).tolist()
    return ends


MOST_TIME = 30 * 86400.0
"""Of one core, in s: a month."""


def remarks(study: Study | FunctionStudy) -> list[Problem]:
    """What of a study's impacts is hardly meant, though it can be."""
    if isinstance(study, FunctionStudy):
        return []
    found = doubts(ends_of((study.impact, study.discretisation), study.sampling))
    file = str(study.path)
    return [Problem(file, stated_at(each.name, study.sampling), each.reason) for each in found]


def unbearable(cost: Estimate, folder: Path) -> list[Problem]:
    """What is beyond a month of one core, this machine's memory, or the free disk at `folder`.

    One problem each, at the key that drives it.
    """
    return [
        Problem(cost.file, key, f"{reason}; see --dry-run, and --force runs it all the same")
        for key, reason in _beyond(cost, room(folder))
    ]


def _beyond(cost: Estimate, disk: float) -> Iterator[tuple[str, str]]:
    if cost.seconds > MOST_TIME:
        limit = f"above the {time(MOST_TIME)} that a study may take"
        yield cost.slow, f"about {time(cost.seconds)} of one core for {cost.runs:,} runs, {limit}"
    if cost.memory > MEMORY_LIMIT:
        yield cost.large, f"about {amount(cost.memory)} of memory, of {amount(MEMORY_LIMIT)}"
    if cost.disk > disk:
        yield cost.large, f"about {amount(cost.disk)} of disk, of {amount(disk)} that it may take"


def room(folder: Path) -> float:
    """Bytes that a study may take: those free on the disk of its folder, and its own there."""
    there = next(each for each in (folder, *folder.resolve().parents) if each.exists())
    return float(disk_usage(there).free + disk_size(folder.rglob("*")))
