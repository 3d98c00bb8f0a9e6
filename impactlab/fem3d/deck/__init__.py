"""Input decks: the quarter model of an impact for finite-element programs that others wrote."""

from impactlab.fem3d.deck.write import FLAVOURS as FLAVOURS
from impactlab.fem3d.deck.write import write_deck as write_deck
