"""Decisions from answers: the runs to solve next, and when they are enough."""
