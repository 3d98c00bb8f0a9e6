"""The decks' units, N, mm, t and s: what one of each SI unit is in them."""

NAMES = "N, mm, t, s (hence MPa, mJ, t/mm3, mm/s)"
LENGTH = 1e3
"""mm in a m."""
VELOCITY = 1e3
"""mm/s in a m/s."""
ACCELERATION = 1e3
"""mm/s2 in a m/s2."""
STRESS = 1e-6
"""MPa in a Pa."""
DENSITY = 1e-12
"""t/mm3 in a kg/m3."""
