"""Decisions made from answers: which discretisation is fine enough, how many samples suffice."""
