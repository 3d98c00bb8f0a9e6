"""What the responses of a sample depend on, and how far the answer is to be trusted.

One method a file, each a line in `methods`; `indices` puts them to a study's runs.
"""

from impactlab.analysis.sensitivity.indices import analysis, applies

__all__ = ["analysis", "applies"]
