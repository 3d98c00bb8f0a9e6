"""Runs of the 3-D model within a study: their cases, what they cost, and their answers."""
