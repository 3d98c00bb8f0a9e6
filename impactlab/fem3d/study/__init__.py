"""Runs of the 3-D FE model within a study: their cases, what they cost, and their answers."""
