"""Analyses of the runs of a study, and how far to trust them: from runs.nc to analysis.nc.

`analyse` has the table of all analyses.
"""
