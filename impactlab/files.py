"""Files that are written completely or not at all, and datasets that tell what was done to them.

A dataset's file carries a digest of each of its variables, made while they are written and compared
when they are read into memory, and the digests of what it was made from.
"""

import csv
import json
import math
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from difflib import get_close_matches
from hashlib import blake2b
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import xarray as xr
from netCDF4 import Dataset, set_chunk_cache
from rich.filesize import decimal

from impactlab import wings

KINDS = {
    ".nc": "netCDF",
    ".html": "HTML",
    ".csv": "CSV",
    ".xlsx": "Excel",
    ".parquet": "Parquet",
    ".tex": "LaTeX",
    ".png": "PNG",
    ".svg": "SVG",
    ".pdf": "PDF",
    ".mp4": "MP4",
    ".gif": "GIF",
}
"""Kinds of files that are written, or that people expect to be, by their suffix."""


def check_suffix(name: str, path: Path, suffixes: Sequence[str]) -> None:
    """Raise ValueError, with the name of the argument, unless a file is named for its kind.

    suffixes: those of the kinds that it is written as; none for a folder.
    """
    suffix = path.suffix.lower()
    if suffixes and suffix not in suffixes:
        kinds, ends = (" or ".join(names) for names in ([KINDS[s] for s in suffixes], suffixes))
        raise ValueError(
            f"{name} = {str(path)!r}: is written as {kinds}: its name must end in {ends}"
        )
    if not suffixes and suffix in KINDS:
        raise ValueError(f"{name} = {str(path)!r}: names a folder of files: leave out {suffix}")


@contextmanager
def replaced(path: Path, size: int = 0) -> Iterator[Path]:
    """Give a temporary path beside `path`, renamed to it in the end: readers see all or nothing.

    size: of what is written, in bytes, roughly, where it may be large. Raises OSError, naming the
    file and the space left, where it cannot be written; an older file then stays as it was.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{uuid4().hex}")  # see unfinished_files
    try:
        yield unfinished
        with unfinished.open("r+b") as handle:  # Windows syncs what may be written
            os.fsync(handle.fileno())
        unfinished.replace(path)
    except (OSError, RuntimeError) as error:  # HDF5 does not tell a full disk from others
        free = shutil.disk_usage(path.parent).free
        message = f"{path}: could not be written ({error}); {decimal(free)} are free on its disk"
        if free < size:
            message += f", {decimal(size)} are needed: make room, then run the same command again"
        raise OSError(message) from error
    finally:
        unfinished.unlink(missing_ok=True)


def write_csv(
    rows: Iterable[Mapping[str, Any]], columns: Sequence[str], path: Path, size: int = 0
) -> None:
    """Write these columns of rows to `path` in UTF-8, all or nothing (see `replaced`).

    NaN, and what a row lacks, are empty cells.
    """
    with replaced(path, size) as whole, whole.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: "" if cell != cell else cell for key, cell in row.items()})


def unfinished_files(folder: Path) -> list[Path]:
    """Return the temporary files that `replaced` left in a folder when its process was killed."""
    paths = folder.glob(".*." + "[0-9a-f]" * 32)
    return [path for path in paths if path.is_file()]


CONTENTS = {
    "design": "impactlab design",
    "runs": "impactlab run",
    "analysis": "impactlab analyse",
    "indices": "impactlab analyse",
    "surrogate": "impactlab analyse",
    "resolution": "impactlab recommend",
    "refinement": "impactlab refine",
    "findings": "impactlab verify",
    "calibration": "impactlab calibrate",
    "rare_event": "impactlab rare",
    "sizing": "impactlab size",
    "multifidelity": "impactlab multifidelity",
    "comparison": "impactlab compare",
    "impact": "impactlab simulate",
    "figure": "impactlab figures",
} | wings.contents()
"""What a dataset's file may hold, and the command that makes it."""
_CACHE = 1_000_000
"""Bytes per variable that HDF5 holds until a file is closed (64 MB by default): chunks are written
and read whole."""
_BLOCK = 1 << 20
"""Numbers that are in memory together where a variable is read or written in blocks."""
_TOGETHER = 128
"""Most times in a chunk of a file: few times of all runs are read without the others."""
_ATTRIBUTES = "attributes"  # the name of the digest of a dataset's own attributes
_UNCHECKED = {"created", "versions", "source_revision", "processor", "history", "checksums"}
"""Attributes that differ between equal datasets."""


def write_netcdf(
    dataset: xr.Dataset, path: Path, content: str, *sources: xr.Dataset, dated: bool = True
) -> None:
    """Write a dataset, large variables compressed. Raises OSError as `replaced`.

    content: one of CONTENTS. sources: datasets read from files that it was made from. dated:
    whether its history has the time, without which equal datasets give the same bytes.
    """
    time = f"{datetime.now(UTC).isoformat(timespec='seconds')}: " if dated else ""
    history = "\n".join(filter(None, (dataset.attrs.get("history"), time + CONTENTS[content])))
    dataset = dataset.assign_attrs(
        title=dataset.attrs.get("title") or content,
        Conventions="CF-1.11",
        content=content,
        made_from=" ".join(map(identity, sources)),
        history=history,
    )
    digests = {_ATTRIBUTES: _digest(dataset.attrs)}
    encoding: dict[str, dict[str, Any]] = {}
    hashes: dict[str, blake2b] = {}
    for name, variable in dataset.variables.items():
        attrs = dict(variable.attrs)
        if "Conventions" in attrs:  # from arithmetic with whole datasets
            attrs = {key: value for key, value in attrs.items() if key not in dataset.attrs}
        attrs.setdefault("long_name", str(name).replace("_", " "))
        for flags in attrs.keys() & {"flag_values", "flag_masks"}:
            attrs[flags] = np.asarray(attrs[flags], variable.dtype)
        variable.attrs = attrs
        if name in dataset.coords:
            encoding[str(name)] = {"_FillValue": None}
        elif variable.dtype.kind == "f" and variable.ndim > 1 and variable.size > 10_000:
            encoding[str(name)] = {"zlib": True, "complevel": 1}
        if variable.chunks is None:
            digests[str(name)] = _digest(variable.attrs, variable)
        else:  # in the one pass in which the values are computed
            hashes[str(name)] = hashed = _hash(variable.attrs, variable)
            variable.data = _noted(variable.data, hashed)
            if variable.data.npartitions > 1 and "zlib" in (storage := encoding.get(str(name), {})):
                *rows, last = variable.data.chunksize  # a chunk of the file is within one block
                storage["chunksizes"] = (*rows, min(last, _TOGETHER))
    dataset.attrs["checksums"] = json.dumps(digests, sort_keys=True)
    set_chunk_cache(_CACHE)
    with replaced(path, dataset.nbytes) as unfinished:
        dataset.to_netcdf(unfinished, engine="netcdf4", encoding=encoding)
        if hashes:  # only now are all digests known
            digests |= {name: hashed.hexdigest() for name, hashed in hashes.items()}
            with Dataset(unfinished, "a") as file:
                file.setncattr("checksums", json.dumps(digests, sort_keys=True))


def _noted(values: Any, hashed: blake2b) -> Any:
    """Return an array that updates its hash, block by block along its first dimension."""
    import dask.array as da  # takes long to load
    from dask.delayed import delayed

    is_text = values.dtype.kind in "OUS"

    def note(block: Any, before: None, is_last: bool) -> Any:
        if is_text:  # as the one list of `_digest`
            entries = json.dumps(block.tolist(), default=str)[1:-1]
            hashed.update(f"{entries}{']' if is_last else ', '}".encode())
        else:
            _update(hashed, block)
        return block

    if is_text:
        hashed.update(b"[")

    blocks = values.rechunk({axis: -1 for axis in range(1, values.ndim)})
    shapes = [(rows, *values.shape[1:]) for rows in blocks.chunks[0]] if values.ndim else [()]
    parts, before = [], None
    for number, lazy in enumerate(blocks.to_delayed().ravel(), 1):
        shape = shapes[number - 1]
        noted = delayed(note)(lazy, before, number == len(shapes))  # after the block before it
        before = delayed(lambda block: None)(noted)  # no block is kept for the next one
        parts.append(da.from_delayed(noted, shape, values.dtype))  # type: ignore[no-untyped-call]
    return da.concatenate(parts) if len(parts) > 1 else parts[0]  # type: ignore[no-untyped-call]


def block_rows(shape: tuple[int, ...]) -> int:
    """Return how many rows of this shape are in memory together."""
    return max(1, _BLOCK // max(1, math.prod(shape)))


def row_blocks(variable: xr.Variable) -> Iterator[Any]:
    """Yield the values of a variable in blocks of rows, which memory holds one by one."""
    rows = block_rows(variable.shape[1:])
    for start in range(0, len(variable), rows):
        yield variable[start : start + rows].values


@contextmanager
def opened(path: Path, *contents: str, indexed: bool = True) -> Iterator[xr.Dataset]:
    """Give a dataset whose file is open, its values neither read nor checked.

    contents: of CONTENTS, what it may hold; none: anything. indexed: with an index per dimension,
    which is held in memory. Raises OSError naming an unreadable file, ValueError naming one that
    holds something else.
    """
    set_chunk_cache(_CACHE)
    if not path.exists():
        raise FileNotFoundError(f"{path}: there is no such file{_similar(path)}")
    with _readable(path):
        dataset = xr.open_dataset(
            path, engine="netcdf4", cache=False, create_default_indexes=indexed
        )
    with dataset:
        wrong = ""
        if not {"content", "checksums", "made_from"} <= dataset.attrs.keys():
            wrong = "has no checksums, so another program or an older impactlab wrote it"
        elif dataset.attrs["content"] not in contents:
            wrong = f"holds {dataset.attrs['content']}, not {' or '.join(contents)}"
        if contents and wrong:
            command = " or ".join(f"`{CONTENTS[content]}`" for content in contents)
            raise ValueError(f"{path}: {wrong}: make one with {command}")
        yield dataset


def read_netcdf(path: Path, *contents: str) -> xr.Dataset:
    """Return a dataset in memory, its file closed; raises as `opened` does.

    Raises ValueError also where something was changed after the file was written.
    """
    with opened(path, *contents) as lazy, _readable(path):
        dataset = lazy.load()
    _check(dataset, path)
    return dataset


@contextmanager
def checked(path: Path, *contents: str, blocks: bool = False) -> Iterator[xr.Dataset]:
    """Give a dataset whose file is open; it was read once, in blocks, to check it.

    Its arrays are read each time that they are used, and `run` has no index: memory need not hold
    all variables. blocks: large histories and profiles are arrays of dask, of which memory need
    not hold any whole. Raises as `read_netcdf` does.
    """
    with opened(path, *contents, indexed=False) as lazy:
        _check(lazy, path)
        for dim in map(str, lazy.dims):
            if dim in lazy.coords and dim != "run":
                lazy = lazy.set_xindex(dim)
        for scalar in lazy.variables.values():
            if not scalar.ndim:  # arithmetic compares scalar coordinates again and again
                scalar.load()
        large = [v for v in lazy.values() if v.ndim > 1 and v.size > _BLOCK]
        if not (blocks and large):
            yield lazy
            return
        import dask  # takes long to load

        memory = {"array.chunk-size": 8 * _BLOCK, "scheduler": "synchronous"}  # as HDF5 is
        with dask.config.set(memory):
            for variable in large:
                *leading, last = variable.dims
                lazy[variable.name] = variable.chunk(dict.fromkeys(leading, "auto") | {last: -1})
            yield lazy


def _check(dataset: xr.Dataset, path: Path) -> None:
    with _readable(path):
        digests = {str(name): _digest(v.attrs, v) for name, v in dataset.variables.items()}
    digests[_ATTRIBUTES] = _digest(dataset.attrs)
    stored: dict[str, str] = json.loads(dataset.attrs["checksums"])
    if changed := sorted(k for k in stored.keys() | digests if stored.get(k) != digests.get(k)):
        command = CONTENTS[dataset.attrs["content"]]
        raise ValueError(
            f"{path}: was changed after it was written ({', '.join(changed)}): make it again with "
            f"`{command}`"
        )


def identity(dataset: xr.Dataset | None) -> str:
    """Return what tells a dataset that was read from a file from any other; "" of none."""
    checksums = "" if dataset is None else dataset.attrs.get("checksums", "")
    return _digest({"all": checksums}) if checksums else ""


def check_source(derived: xr.Dataset, path: Path, source: xr.Dataset, source_path: Path) -> None:
    """Raise ValueError where a dataset was not made from another; both were read from files."""
    if identity(source) not in derived.attrs["made_from"].split():
        raise ValueError(
            f"{path}: was not made from {source_path} as it is now: make it again with "
            f"`{CONTENTS[derived.attrs['content']]} {source_path}`"
        )


def _similar(path: Path) -> str:
    """Return a question that names a file of the same name in a similar folder; "" without."""
    siblings = [str(other) for other in path.parent.parent.glob(f"*/{path.name}")]
    near = get_close_matches(str(path), siblings, n=1, cutoff=0.8)
    return f"; did you mean {near[0]}?" if near else ""


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, RuntimeError, LookupError, TypeError, AttributeError) as error:
        reason = f"cannot be read as netCDF ({error})"
        if path.suffix in (".yaml", ".yml"):
            reason = f"is a study file: name its results, such as results/{path.stem}"
        raise OSError(f"{path}: {reason}") from None


def _digest(attrs: Mapping[Any, Any], variable: xr.Variable | None = None) -> str:
    """Return a hash of attributes and values, the same before writing and after reading."""
    digest = _hash(attrs, variable)
    if variable is not None and variable.dtype.kind in "OUS":
        digest.update(json.dumps(np.asarray(variable).tolist(), default=str).encode())
    elif variable is not None:
        _update(digest, variable)
    return digest.hexdigest()


def _hash(attrs: Mapping[Any, Any], variable: xr.Variable | None) -> blake2b:
    if variable is not None:
        kind = "text" if variable.dtype.kind in "OUS" else variable.dtype.name
        attrs = {**attrs, " dims": variable.dims, " shape": variable.shape, " kind": kind}
    plain = {key: np.ravel(value).tolist() for key, value in attrs.items() if key not in _UNCHECKED}
    return blake2b(json.dumps(plain, sort_keys=True, default=str).encode(), digest_size=16)


def _update(hashed: blake2b, values: Any) -> None:
    rows = block_rows(values.shape[1:])
    starts = range(0, len(values), rows) if values.ndim else ()
    for block in (values[start : start + rows] for start in starts) if values.ndim else (values,):
        hashed.update(np.ascontiguousarray(block).data)
