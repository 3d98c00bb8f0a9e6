"""Independent solutions to check the solver against: closed forms and a modal series.

They import neither the kernels nor simulate, because a check against itself proves nothing.
"""
