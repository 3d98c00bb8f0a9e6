"""Study files with random damage: every kind of study, every kind of mistake, and raw bytes."""

import json
from functools import cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from ruamel.yaml import YAML

_UNIFORM = "{distribution: uniform, low: 1 m/s, high: 2 m/s}"
_DEPTH = "{distribution: normal, mean: 27.8 mm, standard_deviation: 0.1 mm}"
_BOUNDED = "{distribution: truncated_normal, mean: 1, standard_deviation: 1, low: 0.5, high: 9}"
_HEAD = "title: Fuzz\ndescription: d\nimpact: {base: paper, gravity: 9.81}\nduration: 1 ms\n"
_PAIR = f"parameters: {{velocity: {_UNIFORM}, beam_depth: {_DEPTH}}}"
_ENDS = f"parameters: {{velocity: {_UNIFORM}, gravity: {_BOUNDED}}}"
_STEEL = "density: 7800, youngs_modulus: 210 GPa, poissons_ratio: 0.3, yield_stress: 345 MPa"

VALID = {
    "grid": _HEAD
    + "discretisation: {nodes: 21, points: 5, rule: lobatto, courant: 0.9}\n"
    + "sampling: {method: grid, parameters: {velocity: [0.5 m/s, 1], nodes: [11, 21, 41],"
    + " beam_depth: {start: 20 mm, stop: 40 mm, number: 3, spacing: log}, contact: [hertz, mjg]}}\n"
    + "responses: [peak_force]\nanalyses: [convergence_in_nodes]\n"
    + "store: {histories: true, profiles: false, samples: 100}\n",
    "spelled out": "title: Fuzz\nduration: 1e-3\n"
    + "impact: {velocity: 0.99, contact: hertz, beam_model: elastic,"
    + f" sphere: {{radius: 35 mm, mass: null, material: {{{_STEEL}}}}},"
    + f" beam: {{span: 780 mm, width: 6 cm, depth: 0.03, material: {{{_STEEL},"
    + " isotropic_hardening_modulus: 1 GPa}}}\n"
    + "sampling: {method: grid, parameters: {gravity: [0, 9.81]}}\n",
    "sobol": _HEAD
    + f"sampling: {{method: sobol, base_samples: 64, second_order: false, seed: 0, {_PAIR},"
    + " until: {interval: 0.02, runs: 20000, responses: [peak_force]}}\n"
    + "analysis: {confidence: 0.9, resamples: 50, failed_runs: impute}\n",
    "morris": _HEAD
    + f"sampling: {{method: morris, trajectories: 8, levels: 4, {_ENDS},"
    + " groups: {a: [velocity], b: [gravity]}}\n",
    "fast": _HEAD + f"sampling: {{method: fast, samples: 900, harmonics: 4, {_PAIR}}}\n",
    "pawn": _HEAD + f"sampling: {{method: pawn, samples: 100, seed: 3, {_PAIR}}}\n",
    "regression": _HEAD
    + f"sampling: {{method: regression, samples: 64, {_ENDS}}}\nanalyses: [surrogate]\n",
    "auto": _HEAD
    + "discretisation: {auto: {tolerance: 2 %, responses: [peak_force]}, rule: legendre}\n"
    + f"sampling: {{method: sobol, base_samples: 8, {_PAIR}}}\n",
    "function": "title: Fuzz\nfunction: ishigami\n"
    + "sampling: {method: sobol, base_samples: 8, parameters: {"
    + "x1: {distribution: uniform, low: -3, high: 3},"
    + " x2: {distribution: triangular, low: -3, mode: 0, high: 3},"
    + " x3: {distribution: fixed, value: 1}}}\nanalysis: {resamples: 20}\n",
    "checks": "title: Fuzz\ndescription: d\nchecks: [half_space, rigid_beam]\n",
}
"""One valid file of each kind."""

_WORDS = [
    *("all", "auto", "true", "null", "paper", "hertz", "velocity", "peak_force", "grid", "sobol"),
    *("morris", "uniform", "fixed", "345 mPa", "12ms", "1e400", "nan", "inf", "0x10", "1_000"),
    *("<b>", "=1+1", "../../etc/passwd", "{{7*7}}", "$x_y$", "%s", "\\", "[red]", "5e-324", "%"),
]
_VERBATIM = (
    ".nan -.inf .inf 1e400 -1e400 0x7fffffffffffffff 0o17 1_000 2020-01-01 2020-02-30 "
    "2001-12-14t21:59:43.10-05:00 12:30:45 ~ yes !!binary aGk= !!set {a} !!str 1 !!int x !!float x "
    "!x 1 *a *none &a 1 &a [*a] {<<: *a} {<<: {a: 1}} {<<: [1]} [] {} [[[[[[1]]]]]] '' @ ` %"
)
_TOKENS = [
    *(word for word in _VERBATIM.split() if not word.startswith(("!!", "!x", "&"))),
    *("!!binary aGk=", "!!set {a}", "!!str 1", "!!int x", "!!float x", "!!timestamp x", "!x 1"),
    *("&a 1", "&a [*a]", "{<<: *a}", "{<<: {a: 1}}", "!!null x", "!!omap [a: 1]", "? [a, b]"),
    *("1" + "0" * 400, "0x" + "f" * 300, "9" * 5000, "0x" + "f" * 5000, "1." + "9" * 900),
    *("[" * 60 + "]" * 60, "&b [" + "1, " * 50 + "1]", "[*b, *b, *b, *b]", '"' + "x" * 3000 + '"'),
]


_UNITS = ["m", "mm", "MPa", "kg", "s", "m/s", "1", "%"]


class Verbatim(str):
    """YAML to be written verbatim."""


class Pairs(list[list[Any]]):
    """A mapping as a list of [key, value]: a key may come twice."""


_GENTLE = st.sampled_from(
    [
        *(1, 2, 3, 5, 11, 21, 64, 128, 0.5, 0.01, 20.0, 1e6, 1e9, True, False, "all", "hertz"),
        *("1 mm", "30 mm", "2 m", "1 GPa", "500 MPa", "2 s", "1 us", "9 m/s", "1 kg", "stronge"),
        *("timoshenko", "rigid", "modal", "layers", "auto", "log", "linear", "impute"),
    ]
)
"""Values that are often valid where they are put."""
_LEAVES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.integers(min_value=-(10**30), max_value=10**30),
    st.floats(),
    st.sampled_from([0, 1, 2, 3, 64, 10**7, 10**12, 2**53, 1e-300, 1e300, -1, 0.5]),
    st.text(max_size=12),
    st.sampled_from(_WORDS),
    st.builds("{} {}".format, st.floats(width=32), st.sampled_from(_UNITS)),
    st.sampled_from(_TOKENS).map(Verbatim),
)
_VALUES = st.recursive(
    _LEAVES,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(st.tuples(st.text(max_size=6) | st.sampled_from(_WORDS), inner), max_size=3).map(
            lambda pairs: Pairs(map(list, pairs))
        )
    ),
    max_leaves=5,
)


def _tree(data: Any) -> Any:
    if isinstance(data, dict):
        return Pairs([key, _tree(value)] for key, value in data.items())
    return [_tree(value) for value in data] if isinstance(data, list) else data


def _places(tree: Any) -> list[tuple[list[Any], int]]:
    """Return every (list or pairs, position) below a tree."""
    found = []
    for at, entry in enumerate(tree if isinstance(tree, list) else []):
        found.append((tree, at))
        found += _places(entry[1] if isinstance(tree, Pairs) else entry)
    return found


_KINDS = ("gentle", "gentle", "gentle", "value", "value", "remove", "rename", "twice", "swap")


def _damage(draw: Any, tree: Any) -> None:
    places = _places(tree)
    if not places:
        return
    parent, at = draw(st.sampled_from(places))
    kind = draw(st.sampled_from(_KINDS))
    if kind == "remove":
        del parent[at]
    elif kind == "twice":
        parent.insert(draw(st.integers(0, len(parent))), parent[at])
    elif kind == "rename" and isinstance(parent, Pairs):
        names = st.text(max_size=8) | st.sampled_from(_WORDS) | st.sampled_from(_TOKENS)
        parent[at] = [draw(names.map(Verbatim) | names), parent[at][1]]
    elif kind == "swap":
        other, there = draw(st.sampled_from(places))
        if isinstance(parent, Pairs) == isinstance(other, Pairs):
            parent[at] = _copy(other[there])
    else:
        value = draw(_GENTLE if kind == "gentle" else _VALUES)
        parent[at] = [parent[at][0], value] if isinstance(parent, Pairs) else value


def _copy(entry: Any) -> Any:
    """Return a deep copy: the original may contain the place of the copy."""
    if isinstance(entry, list):
        return type(entry)(_copy(each) for each in entry)
    return entry


def _written(tree: Any) -> str:
    if isinstance(tree, Pairs):
        return "{" + ", ".join(f"{_written(key)}: {_written(value)}" for key, value in tree) + "}"
    if isinstance(tree, list):
        return "[" + ", ".join(map(_written, tree)) + "]"
    if isinstance(tree, Verbatim):
        return str(tree)
    return json.dumps(tree).replace("NaN", ".nan").replace("Infinity", ".inf")


@cache
def _content(kind: str) -> Any:
    return YAML(typ="safe", pure=True).load(VALID[kind])


@st.composite
def damaged(draw: Any, kind: str) -> bytes:
    """Return a study file of this kind with one to three mistakes, and sometimes broken bytes."""
    tree = _tree(_content(kind))
    for _ in range(draw(st.integers(1, 3))):
        _damage(draw, tree)
    text = "\n".join(f"{_written(key)}: {_written(value)}" for key, value in tree)
    raw = text.encode("utf-8", "surrogatepass")
    if draw(st.integers(0, 7)) == 0:
        at = draw(st.integers(0, len(raw)))
        raw = raw[:at] + draw(st.binary(max_size=8)) + raw[at + draw(st.integers(0, 8)) :]
    return raw


_YAML_BYTES = st.lists(
    st.sampled_from([*b"abk01.:-,?&*!|>'\"%@`#{}[] \t\n\r~<=\\\x00\x1b\xc3\xa9\xff"]), max_size=60
).map(bytes)
raw_bytes = st.binary(max_size=200) | _YAML_BYTES
"""Bytes that need not be text at all."""


def exploding(levels: int, width: int, merged: bool) -> bytes:
    """Return a "billion laughs" file: aliases or merge keys that expand to width**levels values."""
    inner = "{k: 1, l: 2}"
    lines = [f"a0: &a0 {inner}"]
    for level in range(1, levels):
        many = ", ".join([f"*a{level - 1}"] * width)
        lines.append(f"a{level}: &a{level} " + (f"{{<<: [{many}]}}" if merged else f"[{many}]"))
    return "\n".join(lines).encode()


def write(folder: Path, raw: bytes) -> Path:
    """Write a study file of these bytes and return its path."""
    path = folder / "fuzz.yaml"
    path.write_bytes(raw)
    return path
