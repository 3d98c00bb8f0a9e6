"""The kinds of study files: of impacts, of a test function, and of checks."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from impactlab.study.declaration.function import FunctionStudy, function_study
from impactlab.study.declaration.reading import Source, read_mapping, read_source
from impactlab.study.declaration.study import Study, study
from impactlab.study.declaration.verification import Verification, verification
from impactlab.study.errors import Problem, StudyError


def read_any(path: str | Path) -> Study | FunctionStudy | Verification:
    """What a YAML file declares: a verification if it has the key `checks`, else a study of runs.

    docs/studies.md describes all forms. Raises StudyError that holds everything wrong with the
    file, a line each with file, key and value; just the first where there is no file, no YAML, or
    no mapping in it.
    """
    source = read_source(path)
    return verification(source) if _has(source, "checks") else _of_runs(source)


def read_study(path: str | Path) -> Study | FunctionStudy:
    """A study of runs. Raises StudyError as `read_any`, and where the file is of checks."""
    source = read_source(path)
    if _has(source, "checks"):
        raise _other(source, "lists checks and has no runs", "verify")
    return _of_runs(source)


def read_impacts(path: str | Path) -> Study:
    """A study of impacts. Raises StudyError as `read_study`, and where a function is studied."""
    found = read_study(path)
    if isinstance(found, FunctionStudy):
        reason = "is a study of a function, which has no discretisation"
        raise StudyError(Problem(str(path), "function", reason, found.function))
    return found


def study_of_text(name: str, text: str) -> Study | FunctionStudy:
    """The study of runs that a file NAME.yaml of this text declares, as datasets keep both.

    Raises StudyError as `read_any`.
    """
    path = Path(f"{name}.yaml")
    return _of_runs(Source(name, path, text, read_mapping(text, str(path))))


def read_verification(path: str | Path) -> Verification:
    """A study of checks. Raises StudyError as `read_any`, and where the file is of runs."""
    source = read_source(path)
    if not _has(source, "checks"):
        raise _other(source, "has no key checks, so it is a study of runs", "run")
    return verification(source)


def _of_runs(source: Source) -> Study | FunctionStudy:
    return function_study(source) if _has(source, "function") else study(source)


def _has(source: Source, key: str) -> bool:
    """Whether it has the key, or one that is meant to be it."""
    return bool(get_close_matches(key, map(str, source.data), n=1, cutoff=0.75))


def _other(source: Source, reason: str, command: str) -> StudyError:
    file = str(source.path)
    return StudyError(Problem(file, "", f"{reason}: use `impactlab {command} {file}`"))
