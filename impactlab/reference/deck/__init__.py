"""Input decks: the quarter model of an impact for finite-element programs that others wrote."""

from impactlab.reference.deck.write import FLAVOURS as FLAVOURS
from impactlab.reference.deck.write import write_deck as write_deck
