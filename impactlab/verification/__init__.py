"""The solver held against solutions independent of it: one check a file, listed in `catalogue`.

The tests in tests/verification and the verification study run the same checks.
"""
