"""Sensitivity indices of the responses of a sample, and verdicts on them.

Each method is a file with its record `METHOD`; `indices` has the registry.
"""

from impactlab.analysis.sensitivity.indices import METHODS as METHODS
from impactlab.analysis.sensitivity.indices import analysis as analysis
from impactlab.analysis.sensitivity.indices import applies as applies
