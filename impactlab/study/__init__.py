"""Studies: what a YAML file asks for, drawn up as runs, solved under dask, kept on disk."""

SHARDS, TRIALS, REFINEMENT = "shards", "trials", "refinement"
"""Folders beside a study's results: its own runs, pilot runs for `auto`, runs on finer grids."""
CALIBRATION = "calibration"
"""Folder beside a study's results: runs under other contact laws, and runs that confirm."""
RESOLUTION = "resolution.nc"
"""File beside a study's results: what the pilot runs found."""
