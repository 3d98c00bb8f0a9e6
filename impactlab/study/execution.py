"""From a design to its runs: batches over dask, finished ones kept, none solved twice."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from distributed import Client, as_completed

from impactlab.dataset import HISTORIES, PROFILES, described, provenance, status_bits
from impactlab.kernels.jit import SOURCES_HASH
from impactlab.model.discretisation import Discretisation
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.simulate import (
    Answers,
    answer_variables,
    case_table,
    profile_coordinates,
    sample_coordinates,
    solve,
)
from impactlab.study.progress import Progress
from impactlab.study.storage import Form, Shards, run_keys

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]

_BATCH_COST = 3e8
"""Node-steps a batch: about a second."""
_BATCH_VALUES = 20_000_000
"""Stored numbers a batch, at most: bounds the memory of a task."""
_BATCHES_A_WORKER = 4
_AHEAD = 3
"""Batches under way or waiting, a worker."""


@dataclass(frozen=True)
class Engine:
    """Where batches run: on a running dask scheduler where an address is given, else here."""

    kind: Literal["threads", "processes"] = "threads"
    workers: int = 1
    address: str = ""

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A dask client for the time of a study. Raises OSError when no scheduler answers."""
        if self.address:
            client = Client(self.address, timeout=10)
        else:
            apart = self.kind == "processes"
            client = Client(
                processes=apart,
                n_workers=self.workers if apart else 1,
                threads_per_worker=1 if apart else self.workers,
                dashboard_address="127.0.0.1:0",
                worker_dashboard_address="127.0.0.1:0",
                memory_limit=0,
                silence_logs=logging.ERROR,
            )
        with client:
            yield client


def execute(design: xr.Dataset, shards_folder: Path, engine: Engine) -> xr.Dataset:
    """Solve what of the design has not been solved yet, and return all of it as runs.nc holds it.

    design: see impactlab.study.sampling.design. Every finished batch is in `shards_folder`
    before the next one is counted, so that an interrupted study goes on from there.

    Raises ValueError when the model refuses a run, OSError when the disk is full.
    """
    cases = design_cases(design)
    form = Form(
        design.attrs["samples"] if design.attrs["histories"] else 0, bool(design.attrs["profiles"])
    )
    keys = run_keys(cases, form)
    shards = Shards(shards_folder, form)
    known, parts = _known(shards)
    first_of = {key: run for run, key in reversed(list(enumerate(keys)))}
    missing = sorted(run for key, run in first_of.items() if key not in known)
    log.info("%d runs, %d of them solved before", len(keys), len(keys) - len(missing))
    for runs, answers in _solved(cases, missing, form, engine):
        shards.write([keys[run] for run in runs], answers)
        known |= {keys[run]: (len(parts), row) for row, run in enumerate(runs)}
        parts.append(answers)
    answers = gather(parts, [known[key] for key in keys])
    if len(parts) > 1:
        _compact(shards, known, parts)
    return labelled(design, answers)


def design_cases(design: xr.Dataset) -> Array:
    """The kernels' case table of a design, its dimensions flattened in C order.

    Raises ValueError naming the run when the model refuses a value.
    """
    varied = np.atleast_1d(design.attrs["varied"])
    fixed = {
        name: design[name].item() for name in PARAMETERS if name in design and name not in varied
    }
    impact, grid = with_values(paper_impact(), Discretisation(), fixed)
    columns = (
        xr.broadcast(*(design[name] for name in varied)) if len(varied) > 1 else [design[varied[0]]]
    )
    return case_table(
        impact,
        grid,
        duration=design["duration"].item(),
        varied={
            str(name): column.values.ravel() for name, column in zip(varied, columns, strict=True)
        },
    )


def labelled(design: xr.Dataset, answers: Answers) -> xr.Dataset:
    """The answers of a design's runs, in its order, under its labels and with provenance."""
    shape = tuple(design.sizes.values())
    responses = tuple(str(name) for name in np.atleast_1d(design.attrs["responses"]))
    flat = answer_variables(answers, responses, ("run",))
    variables = {
        name: ((*map(str, design.sizes), *dims[1:]), values.reshape(*shape, *values.shape[1:]))
        for name, (dims, values) in flat.items()
    }
    dataset = design.assign(variables).assign_coords(_answer_coordinates(design, answers))
    return described(dataset.assign_attrs(provenance()))


def _answer_coordinates(design: xr.Dataset, answers: Answers) -> dict[str, Any]:
    coordinates: dict[str, Any] = {}
    if answers.histories:
        coordinates |= sample_coordinates(design["duration"].item(), design.attrs["samples"])
    if answers.profiles:
        fixed = {
            name: design[name].item()
            for name in PARAMETERS
            if name in design and not design[name].ndim
        }
        coordinates |= profile_coordinates(*with_values(paper_impact(), Discretisation(), fixed))
    return coordinates


def gather(parts: list[Answers], places: list[tuple[int, int]]) -> Answers:
    """One Answers with a run for each (part, row) of `places`, in that order."""
    offsets = np.cumsum([0, *(part.responses.size for part in parts)])
    rows = np.array([offsets[part] + row for part, row in places])

    def picked(arrays: list[Array]) -> Array:
        return np.concatenate(arrays)[rows]  # type: ignore[no-any-return]

    return Answers(
        picked([part.responses for part in parts]),
        {name: picked([part.histories[name] for part in parts]) for name in parts[0].histories},
        {name: picked([part.profiles[name] for part in parts]) for name in parts[0].profiles},
    )


def batches(cases: Array, runs: list[int], form: Form, workers: int) -> Iterator[list[int]]:
    """Consecutive runs whose cost comes to about a second, or less where workers would idle."""
    cost = np.array([node_steps(cases[run]) for run in runs])
    target = min(_BATCH_COST, cost.sum() / (_BATCHES_A_WORKER * workers))
    most = max(1, _BATCH_VALUES // _values_a_run(cases, form))
    batch: list[int] = []
    spent = 0.0
    for run, price in zip(runs, cost, strict=True):
        if batch and (spent + price > target or len(batch) >= most):
            yield batch
            batch, spent = [], 0.0
        batch.append(run)
        spent += price
    if batch:
        yield batch


def node_steps(case: Any) -> float:
    """Estimated cost of a run: half the nodes times the time steps (bending limit)."""
    dx = case.beam_span / (case.nodes - 1)
    wave = case.beam_depth * np.sqrt(case.beam_youngs_modulus / (12.0 * case.beam_density))
    return float(0.5 * case.nodes * case.duration / (case.courant * 0.5 * dx * dx / wave))


def solve_batch(cases: Array, form: Form, sources_hash: str) -> Answers:
    """The task that dask runs. Raises RuntimeError where the kernels are not the caller's."""
    if sources_hash != SOURCES_HASH:
        raise RuntimeError(
            "this dask worker has another version of impactlab: install the same one on all of them"
        )
    return solve(cases, samples=form.samples, profiles=form.profiles)


def _solved(
    cases: Array, runs: list[int], form: Form, engine: Engine
) -> Iterator[tuple[list[int], Answers]]:
    """Batches of runs with their answers, in the order in which they finish."""
    if not runs:
        return
    solve(cases[:0], samples=form.samples)  # compiles once, before the workers ask for it
    waiting = batches(cases, runs, form, engine.workers)
    with (
        engine.client() as client,
        Progress(total=cases.size, done=cases.size - len(runs)) as progress,
    ):

        def submit(batch: list[int]) -> Any:
            future = client.submit(solve_batch, cases[batch], form, SOURCES_HASH, pure=False)
            under_way[future.key] = batch
            return future

        under_way: dict[Any, list[int]] = {}
        slots = _AHEAD * max(engine.workers, len(client.nthreads()))
        queue = as_completed([submit(batch) for batch in islice(waiting, slots)])
        for future in queue:
            answers = future.result()
            future.release()
            batch = under_way.pop(future.key)
            yield batch, answers
            progress.advance(
                len(batch), int(np.count_nonzero(answers.responses["status"] & _FAILED))
            )
            queue.update([submit(batch) for batch in islice(waiting, 1)])


_FAILED = status_bits(())


def _values_a_run(cases: Array, form: Form) -> int:
    profile = int(cases[0].nodes) * int(cases[0].points) if form.profiles else 0
    return 32 + len(HISTORIES) * form.samples + len(PROFILES) * profile


def _known(shards: Shards) -> tuple[dict[bytes, tuple[int, int]], list[Answers]]:
    """Where each run on disk is: key -> (part, row), and the parts."""
    known: dict[bytes, tuple[int, int]] = {}
    parts: list[Answers] = []
    for keys, answers in shards.read():
        known |= {key: (len(parts), row) for row, key in enumerate(keys)}
        parts.append(answers)
    return known, parts


def _compact(shards: Shards, known: dict[bytes, tuple[int, int]], parts: list[Answers]) -> None:
    shards.replace_all(list(known), gather(parts, list(known.values())))
