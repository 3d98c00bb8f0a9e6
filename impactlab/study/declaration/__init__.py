"""The study file: its forms, what may stand in it, and reading it with all errors at once."""

from impactlab.study.declaration.kinds import read_any, read_study, read_verification
from impactlab.study.declaration.methods import Grid, Sobol
from impactlab.study.declaration.study import Study
from impactlab.study.declaration.verification import Verification

__all__ = [
    "Grid",
    "Sobol",
    "Study",
    "Verification",
    "read_any",
    "read_study",
    "read_verification",
]
