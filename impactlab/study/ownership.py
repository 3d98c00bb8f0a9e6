"""Stored results: which study they are of, and what is made from them beside them.

A study's runs.nc is written anew without asking by its own file, whatever was edited in it, and by
a study of the same runs. The runs of an earlier text stay in the shards.
"""

import json
import logging
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.files import identity, opened, write_netcdf
from impactlab.study.schema.declarations import Declared, FunctionStudy, ImpactStudy

log = logging.getLogger(__name__)

_MADE = (
    "analysis.nc",
    "indices.csv",
    "indices.nc",
    "distribution.csv",
    "surrogate.nc",
    "report.html",
    "report_explorer.html",
    "solved_study.yaml",
    "ro-crate-metadata.json",
    *(
        f"tables/{name}.{suffix}"
        for name in ("runs", "indices", "answers")
        for suffix in ("csv", "parquet", "tex")
    ),
)
"""Files that analysis, report and `impactlab export` leave beside runs.nc."""


def study_file(study: Declared, folder: Path) -> str:
    """Return a study's file as seen from `folder`, so that both can move; "" without a file."""
    if study.path.suffix != ".yaml":
        return ""
    return Path(os.path.relpath(study.path.resolve(), folder.resolve())).as_posix()


def check_unclaimed(study: Declared, path: Path, file: str | None = None) -> None:
    """Raise ValueError where `path`, a dataset of results, holds those of another study.

    A file is the same study whatever is edited in it. So are two studies of the same runs (impact,
    discretisation, duration, sampling and functions), as of a file and its equal in Python. file:
    see `study_file`. Unreadable results belong to nobody.
    """
    file = study_file(study, path.parent) if file is None else file
    attrs: dict[str, Any] = {}
    with suppress(OSError), opened(path, indexed=False) as stored:
        attrs = stored.attrs
    if not attrs or (file and attrs.get("study_file") == file) or same_runs(study, attrs):
        return
    title, source = attrs.get("title", "without a title"), attrs.get("study_file")
    raise ValueError(
        f"{path}: holds the results of another study, “{title}” ({_origin(source)}); this one is "
        f"“{study.title}” ({_origin(file)}). Give one of them another name (that of its file, in "
        f"Python name=...), move {path.parent} elsewhere, or give the results up: `impactlab run "
        "--replace`, in Python run(replace=True)"
    )


def _origin(file: str | None) -> str:
    return "of unknown origin" if file is None else file or "built in Python"


def same_runs(study: Declared, attrs: dict[str, Any]) -> bool:
    """Return True where results with these attributes are of the runs that the study asks for."""
    from impactlab.study.schema.readers import study_of_text

    if attrs.get("study_sha256") == study.sha256:
        return True
    try:
        stored: Any = study_of_text(str(attrs["study"]), str(attrs["study_text"]))
    except (KeyError, ValueError):  # no study of runs, or of functions that are not this one's
        return False
    keys = ("function", "impact", "discretisation", "auto", "duration", "sampling")
    if any(getattr(stored, key, None) != getattr(study, key, None) for key in keys):
        return False
    if isinstance(stored, FunctionStudy) or not isinstance(study, ImpactStudy):
        return True
    return bool(stored.python.items() <= study.python.items())


def write_runs(runs: xr.Dataset, path: Path) -> None:
    """Write runs.nc, and remove what was made beside it from the runs that it held before."""
    before = _identity(path)
    write_netcdf(runs, path, "runs")
    if before in ("", _identity(path)):
        return
    analysis, calibration = path.with_name("analysis.nc"), path.with_name("calibration.nc")
    if _identity(calibration, "study_sha256") not in ("", runs.attrs.get("study_sha256")):
        for suffix in (".nc", ".svg", ".png", ".html", ".index.json"):
            calibration.with_suffix(suffix).unlink(missing_ok=True)
        log.warning("%s: the calibration by the runs before is removed", path)
    if before not in _identity(analysis, "made_from").split():
        return
    captions, drawings = path.with_name("figures") / "captions.json", {}
    with suppress(OSError, ValueError):
        drawings = json.loads(captions.read_text("utf-8"))
    pictures = [file for name in drawings for file in captions.parent.glob(f"{name}.*")]
    made = (path.parent / name for name in (*_MADE, f"tables/{runs.attrs.get('study')}.xlsx"))
    panels = (path.parent / "panels").glob("*mm.*")
    for file in (*pictures, captions, *panels, *made):
        file.unlink(missing_ok=True)
    log.warning("%s: what was made from the runs before is removed (analysis, report)", path)


def _identity(path: Path, attribute: str = "") -> str:
    """Return the identity of a dataset's file, or an attribute; "" where it cannot be read."""
    with suppress(OSError), opened(path, indexed=False) as stored:
        return str(stored.attrs.get(attribute, "")) if attribute else identity(stored)
    return ""
