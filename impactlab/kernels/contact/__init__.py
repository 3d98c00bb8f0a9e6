"""Contact laws: one file a law, each a function `curve` (see hertz.py for its form)."""

LAWS = (
    "hertz",
    "stronge",
)
"""Names of the laws, each that of its file; the index is the kernels' switch."""
