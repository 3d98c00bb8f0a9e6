"""Runs of the 3-D FE model within a study: cases, cost, answers, and report sections."""
