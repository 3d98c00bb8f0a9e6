"""What the runs of a study will cost, before anything is drawn or solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from impactlab import wings
from impactlab.model.cost import A_SECOND
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import SOLID
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS
from impactlab.study.declaration import FunctionStudy, Sobol, Study
from impactlab.study.declaration.plausible import stated_at
from impactlab.study.declaration.solid import asks_for_solid
from impactlab.study.looking import costliest, costs, looked_at, table, tabled
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
