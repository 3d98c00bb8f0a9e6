"""Analyses of the runs of a study, and how far to trust them: from runs.nc to analysis.nc.

`variables.ANALYSES` is the registry of all analyses.
"""
