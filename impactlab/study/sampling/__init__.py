"""From a study to its design: the coordinates of all runs, multiplied out or drawn."""

from impactlab.study.sampling.design import design

__all__ = ["design"]
