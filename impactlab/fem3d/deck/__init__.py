"""Input decks: the quarter model of an impact for other finite-element programs."""

from impactlab.fem3d.deck.write import FLAVOURS as FLAVOURS
from impactlab.fem3d.deck.write import write_deck as write_deck
