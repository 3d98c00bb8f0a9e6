"""A parser of input decks, independent of the code that writes them."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass
class Card:
    """A keyword, its parameters (None: a word alone) and its data lines, split at the commas."""

    keyword: str
    parameters: dict[str, str | None]
    data: list[list[str]] = field(default_factory=list)


def cards(path: Path) -> list[Card]:
    """Return the deck's cards in their order, without comments."""
    found: list[Card] = []
    for line in path.read_text(encoding="ascii").splitlines():
        if line.startswith("**"):
            continue
        entries = [entry.strip() for entry in line.split(",")]
        if line.startswith("*"):
            words = [entry.partition("=") for entry in entries[1:]]
            parameters = {name: value if sign else None for name, sign, value in words}
            found.append(Card(entries[0][1:], parameters))
        else:
            found[-1].data.append(entries)
    return found


def named(deck: list[Card], keyword: str, **parameters: str) -> Card:
    """Return the one card of this keyword with these parameters."""
    (card,) = [
        card
        for card in deck
        if card.keyword == keyword and parameters.items() <= card.parameters.items()
    ]
    return card


def numbers(card: Card) -> NDArray[np.float64]:
    """Return the data of a card whose lines all have the same length."""
    return np.array(card.data, dtype=float)


def members(deck: list[Card], name: str) -> NDArray[np.int64]:
    """Return the node numbers, from 1, of a set."""
    if lines := [
        line[:1]
        for c in deck
        if c.keyword == "NODE" and c.parameters.get("NSET") == name
        for line in c.data
    ]:
        return np.array(lines, dtype=np.int64).ravel()
    lines = named(deck, "NSET", NSET=name).data
    return np.array([int(entry) for line in lines for entry in line])


def elements(deck: list[Card]) -> dict[str, NDArray[np.int64]]:
    """Return number and nodes of each element, (e, 9), by set."""
    return {
        str(card.parameters["ELSET"]): np.array(card.data, dtype=np.int64)
        for card in deck
        if card.keyword == "ELEMENT"
    }


FACES = {  # of an eight-node brick, as the manuals of both programs number them
    "S1": (1, 2, 3, 4),
    "S2": (5, 8, 7, 6),
    "S3": (1, 5, 6, 2),
    "S4": (2, 6, 7, 3),
    "S5": (3, 7, 8, 4),
    "S6": (4, 8, 5, 1),
}


def surface(deck: list[Card], name: str) -> NDArray[np.float64]:
    """Return the corners of a surface's faces, (f, 4, 3)."""
    nodes = {int(line[0]): [float(x) for x in line[1:]] for line in named(deck, "NODE").data}
    corners = {int(row[0]): row[1:] for rows in elements(deck).values() for row in rows}
    faces = named(deck, "SURFACE", NAME=name).data
    return np.array(
        [[nodes[int(corners[int(e)][n - 1])] for n in FACES[face]] for e, face in faces]
    )
