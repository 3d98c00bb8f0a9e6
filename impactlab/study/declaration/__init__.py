"""The study file: its form, what may stand in it, and reading it with all errors at once."""

from impactlab.study.declaration.methods import Grid, Sobol
from impactlab.study.declaration.study import Study, read_study

__all__ = ["Grid", "Sobol", "Study", "read_study"]
