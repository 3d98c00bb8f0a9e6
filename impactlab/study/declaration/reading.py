"""From a file to plain Python data, of bounded size."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError

from impactlab.study.declaration.nodes import BoundedComposer, Constructor, RefusedError, check_size
from impactlab.study.errors import Problem, StudyError

LARGEST = 256 * 1024
"""Bytes in a study file, at most."""
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,99}")
"""Of a folder; one that begins with "-" would be taken for an option."""


@dataclass(frozen=True)
class Source:
    """A study file as it was read. name: the file's, without the ending; data: what it holds."""

    name: str
    path: Path
    text: str
    data: dict[str, Any]


def read_source(path: str | Path) -> Source:
    """Name, text and data of a study file. Raises StudyError, naming the file."""
    path = Path(path)
    name, text = read_name(path), read_text(path)
    return Source(name, path, text, read_mapping(text, str(path)))


def read_name(path: Path) -> str:
    """The name of the study: that of its file, without the ending.

    Raises StudyError unless it is a plain word, because it names folders.
    """
    if path.suffix != ".yaml":
        raise StudyError(Problem(str(path), "", "a study file's name ends in .yaml"))
    check_name(path.stem, str(path))
    return path.stem


def check_name(name: str, file: str) -> None:
    """Raises StudyError, naming the file, unless a study can have this name."""
    if not _NAME.fullmatch(name):
        reason = (
            "its name becomes that of a folder: letters, digits, _ and - only, no - first, "
            "at most 100"
        )
        raise StudyError(Problem(file, "", reason))


def read_text(path: Path) -> str:
    """The file's text. Raises StudyError when there is none, or it is no text, or too much."""
    try:
        if not path.is_file():
            reason = "is not a file" if path.exists() else "there is no such file"
            raise StudyError(Problem(str(path), "", reason))
        with path.open("rb") as file:
            raw = file.read(LARGEST + 1)
        if len(raw) > LARGEST:
            raise StudyError(Problem(str(path), "", f"is larger than {LARGEST // 1024} KiB"))
        return raw.decode("utf-8")
    except OSError as error:
        raise StudyError(Problem(str(path), "", f"cannot be read: {error.strerror}")) from None
    except UnicodeDecodeError:
        raise StudyError(Problem(str(path), "", "is not text in UTF-8")) from None


def read_mapping(text: str, file: str) -> dict[str, Any]:
    """The mapping that the YAML text holds; a key that comes twice is refused.

    file: named in errors. Raises StudyError when it is no such thing.
    """
    try:
        data = _parsed(text)
    except RefusedError as error:
        raise StudyError(Problem(file, error.key, str(error))) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise _no_yaml(file, f"{where}{error.problem}") from None
    except RecursionError:
        raise _no_yaml(file, "nests too deeply") from None
    except Exception as error:  # a hostile text can end the parser in any way
        raise _no_yaml(file, str(error) or type(error).__name__) from None
    if not isinstance(data, dict):
        raise StudyError(Problem(file, "", "holds no keys such as `title: ...`"))
    return data


def _parsed(text: str) -> Any:
    """Nothing is made of a text before it is known how much it stands for."""
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer, yaml.Constructor = BoundedComposer, Constructor
    root = yaml.compose(text)
    if root is None:
        return None
    check_size(root)
    return yaml.constructor.construct_document(root)


def _no_yaml(file: str, words: str) -> StudyError:
    return StudyError(Problem(file, "", f"is not YAML: {(words.splitlines() or [''])[0]}"))
