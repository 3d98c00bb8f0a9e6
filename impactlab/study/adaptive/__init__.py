"""Decisions made from answers: what to solve next, and when it is enough."""
