"""The study file: its forms, what may stand in it, and reading it with all errors at once."""

from impactlab.study.declaration.declared import Declared
from impactlab.study.declaration.function import FunctionStudy
from impactlab.study.declaration.kinds import (
    read_any,
    read_impacts,
    read_study,
    read_verification,
    study_of_text,
)
from impactlab.study.declaration.methods import Fast, Grid, Grouped, Latin, Morris, Sample, Sobol
from impactlab.study.declaration.sections import Auto
from impactlab.study.declaration.study import Study
from impactlab.study.declaration.verification import Verification

__all__ = [
    "Auto",
    "Declared",
    "Fast",
    "FunctionStudy",
    "Grid",
    "Grouped",
    "Latin",
    "Morris",
    "Sample",
    "Sobol",
    "Study",
    "Verification",
    "read_any",
    "read_impacts",
    "read_study",
    "read_verification",
    "study_of_text",
]
