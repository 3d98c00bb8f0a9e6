"""A checker of Abaqus' syntax, for the keywords that a deck uses.

Only what holds for explicit dynamics; a keyword or parameter that is not listed is a complaint.
Source: the Keywords Guide, of which *CONTACT PAIR, *SECTION CONTROLS, *PLASTIC, *CYCLIC HARDENING
and *SPRING were read (2016, 2017), and the library of springs; the rest is from memory.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

from decks import Card, cards

MODEL, STEP = "model", "step"


@dataclass(frozen=True)
class Rule:
    """Parameters with their allowed values (None: any), data lines and entries on each of them.

    follows: the keyword of which it is an option, with only its other options between.
    """

    level: str
    required: dict[str, set[str | None] | None] = field(default_factory=dict)
    optional: dict[str, set[str | None] | None] = field(default_factory=dict)
    lines: tuple[int, int] = (0, 0)
    entries: tuple[int, int] = (1, 1)
    follows: str | None = None


MANY = 10**9
NODES: dict[str | None, int] = {"C3D8": 8, "C3D8R": 8, "SPRINGA": 2}
"""Elements of Abaqus/Explicit, which has no SPRING1 or SPRING2, and the nodes of each."""
FLAG: set[str | None] = {None}
RULES = {
    "HEADING": Rule(MODEL, lines=(1, MANY), entries=(1, 80)),
    "NODE": Rule(MODEL, optional={"NSET": None}, lines=(1, MANY), entries=(4, 4)),
    "ELEMENT": Rule(MODEL, {"TYPE": {*NODES}}, {"ELSET": None}, lines=(1, MANY), entries=(2, MANY)),
    "SPRING": Rule(MODEL, {"ELSET": None}, lines=(2, 2), entries=(1, 1)),
    "ELSET": Rule(MODEL, {"ELSET": None}, lines=(1, MANY), entries=(1, 16)),
    "NSET": Rule(MODEL, {"NSET": None}, lines=(1, MANY), entries=(1, 16)),
    "SURFACE": Rule(MODEL, {"NAME": None}, {"TYPE": {"ELEMENT"}}, lines=(1, MANY), entries=(2, 2)),
    "MATERIAL": Rule(MODEL, {"NAME": None}),
    "DENSITY": Rule(MODEL, lines=(1, 1), entries=(1, 1), follows="MATERIAL"),
    "ELASTIC": Rule(MODEL, lines=(1, 1), entries=(2, 2), follows="MATERIAL"),
    "DAMPING": Rule(MODEL, optional={"ALPHA": None, "BETA": None}, follows="MATERIAL"),
    "PLASTIC": Rule(
        MODEL,
        optional={
            "HARDENING": {"ISOTROPIC", "KINEMATIC", "COMBINED"},
            "DATA TYPE": {"HALF CYCLE", "PARAMETERS", "STABILIZED"},
            "NUMBER BACKSTRESSES": None,
        },
        lines=(1, MANY),
        entries=(2, 3),
        follows="MATERIAL",
    ),
    "CYCLIC HARDENING": Rule(MODEL, lines=(1, MANY), entries=(2, 2), follows="MATERIAL"),
    "SECTION CONTROLS": Rule(
        MODEL,
        {"NAME": None},
        {"HOURGLASS": {"COMBINED", "ENHANCED", "RELAX STIFFNESS", "STIFFNESS", "VISCOUS"}},
    ),
    "SOLID SECTION": Rule(MODEL, {"ELSET": None, "MATERIAL": None}, {"CONTROLS": None}),
    "BOUNDARY": Rule(MODEL, lines=(1, MANY), entries=(2, 4)),
    "INITIAL CONDITIONS": Rule(MODEL, {"TYPE": {"VELOCITY"}}, lines=(1, MANY), entries=(3, 3)),
    "SURFACE INTERACTION": Rule(MODEL, {"NAME": None}),
    "FRICTION": Rule(MODEL, lines=(1, 1), entries=(1, 1), follows="SURFACE INTERACTION"),
    "SURFACE BEHAVIOR": Rule(
        MODEL, optional={"PRESSURE-OVERCLOSURE": {"HARD"}}, follows="SURFACE INTERACTION"
    ),
    "STEP": Rule(MODEL, optional={"NAME": None, "NLGEOM": {"YES", "NO"}}),
    "DYNAMIC": Rule(STEP, {"EXPLICIT": FLAG}, lines=(1, 1), entries=(2, 4), follows="STEP"),
    "DLOAD": Rule(STEP, lines=(1, MANY), entries=(6, 6)),
    "CONTACT PAIR": Rule(
        STEP,
        {"INTERACTION": None},
        {"MECHANICAL CONSTRAINT": {"KINEMATIC", "PENALTY"}, "CPSET": None},
        lines=(1, MANY),
        entries=(2, 2),
    ),
    "OUTPUT": Rule(
        STEP,
        optional={"FIELD": FLAG, "HISTORY": FLAG, "TIME INTERVAL": None, "NUMBER INTERVAL": None},
    ),
    "NODE OUTPUT": Rule(STEP, optional={"NSET": None}, lines=(1, MANY), entries=(1, 16)),
    "ELEMENT OUTPUT": Rule(STEP, optional={"ELSET": None}, lines=(1, MANY), entries=(1, 16)),
    "CONTACT OUTPUT": Rule(STEP, optional={"CPSET": None}, lines=(1, MANY), entries=(1, 16)),
    "ENERGY OUTPUT": Rule(STEP, optional={"ELSET": None}, lines=(1, MANY), entries=(1, 16)),
    "END STEP": Rule(STEP),
}
VARIABLES = {  # by request: of explicit dynamics; components are for histories alone
    "NODE OUTPUT": {"HISTORY": {"U3", "V3", "A3"}, "FIELD": {"U", "V", "A"}},
    "ELEMENT OUTPUT": {"HISTORY": set(), "FIELD": {"S", "PEEQ", "LE"}},
    "CONTACT OUTPUT": {"HISTORY": {"CFN"}, "FIELD": {"CSTRESS"}},
    "ENERGY OUTPUT": {
        "HISTORY": {"ALLIE", "ALLKE", "ALLPD", "ALLAE", "ALLVD", "ALLWK", "ETOTAL"},
        "FIELD": set(),
    },
}
DEFINES = {  # what a name can be of: keyword and parameter that define it
    "node set": [("NODE", "NSET"), ("NSET", "NSET")],
    "element set": [("ELEMENT", "ELSET"), ("ELSET", "ELSET")],
    "surface": [("SURFACE", "NAME")],
    "contact pair set": [("CONTACT PAIR", "CPSET")],
    "material": [("MATERIAL", "NAME")],
    "section controls": [("SECTION CONTROLS", "NAME")],
    "surface interaction": [("SURFACE INTERACTION", "NAME")],
}
USES = [  # keyword, the parameter or the entries of a data line that use a name, of what it is
    ("BOUNDARY", slice(1), "node set"),
    ("INITIAL CONDITIONS", slice(1), "node set"),
    ("NODE OUTPUT", "NSET", "node set"),
    ("ELSET", slice(1), "element set"),
    ("DLOAD", slice(1), "element set"),
    ("SOLID SECTION", "ELSET", "element set"),
    ("SPRING", "ELSET", "element set"),
    ("CONTACT PAIR", slice(2), "surface"),
    ("CONTACT OUTPUT", "CPSET", "contact pair set"),
    ("SOLID SECTION", "MATERIAL", "material"),
    ("SOLID SECTION", "CONTROLS", "section controls"),
    ("CONTACT PAIR", "INTERACTION", "surface interaction"),
]
LABEL = re.compile(r"[A-Z][A-Z0-9_]{0,79}$")
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")


def complaints(path: Path) -> list[str]:
    """Return what Abaqus would refuse, one sentence each; empty for a valid deck."""
    deck = cards(path)
    found = [
        f"line {n}: {len(line)} characters"
        for n, line in enumerate(path.read_text().splitlines(), 1)
        if len(line) > 256
    ]
    found += [f"*{card.keyword}: unknown" for card in deck if card.keyword not in RULES]
    deck = [card for card in deck if card.keyword in RULES]
    for card in deck:
        found += [f"*{card.keyword}: {words}" for words in _of_card(card, RULES[card.keyword])]
    return found + _order(deck) + _names(deck) + _outputs(deck)


def _of_card(card: Card, rule: Rule) -> list[str]:
    found = [f"{name} is missing" for name in rule.required if name not in card.parameters]
    allowed = rule.required | rule.optional
    for name, value in card.parameters.items():
        if name not in allowed:
            found.append(f"no parameter {name}")
        elif (values := allowed[name]) is not None and value not in values:
            found.append(f"{name}={value}")
        elif (
            value is not None
            and allowed[name] is None
            and not (LABEL.match(value) or NUMBER.match(value))
        ):
            found.append(f"{name}={value} is neither label nor number")
    if not rule.lines[0] <= len(card.data) <= rule.lines[1]:
        found.append(f"{len(card.data)} data lines")
    counts = {len(line) for line in card.data}
    least, most = rule.entries
    found += [f"{n} entries per line" for n in counts if not least <= n <= most]
    if card.keyword == "ELEMENT" and (nodes := NODES.get(card.parameters.get("TYPE"))):
        found += [f"{n} entries per line" for n in counts if n != nodes + 1]
    if card.keyword == "SPRING" and card.data and card.data[0] != [""]:
        found.append("the first line of SPRINGA is not blank")
    return found


def _order(deck: list[Card]) -> list[str]:
    """Check that the model precedes the step, options follow their keyword, and the step ends."""
    found, inside, owner = [], False, ""
    for card in deck:
        rule = RULES[card.keyword]
        if inside != (rule.level == STEP):
            found.append(f"*{card.keyword}: {'inside' if inside else 'outside'} the step")
        if rule.follows is None:
            owner = card.keyword
        elif rule.follows != owner:
            found.append(f"*{card.keyword}: follows *{owner}")
        inside = (inside or card.keyword == "STEP") and card.keyword != "END STEP"
    return found + ["no *END STEP"] * inside


def _names(deck: list[Card]) -> list[str]:
    """Check that every name used is defined."""
    there = {
        kind: {c.parameters.get(parameter) for c in deck if c.keyword == keyword}
        | {c.parameters.get(other) for c in deck for word, other in more if c.keyword == word}
        for kind, [(keyword, parameter), *more] in DEFINES.items()
    }
    return [
        f"*{keyword}: {name} is not defined"
        for keyword, where, kind in USES
        for card in deck
        if card.keyword == keyword
        for name in _used(card, where)
        if name not in there[kind]
    ]


def _used(card: Card, where: str | slice) -> list[str | None]:
    if isinstance(where, slice):
        return [entry for line in card.data for entry in line[where]]
    return [card.parameters[where]] if where in card.parameters else []


def _outputs(deck: list[Card]) -> list[str]:
    """Check that requests follow *OUTPUT and name variables that it can hold."""
    found, kind = [], None
    for card in deck:
        if card.keyword == "OUTPUT":
            kinds = [name for name in ("FIELD", "HISTORY") if name in card.parameters]
            kind = kinds[0] if len(kinds) == 1 else None
            found += ["*OUTPUT: neither FIELD nor HISTORY"] * (kind is None)
        elif card.keyword in VARIABLES:
            allowed = VARIABLES[card.keyword].get(kind or "", set())
            asked = {name for line in card.data for name in line}
            found += [f"*{card.keyword}: {name} in {kind}" for name in sorted(asked - allowed)]
    return found
