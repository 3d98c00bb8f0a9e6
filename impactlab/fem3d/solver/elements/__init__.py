"""Hexahedra: the forces with which they answer a motion."""
