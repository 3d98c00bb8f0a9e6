"""The cost of a study, before anything is drawn or solved, and its limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import disk_usage
from types import SimpleNamespace
from typing import Any

import numpy as np
from distributed.system import MEMORY_LIMIT

from impactlab.methods.sampling import RandomSample
from impactlab.model.case_table import case_table
from impactlab.model.cost import A_SECOND, ANY_RUN, memory, work
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import PARAMETERS, Value, with_values
from impactlab.model.plausibility import implausibilities
from impactlab.model.quantities import amount, time
from impactlab.study.design import series_sizes
from impactlab.study.inventory import BOUND_IT, file_stats
from impactlab.study.schema.consistency import extremes, further_models, key_of
from impactlab.study.schema.declarations import AnyStudy, FunctionStudy, ImpactStudy, Store
from impactlab.study.schema.readers import slow_study
from impactlab.study.shard import Array
from impactlab.validation.errors import Problem, StudyError
from impactlab.variables import BY_SPHERE, HISTORIES, OF_STRIKES, PROFILES, RESPONSES

MOST_TIME = 30 * 86400.0
"""Limit of the time on one core, in s: a month."""
_NUMBER = 8  # bytes per number
_IN_MEMORY = 2  # copies of a column of answers in memory, read and in order
_PER_RUN = 60.0  # bytes per run in memory beside them: its key, place and cost
_ON_DISK = 2  # copies of answers on disk: in shards and in runs.nc
_PROGRAM = 4e8  # bytes of the program and its compiler
_FUNCTION = 1e-6  # seconds per value of a test function
_BEGINNING = 0.2  # seconds of any study beside its runs: workers and files
_RUN, _STORED = 2e-6, 2e-7
"""Seconds of the main process per run (its key and place), and per number that it stores."""
_USUAL_RUNS, _USUAL_DURATION, _USUAL_SAMPLES = 10_000, 0.012, 1000
_MOST, _FEW = 4096, 32  # runs of a cost sample; of models of wings, whose meshes take time
_TAIL = 1e-3  # probability of either tail of a distribution that a cost sample leaves out


@dataclass(frozen=True)
class Estimate:
    """The cost of a study (`il.Study.estimate`), within a factor of about 3.

    Attributes
    ----------
    file : str
        Name of the study file.
    runs : int
        Number of runs, or the most that a growing sample may reach.
    seconds : float
        Time of all runs on one core, in s.
    memory : float
        Size in memory, in bytes.
    disk : float
        Size on disk, in bytes.
    free : float
        Size that the results may take on disk, in bytes.
    largest : float
        Time of the largest run, in s.
    largest_run : mapping of str to float, int or str
        Varied parameters of the largest run, in SI units.
    slow : str
        Key of the study that drives time.
    large : str
        Key of the study that drives memory and disk.
    implausible : tuple of Problem
        Values that are possible but improbable.
    auto : bool
        True while the discretisation is still to be found, and the default is used instead.
    overhead : float
        Time beside the runs, in which they are drawn, kept and written, in s; of one core, however
        many there are.
    """

    file: str
    runs: int
    seconds: float
    memory: float
    disk: float
    free: float
    largest: float
    largest_run: Mapping[str, Any]
    slow: str
    large: str
    implausible: tuple[Problem, ...] = ()
    auto: bool = False
    overhead: float = 0.0

    def wall(self, workers: int) -> float:
        """Return the time on several cores: at least that of the largest run and the overhead.

        Parameters
        ----------
        workers : int
            Number of cores.

        Returns
        -------
        float
            Time, in s.
        """
        return max(self.seconds / workers, self.largest) + self.overhead

    def exceeded(self) -> list[Problem]:
        """Return one problem per limit that the study exceeds, at the key that drives it.

        Returns
        -------
        list of Problem
            Problems; empty where the study is within all limits.
        """
        exceeded = []
        if self.seconds > MOST_TIME:
            needed = f"needs about {time(self.seconds)} of one core for {self.runs:,} runs"
            exceeded.append((self.slow, f"{needed}, which exceeds the limit of {time(MOST_TIME)}"))
        if self.memory > MEMORY_LIMIT:
            needed, limit = f"needs about {amount(self.memory)} of memory", amount(MEMORY_LIMIT)
            exceeded.append((self.large, f"{needed}, which exceeds the {limit} of this machine"))
        if self.disk > self.free:
            needed, limit = f"needs about {amount(self.disk)} of disk", amount(self.free)
            exceeded.append((self.large, f"{needed}, which exceeds the {limit} available"))
        way_out = "see --dry-run, or run it anyway with --force (Python: estimate(), force=True)"
        return [Problem(self.file, key, f"{reason}; {way_out}") for key, reason in exceeded]


def estimate(study: AnyStudy, folder: Path, workers: int, runs: int = 0) -> Estimate:
    """Return the cost of a study on so many workers of this machine, within a factor of about 3.

    study: with its discretisation, where that is known (see steps.resolved). folder: for its
    results; what they take already counts as free. runs: of its distributions, in place of its own;
    they keep no series. Of many runs a sample is taken, always the same one; the largest run is
    sought at the extremes of parameters. Runs of a slow model are included, pilot runs of `auto`
    and the analysis are not. Raises StudyError where a sampled run is impossible.
    """
    existing = next(
        ancestor for ancestor in (folder, *folder.resolve().parents) if ancestor.exists()
    )
    occupied = sum(stat.st_size for stat in file_stats(folder.rglob("*")))
    file, doubted = str(study.path), []
    if runs and isinstance(study, ImpactStudy):
        study = replace(study, store=Store())
    runs = runs or study.sampling.runs_at_most
    parameters = len(study.sampling.varied)
    if isinstance(study, FunctionStudy):
        sampled, largest, largest_run = np.full(1, _FUNCTION), _FUNCTION, {}
        stored, held, working = parameters + 2, parameters + 2, 0.0
        slow = large = "sampling"
    else:
        model: Any = SimpleNamespace(table=case_table, work=_work, memory=memory, usual=_usual)
        for further in further_models(study):  # with the same functions
            model = further.part("costs")
        sample = _cost_sample(study)
        cases = _cases(study, model, sample)
        costs = model.work(cases)
        largest_run = _largest_run(study, model, sample, costs)
        end = _cases(study, model, {name: [value] for name, value in largest_run.items()})[:1]
        sampled, largest = costs / A_SECOND, float(model.work(end)[0]) / A_SECOND
        history = study.store.samples * study.store.histories
        profile = int(end["nodes"][0] * end["points"][0]) * study.store.profiles
        sizes = series_sizes(study)
        strikes, spheres = sizes.get("most_strikes", 0), sizes.get("spheres", 0)
        stored = (
            parameters + len(RESPONSES) + 2 + len(HISTORIES) * history + len(PROFILES) * profile
        )
        stored += len(OF_STRIKES) * strikes + spheres * (len(BY_SPHERE) + history)
        held = max(1, history, profile, strikes, spheres * max(1, history))
        working = workers * float(model.memory(np.append(cases, end)).max())
        slow, large = _drivers(study, model, end, runs)
        doubts = implausibilities(extremes((study.impact, study.discretisation), study.sampling))
        doubted = [
            Problem(file, key_of(doubt.name, study.sampling), doubt.reason) for doubt in doubts
        ]
    seconds = max(float(sampled.mean()) * runs, largest)
    if study.multifidelity:  # the study's model takes at most as long again as the slow one
        section = study.multifidelity
        slow_runs = slow_study(study, section.high)
        pairs = estimate(slow_runs, folder, workers, section.pairs).seconds
        seconds += section.budget or 2 * pairs
        if section.indices:
            from impactlab.study.multifidelity_indices import number_of_runs

            seconds += float(sampled.mean()) * number_of_runs(parameters, section.pairs)
    answers = _IN_MEMORY * _NUMBER * runs * float(held + parameters)
    return Estimate(
        file=file,
        runs=runs,
        seconds=seconds,
        memory=_PROGRAM + answers + runs * _PER_RUN + working,
        disk=_ON_DISK * _NUMBER * runs * float(stored),
        free=float(disk_usage(existing).free + occupied),
        largest=largest,
        largest_run=largest_run,
        slow=slow,
        large=large,
        implausible=tuple(doubted),
        auto=isinstance(study, ImpactStudy) and study.auto is not None,
        overhead=_BEGINNING + runs * (_RUN + _STORED * stored),
    )


def _drivers(study: ImpactStudy, model: Any, case: Array, runs: int) -> list[str]:
    """Return the keys that drive time and space: the usual values of which would save most."""
    usual = model.usual(case, _USUAL_DURATION)
    slow = {"sampling": runs / _USUAL_RUNS}
    large = dict(slow)
    for name in usual.dtype.names:
        changed = case.copy()
        changed[name] = usual[name]
        slow[name] = float((model.work(case) / model.work(changed))[0])
    if study.store.histories:
        large["store.samples"] = study.store.samples / _USUAL_SAMPLES
    for name in ("nodes", "points"):
        large[name] = float(case[name][0]) / getattr(Discretisation(), name)
    names = [max(gains, key=gains.__getitem__) for gains in (slow, large)]
    return [key_of(name, study.sampling) if name in PARAMETERS else name for name in names]


def _work(cases: Array) -> Any:
    """Return the estimated time per run of the kernels, all of it (see cost.work)."""
    return work(cases) + ANY_RUN


def _usual(case: Array, duration: float) -> Array:
    """Return the record of the usual run that `case` is compared with."""
    return case_table(paper_impact(), Discretisation(), duration=duration, varied={})


def _cost_sample(study: ImpactStudy) -> dict[str, Array]:
    """Return varied parameters of some runs: all of a small grid, else _MOST, without a sampler."""
    sampling, random = study.sampling, np.random.default_rng(0)
    if isinstance(sampling, RandomSample):
        number = min(study.sampling.runs, _FEW if further_models(study) else _MOST)
        return {
            name: distribution.quantile(random.uniform(_TAIL, 1 - _TAIL, number))
            for name, distribution in sampling.varied.items()
        }
    values = {name: np.array(listed) for name, listed in sampling.parameters.items()}
    if study.sampling.runs <= _MOST:
        grids = np.meshgrid(*values.values(), indexing="ij")
        return {name: grid.ravel() for name, grid in zip(values, grids, strict=True)}
    return {name: random.choice(listed, _MOST) for name, listed in values.items()}


def _cases(study: ImpactStudy, model: Any, columns: Mapping[str, Sequence[Value] | Array]) -> Array:
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    try:
        return np.asarray(model.table(*base, duration=study.duration, varied=columns))
    except ValueError as error:
        reason = f"gives an impossible run: {error}: {BOUND_IT}"
        raise StudyError(Problem(str(study.path), "sampling.parameters", reason)) from None


def _largest_run(
    study: ImpactStudy, model: Any, sample: Mapping[str, Array], cost: Array
) -> dict[str, Value]:
    """Return the largest run: that of the sample, each parameter taken to its costliest end."""
    bounds = study.sampling.bounds()
    values = {name: column[int(np.argmax(cost))].item() for name, column in sample.items()}
    for name in values:
        ends = list(bounds.get(name, ()))
        if not ends:
            ends = study.sampling.varied[name].quantile(np.array([_TAIL, 1 - _TAIL])).tolist()
        columns = {key: [value] * len(ends) for key, value in values.items()} | {name: ends}
        values[name] = ends[int(np.argmax(model.work(_cases(study, model, columns))))]
    return values
