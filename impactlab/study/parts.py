"""Parts: ranges of a study's runs, each solved by a process that needs no other one, then merged.

A process draws its range block by block, and writes each block, parameters included, to a file (see
shard). Parts that are started again solve what is missing.
"""

import json
import logging
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from hashlib import sha256
from math import prod
from pathlib import Path

import dask
import dask.array as da
import numpy as np
import xarray as xr
from dask.delayed import delayed

from impactlab.files import block_rows
from impactlab.methods.grid import Grid
from impactlab.study import PARTS
from impactlab.study.design import design
from impactlab.study.inventory import checked_cases
from impactlab.study.ownership import check_unclaimed, study_file, write_runs
from impactlab.study.progress import items_done
from impactlab.study.schema.declarations import AnyStudy
from impactlab.study.shard import LAYOUT, Array, Block, Columns, PartFiles, Piece, pieces_of
from impactlab.study.solvers import Solver, run_shape, solver_named
from impactlab.study.steps import Tell, priced, resolved
from impactlab.study.store import OutputSpec, joined, run_keys
from impactlab.validation.errors import Problem, StudyError

log = logging.getLogger(__name__)

_SECONDS = 60.0
"""Duration of a block, roughly: what a process that is killed loses."""
_SPEED = 3e8  # cost per second, see solvers.Solver
_RUNS, _VALUES = 100_000, 8_000_000
"""Most runs and most stored numbers of a block, which memory holds a few times."""
_BATCH = 10_000  # most runs that a thread solves together
_PIECES = 8  # batches per thread: of unequal ones none is left to one thread
_FEW = 1000  # runs that tell the cost of a block


def run_part(
    study: AnyStudy,
    folder: Path,
    part: tuple[int, int],
    workers: int,
    place: str = "",
    *,
    force: bool = False,
    replace: bool = False,
    tell: Tell = lambda resolution: None,
) -> None:
    """Solve one part of a study, with no other process; `merge` puts the parts together.

    folder: of the study's results. part: its number, from 1 on, and the number of parts. place:
    folder or URL of the blocks that it writes; by default parts/ in `folder`. The others are those
    of `run`. Raises StudyError as `run` does, and for a study that has no parts.
    """
    if not replace:
        check_unclaimed(study, folder / "runs.nc")
    _check_parts(study)
    declared = _of_parts(study, priced(study, folder, workers, force, tell, part[1]))
    files = PartFiles.at(place or folder / PARTS, identity(declared))
    solve_part(declared, files, *part, workers)


def merge(study: AnyStudy, path: Path, place: str = "", *, replace: bool = False) -> None:
    """Write the runs that parts have solved to `path` (runs.nc), as `run` would have.

    place: where `run_part` wrote them. Raises ValueError naming parts that are not complete, and
    as `check_unclaimed`; StudyError for a study that has no parts.
    """
    if not replace:
        check_unclaimed(study, path)
    _check_parts(study)
    declared = _of_parts(study, resolved(study, path.parent))
    files = PartFiles.at(place or path.with_name(PARTS), identity(declared))
    runs = merged(declared, files)
    with dask.config.set(scheduler="synchronous"):  # HDF5 is not for two threads
        write_runs(runs.assign_attrs(study_file=study_file(study, path.parent)), path)


def _check_parts(study: AnyStudy) -> None:
    if getattr(study.sampling, "until", None):
        reason = "lets the sample grow by all of its runs, so it has no parts: leave it out"
        raise StudyError(Problem(str(study.path), "sampling.until", reason))


def _of_parts(study: AnyStudy, declared: AnyStudy | None) -> AnyStudy:
    """Return the resolved study. Raises StudyError where its discretisation is not found yet."""
    if declared is None:
        reason = f"is auto: find it once, before the parts: `impactlab recommend {study.path}`"
        raise StudyError(Problem(str(study.path), "discretisation", reason))
    return declared


def identity(study: AnyStudy) -> str:
    """Return the name of a study's folder of blocks, a hash of what its runs depend on.

    Title, responses and analyses do not matter.
    """
    labels = design(study, 0, 1)
    name = str(labels.attrs["solver"])
    form = {
        "fixed": {str(n): v.values.item() for n, v in labels.variables.items() if v.ndim == 0},
        "sampling": study.sampling.stated(),
        "solver": [name, solver_named(name).version, labels.attrs.get("function", "")],
        "output": [str(OutputSpec.of(labels)), LAYOUT],
    }
    return sha256(json.dumps(form, sort_keys=True, default=str).encode()).hexdigest()[:16]


def part_range(part: int, parts: int, runs: int) -> tuple[int, int]:
    """Return the first run of a part (1 to parts), and the one after its last."""
    return runs * (part - 1) // parts, runs * part // parts


def solve_part(study: AnyStudy, files: PartFiles, part: int, parts: int, workers: int) -> None:
    """Solve the runs of a part that no sound block holds yet, in so many threads.

    Raises ValueError where the model refuses a run, OSError where a block cannot be written.
    """
    start, stop = part_range(part, parts, study.sampling.runs)
    near = (block for block in files.blocks() if block.start < stop and start < block.stop)
    gaps = [p for p in pieces_of(files.sound(near), start, stop) if p.block is None]
    left = sum(piece.stop - piece.start for piece in gaps)
    log.info(
        "part %d of %d: runs %d to %d, %d of them solved before",
        *(part, parts, start + 1, stop, stop - start - left),
    )
    if not gaps:
        return
    sample = design(study, gaps[0].start, min(gaps[0].start + _FEW, gaps[0].stop))
    solver = solver_named(str(sample.attrs["solver"]))
    size, failures = _block_size(sample, solver, workers), solver.failures(sample)
    with items_done(stop - start, stop - start - left, "runs") as advance:
        for piece in gaps:
            for first in range(piece.start, piece.stop, size):
                block = Block(first, min(first + size, piece.stop), parts)
                keys, columns = _solved(design(study, block.start, block.stop), solver, workers)
                files.write(block, keys, columns)
                advance(keys.size, int(np.count_nonzero(columns["status"] & failures)))


def _block_size(sample: xr.Dataset, solver: Solver, workers: int) -> int:
    cases = checked_cases(sample, solver, np.arange(sample.sizes["run"]))
    by_time = _SECONDS * workers * _SPEED / float(solver.cost(cases).mean())
    by_memory = _VALUES // solver.values(cases, OutputSpec.of(sample))
    return max(1, min(int(by_time), by_memory, _RUNS))


def _solved(runs: xr.Dataset, solver: Solver, workers: int) -> tuple[Array, Columns]:
    """Return keys and answers of the runs of a design, and their parameters beside them."""
    output, size = OutputSpec.of(runs), runs.sizes["run"]
    solver.prepare(runs)

    def solve(batch: Array) -> tuple[Array, Columns]:
        cases = checked_cases(runs, solver, batch)
        return run_keys(cases, output, solver.version), solver.solve(cases, output)

    number = min(size, max(-(-size // _BATCH), _PIECES * workers))
    with ThreadPoolExecutor(workers) as pool:
        keys, columns = joined(pool.map(solve, np.array_split(np.arange(size), number)))
    return keys, columns | {name: runs[name].values for name in runs.attrs["varied"]}


def merged(study: AnyStudy, files: PartFiles) -> xr.Dataset:
    """Return all runs of a study from its blocks, not read yet: memory holds none of them.

    Raises ValueError naming the parts that are not complete.
    """
    blocks = files.sound(files.blocks())
    pieces = list(pieces_of(blocks, 0, study.sampling.runs))
    if gaps := [piece for piece in pieces if piece.block is None]:
        raise ValueError(_incomplete(files, blocks, gaps, study.sampling.runs))
    one = design(study, 0, 1)
    solver = solver_named(str(one.attrs["solver"]))
    runs = design(study) if isinstance(study.sampling, Grid) else None
    inner = 1 if runs is None else prod(run_shape(runs)[1][1:])
    column = partial(_column, files, pieces, inner)
    if runs is None:
        runs = _without_index(one, {name: column(name) for name in one.attrs["varied"]})
    return solver.labelled(runs, {name: column(name) for name in solver.columns(one)})


def _incomplete(files: PartFiles, blocks: Sequence[Block], gaps: Sequence[Piece], runs: int) -> str:
    """Return what is missing, in the form in which Slurm and PBS take numbers of an array."""
    if not blocks:
        return (
            f"{files.folder}: holds no solved runs of this study, as it is now: solve its parts "
            "first, `impactlab run STUDY --part 1/2` and `--part 2/2`, or any other number of them"
        )
    parts = max(block.parts for block in blocks)
    cuts = [part_range(part, parts, runs) for part in range(1, parts + 1)]
    missing = [
        part
        for part, (start, stop) in enumerate(cuts, 1)
        if any(gap.start < stop and start < gap.stop for gap in gaps)
    ]
    ranges: list[list[int]] = []
    for part in missing:
        if ranges and part == ranges[-1][1] + 1:
            ranges[-1][1] = part
        else:
            ranges.append([part, part])
    listed = ",".join(str(a) if a == b else f"{a}-{b}" for a, b in ranges)
    lost = sum(gap.stop - gap.start for gap in gaps)
    return (
        f"{files.folder}: {len(missing)} of {parts} parts are not complete ({lost:,} of {runs:,} "
        f"runs are missing): start them again, as --array={listed}, then merge again"
    )


def _without_index(one: xr.Dataset, columns: dict[str, da.Array]) -> xr.Dataset:
    """Return the design of all runs, from that of one; an index would hold all in memory."""
    chunks = next(iter(columns.values())).chunks
    numbers = da.arange(sum(chunks[0]), chunks=chunks)
    values = columns | {"run": numbers}
    variables = {
        name: xr.Variable("run", values[str(name)], variable.attrs) if variable.dims else variable
        for name, variable in one.variables.items()
    }
    return xr.Dataset(coords=xr.Coordinates(variables, indexes={}), attrs=one.attrs)


def _column(files: PartFiles, pieces: Sequence[Piece], inner: int, name: str) -> da.Array:
    """Return an answer or a parameter of all runs, read in rows of `inner` runs when computed."""
    starts = [piece.start for piece in pieces]

    def read(start: int, stop: int) -> Array:
        first = int(np.searchsorted(starts, start, side="right")) - 1
        parts = []
        for begin, end, block in pieces[first:]:
            if begin >= stop:
                break
            assert block is not None
            rows = slice(max(start, begin) - block.start, min(stop, end) - block.start)
            parts.append(files.read(block, name)[rows])
        return np.concatenate(parts)

    assert pieces[0].block is not None
    some = files.read(pieces[0].block, name)
    shape, runs = some.shape[1:], pieces[-1].stop
    rows = max(1, block_rows(shape) // inner) * inner
    lazy = delayed(read)
    columns = []
    for start in range(0, runs, rows):
        stop = min(start + rows, runs)
        size = (stop - start, *shape)
        columns.append(da.from_delayed(lazy(start, stop), size, some.dtype))  # type: ignore[no-untyped-call]
    whole: da.Array = da.concatenate(columns)  # type: ignore[no-untyped-call]
    return whole
