"""What the runs of a study say, and how far to trust it: from runs.nc to analysis.nc.

One analysis a file, each with `applies(runs)` and `analysis(runs)`; `analyse` has their table.
"""
