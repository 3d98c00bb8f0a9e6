"""Surrogates: polynomial chaos expansions that stand in for the solver.

`fit(unit, values, seed)` gives one from points of the unit cube, `analysis(runs)` one of every
response of a sample with its test and Sobol indices, `load_surrogate(path)` those that
`impactlab analyse` keeps in surrogate.nc.
"""

from impactlab.analysis.surrogate.chaos import fit as fit
from impactlab.analysis.surrogate.from_runs import analysis as analysis
from impactlab.analysis.surrogate.stored import load_surrogate as load_surrogate
from impactlab.analysis.surrogate.stored import packed as packed
