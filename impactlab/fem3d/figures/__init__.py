"""Figures of the 3-D FE model: those of a study with runs of it, and those of one run."""
