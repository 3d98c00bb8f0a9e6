"""Sensitivity indices of the responses of a sample, and verdicts on them.

The estimators are in impactlab.methods, one file per method.
"""

from impactlab.analysis.sensitivity.indices import analysis as analysis
