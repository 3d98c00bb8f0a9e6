"""YAML files of bounded size, read as plain Python data, and their text.

Aliases and merge keys let a short text stand for more than a machine can hold. Their expanded size
is counted on the parsed graph, in a time that grows with the text alone, before it is built.
"""

import io
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.constructor import ConstructorError, SafeConstructor
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import CollectionEndEvent, CollectionStartEvent, NodeEvent
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.parser import Parser

from impactlab.validation.errors import Problem, StudyError, dotted

LARGEST = 256 * 1024
"""Largest size of a study file in bytes."""
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,99}")
"""Names of folders; a name that begins with "-" would be taken for an option."""


@dataclass(frozen=True)
class Source:
    """A study file as read. name: that of the file without its ending; data: its parsed content."""

    name: str
    path: Path
    text: str
    data: dict[str, Any]


def read_source(path: str | Path) -> Source:
    """Read a study file. Raises StudyError, naming it; also unless its name is that of a folder."""
    path = Path(path)
    if path.suffix == ".yaml" or os.path.lexists(path):
        check_path(path)
    text = read_text(path)
    return Source(path.stem, path, text, read_mapping(text, str(path)))


def check_path(path: Path) -> None:
    """Raise StudyError unless the path can be that of a study file."""
    if path.suffix != ".yaml":
        reason = "the name of a study file must end in .yaml: rename it"
        raise StudyError(Problem(str(path), "", reason))
    check_name(path.stem, str(path))


def check_name(name: str, file: str) -> None:
    """Raise StudyError, naming the file, unless a study can have this name."""
    if not _NAME.fullmatch(name):
        allowed = "use at most 100 letters, digits, _ and -, with no - first"
        raise StudyError(Problem(file, "", f"its name becomes the name of a folder: {allowed}"))


def read_text(path: Path) -> str:
    """Return the file's text. Raises StudyError when it cannot be read, or is too large."""
    try:
        if path.is_file():
            with path.open("rb") as file:
                raw = file.read(LARGEST + 1)
            if len(raw) <= LARGEST:
                return raw.decode("utf-8")
            reason = f"is larger than {LARGEST // 1024} KiB: shorten it"
        else:
            hint = "" if path.exists() else _similar_file(path)
            reason = "is not a file" if path.exists() else f"there is no such file{hint}"
    except OSError as error:
        reason = f"cannot be read: {error.strerror}"
    except UnicodeDecodeError:
        reason = "is not text in UTF-8: save it as such"
    raise StudyError(Problem(str(path), "", reason))


def _similar_file(path: Path) -> str:
    """Return a question that names a file of a similar path, or of a similar name; "" without."""
    near = (f"{path}.yaml", f"studies/{path.name}", f"studies/{path.name}.yaml")
    if exact := [name for name in near if Path(name).is_file()]:
        return f"; did you mean {exact[0]}?"
    files = {file.stem: file for folder in ("studies", path.parent) for file in _listed(folder)}
    nearest = get_close_matches(path.stem, files, n=1)
    return f"; did you mean {files[nearest[0]]}?" if nearest else ""


def _listed(folder: str | Path) -> list[Path]:
    return sorted(Path(folder).glob("*.yaml"))


def read_mapping(text: str, file: str) -> dict[str, Any]:
    """Return the mapping in a YAML text. Raises StudyError, naming the file, unless it is one."""
    try:
        yaml = YAML(typ="safe", pure=True)
        yaml.Parser, yaml.Constructor = BoundedParser, Constructor
        data, root = None, yaml.compose(text)
        if root is not None:
            _measure(root, (), {})  # before anything is built
            data = yaml.constructor.construct_document(root)
    except RefusedError as error:
        raise StudyError(Problem(file, error.key, str(error))) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        tab = "; put spaces in the place of tabs" if "'\\t'" in str(error.problem) else ""
        problem = f"{where}{error.problem}{tab}"
    except RecursionError:
        problem = "nests too deeply"
    except Exception as error:  # a hostile text can make the parser fail in any way
        problem = str(error) or type(error).__name__
    else:
        if isinstance(data, dict):
            return data
        raise StudyError(Problem(file, "", "holds no keys such as `title: ...`"))
    raise StudyError(Problem(file, "", f"is not YAML: {(problem.splitlines() or [''])[0]}"))


def text_of(content: Mapping[str, Any]) -> str:
    """Return the text of a study file with this content."""
    yaml: Any = YAML(typ="safe", pure=True)
    text = io.StringIO()
    yaml.default_flow_style, yaml.sort_base_mapping_type_on_output = None, False
    yaml.width, yaml.allow_unicode = 96, True
    yaml.dump(content, text)
    return text.getvalue()


MOST = 50_000
"""Most keys and values of study files, aliases expanded."""
_DEEPEST = 20
_DIGITS = 1000
"""Largest number of characters of a number; Python prints numbers of up to 4300 digits."""
_CORE = "tag:yaml.org,2002:"
_TAGS = {"str", "int", "float", "bool", "null", "timestamp", "merge", "value", "seq", "map"}
"""Tags of plain values; any other tag stands for a kind of value that no key takes."""

Key = tuple[str, ...]


class RefusedError(ValueError):
    """Content that a study file may not have. key: dotted, of at most three steps."""

    def __init__(self, path: Key, reason: str) -> None:
        """Note the place (path) and the reason."""
        super().__init__(reason)
        self.key = dotted(path[:3])


class BoundedParser(Parser):
    """A parser that raises RefusedError for too many nodes, or levels, as soon as it meets them."""

    nodes = level = 0

    def get_event(self) -> Any:
        """Return the next event."""
        event = super().get_event()
        self.nodes += isinstance(event, NodeEvent)
        self.level += isinstance(event, CollectionStartEvent)
        self.level -= isinstance(event, CollectionEndEvent)
        if self.nodes > MOST:
            raise RefusedError((), f"holds more than {MOST:,} keys and values: shorten it")
        if self.level > _DEEPEST + 1:  # at once: a parser takes the square of the levels
            where = f"line {event.start_mark.line + 1}"
            raise RefusedError((), f"{where}: nests too deeply (is a quotation mark missing?)")
        return event


class Constructor(SafeConstructor):
    """A constructor of plain values whose errors name the place in the text."""

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Return a node's value. Raises MarkedYAMLError where it has none."""
        try:
            return super().construct_object(node, deep)
        except (MarkedYAMLError, RecursionError):
            raise
        except Exception as error:  # int, float, datetime and base64 each have their own
            kind = str(node.tag).removeprefix(_CORE)
            reason = f"cannot be read as {kind} ({str(error)[:80]})"
            raise ConstructorError(None, None, reason, node.start_mark) from None


def _measure(node: Node, path: Key, extents: dict[int, tuple[int, int]]) -> tuple[int, int]:
    """Return (nodes, levels) of an expanded node; extents: of those visited before, by their id."""
    if id(node) not in extents:
        if len(path) > _DEEPEST:  # ends at a node that holds itself, too
            raise RefusedError(path, "nests too deeply")
        below = [_measure(child, (*path, step), extents) for step, child in _children(node, path)]
        size = 1 + sum(nodes for nodes, _ in below)
        height = 1 + max((levels for _, levels in below), default=0)
        extents[id(node)] = size, height
    size, height = extents[id(node)]
    if size > MOST:
        raise RefusedError(path, "holds too much: its aliases count as often as they are used")
    if len(path) + height > _DEEPEST + 1:
        raise RefusedError(path, "nests too deeply")
    return size, height


def _children(node: Node, path: Key) -> Iterator[tuple[str, Node]]:
    """Yield what a node holds. Raises RefusedError unless keys, lists and values are plain."""
    tag = str(node.tag)
    kind = tag.removeprefix(_CORE)
    if kind not in _TAGS:
        raise RefusedError(path, f"has the tag {dotted([tag.replace(_CORE, '!!')])}: take it out")
    if isinstance(node, SequenceNode):
        yield from ((str(index), child) for index, child in enumerate(node.value))
    elif isinstance(node, MappingNode):
        if not all(isinstance(key, ScalarNode) for key, _ in node.value):
            raise RefusedError(path, "a key must be a word, not a list or a mapping")
        for key, child in node.value:
            yield str(key.value), key
            yield str(key.value), child
    elif any("\ud800" <= letter <= "\udfff" for letter in node.value):  # as escapes allow
        reason = "holds half of a character (\\ud800 to \\udfff): write the whole character"
        raise RefusedError(path, reason)
    elif kind in ("int", "float") and len(node.value) > _DIGITS:
        reason = f"is a number of {len(node.value):,} characters: write at most {_DIGITS:,}"
        raise RefusedError(path, reason)
