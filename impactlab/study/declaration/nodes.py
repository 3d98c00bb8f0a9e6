"""What a YAML text holds, looked at before anything is made of it.

Aliases and merge keys let a short text stand for more than a machine can hold: what they stand for
is counted here on the parsed graph, in a time that grows with the text alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ruamel.yaml.composer import Composer
from ruamel.yaml.constructor import ConstructorError, SafeConstructor
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from impactlab.study.errors import dotted

MOST = 50_000
"""Keys and values in a study file, at most, once its aliases are followed."""
_DEEPEST = 20
_DIGITS = 1000
"""Characters of a number, at most; Python writes out numbers of up to 4300 digits."""
_CORE = "tag:yaml.org,2002:"
_TAGS = {"str", "int", "float", "bool", "null", "timestamp", "merge", "value", "seq", "map"}
"""What a plain text resolves to; any other tag stands for a kind of value that no key takes."""

Key = tuple[str, ...]


class RefusedError(ValueError):
    """What a study file may not hold. key: dotted, of at most three steps."""

    def __init__(self, path: Key, reason: str) -> None:
        """path: where it stands; the reason is said to the person who wrote it."""
        super().__init__(reason)
        self.key = dotted(path[:3])


class BoundedComposer(Composer):
    """Makes the graph of a text; stops in time at one of too many nodes."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        """The next node. Raises RefusedError where there have been too many."""
        self.count = getattr(self, "count", 0) + 1
        if self.count > MOST:
            raise RefusedError((), f"holds more than {MOST:,} keys and values")
        return super().compose_node(parent, index)


class Constructor(SafeConstructor):
    """Makes plain values; one that cannot be made is told with its place."""

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """The value of a node. Raises MarkedYAMLError where it has none."""
        try:
            return super().construct_object(node, deep)
        except (MarkedYAMLError, RecursionError):
            raise
        except Exception as error:  # int, float, datetime and base64 each have their own
            kind = str(node.tag).removeprefix(_CORE)
            reason = f"cannot be read as {kind} ({str(error)[:80]})"
            raise ConstructorError(None, None, reason, node.start_mark) from None


def check_size(root: Node) -> None:
    """Raises RefusedError where the graph stands for too many nodes, or one too deep.

    Also for a tag, a number or a key of a kind that no study needs.
    """
    _Counter().measured(root, ())


class _Counter:
    """Sizes and heights of what nodes stand for, each node looked at once."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[int, int]] = {}

    def measured(self, node: Node, path: Key) -> tuple[int, int]:
        """(nodes, levels) that a node stands for, its aliases followed."""
        if id(node) not in self._known:
            if len(path) > _DEEPEST:  # ends at a node that holds itself, too
                raise RefusedError(path, "nests too deeply")
            _check_kind(node, path)
            below = [self.measured(child, (*path, step)) for step, child in _children(node)]
            size = 1 + sum(each for each, _ in below)
            height = 1 + max((each for _, each in below), default=0)
            self._known[id(node)] = size, height
        size, height = self._known[id(node)]
        if size > MOST:
            raise RefusedError(path, "holds too much: what its aliases stand for counts each time")
        if len(path) + height > _DEEPEST + 1:
            raise RefusedError(path, "nests too deeply")
        return size, height


def _children(node: Node) -> Iterator[tuple[str, Node]]:
    if isinstance(node, SequenceNode):
        yield from ((str(at), child) for at, child in enumerate(node.value))
    elif isinstance(node, MappingNode):
        for key, child in node.value:
            step = str(key.value) if isinstance(key, ScalarNode) else "?"
            yield step, key
            yield step, child


def _check_kind(node: Node, path: Key) -> None:
    """Raises RefusedError for what plain keys, lists and values are not."""
    tag = str(node.tag)
    if tag.removeprefix(_CORE) not in _TAGS:
        raise RefusedError(path, f"has the tag {dotted([tag.replace(_CORE, '!!')])}: take it out")
    if isinstance(node, ScalarNode) and not _whole_letters(node.value):
        raise RefusedError(path, "holds half of a character (\\ud800 to \\udfff): write it out")
    number = tag.removeprefix(_CORE) in ("int", "float")
    if number and len(node.value) > _DIGITS:
        raise RefusedError(path, f"is a number of {len(node.value):,} characters")
    if isinstance(node, MappingNode):
        for key, _ in node.value:
            if not isinstance(key, ScalarNode):
                raise RefusedError(path, "a key must be a word, not a list or a mapping")


def _whole_letters(text: str) -> bool:
    """Whether it is text: the escapes of YAML can give halves of characters."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)
