"""The two kinds of study files: of runs, and of checks."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from impactlab.study.declaration.reading import Source, read_mapping, read_source
from impactlab.study.declaration.study import Study, study
from impactlab.study.declaration.verification import Verification, verification
from impactlab.study.errors import Problem, StudyError


def read_any(path: str | Path) -> Study | Verification:
    """What a YAML file declares: a verification if it has the key `checks`, else a study of runs.

    docs/studies.md describes both forms. Raises StudyError that holds everything wrong with the
    file, a line each with file, key and value; just the first where there is no file, no YAML, or
    no mapping in it.
    """
    source = read_source(path)
    return verification(source) if _lists_checks(source) else study(source)


def read_study(path: str | Path) -> Study:
    """A study of runs. Raises StudyError as `read_any`, and where the file is of checks."""
    source = read_source(path)
    if _lists_checks(source):
        raise _other(source, "lists checks and has no runs", "verify")
    return study(source)


def study_of_text(name: str, text: str) -> Study:
    """The study of runs that a file NAME.yaml of this text declares, as datasets keep both.

    Raises StudyError as `read_any`.
    """
    path = Path(f"{name}.yaml")
    return study(Source(name, path, text, read_mapping(text, str(path))))


def read_verification(path: str | Path) -> Verification:
    """A study of checks. Raises StudyError as `read_any`, and where the file is of runs."""
    source = read_source(path)
    if not _lists_checks(source):
        raise _other(source, "has no key checks, so it is a study of runs", "run")
    return verification(source)


def _lists_checks(source: Source) -> bool:
    """Whether it has the key `checks`, or one that is meant to be it."""
    return bool(get_close_matches("checks", map(str, source.data), n=1, cutoff=0.75))


def _other(source: Source, reason: str, command: str) -> StudyError:
    file = str(source.path)
    return StudyError(Problem(file, "", f"{reason}: use `impactlab {command} {file}`"))
