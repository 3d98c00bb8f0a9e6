"""The model of an impact and its discretisation: frozen, self-checking dataclasses in SI units."""
