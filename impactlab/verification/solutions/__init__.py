"""Independent solutions to check the solver against: closed forms and a modal series.

Nothing here imports the kernels or simulate: a check against itself proves nothing.
"""
