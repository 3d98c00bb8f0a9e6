"""Checks of what a user states: mistakes in words, sections of keys, values of parameters."""
