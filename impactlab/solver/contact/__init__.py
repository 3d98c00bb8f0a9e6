"""Contact laws: one file a law, with the functions `curve` and `limit` (see hertz.py)."""

from impactlab.solver.contact.about import ABOUT

LAWS = tuple(ABOUT)
"""Names of the laws, each that of its file; the index is the kernels' switch."""
