"""Checks of the solver against independent solutions, one subject per file, listed in `catalogue`.

The tests in tests/verification and the verification study run the same checks.
"""
