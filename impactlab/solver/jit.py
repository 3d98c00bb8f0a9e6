"""The decorators of this solver's kernels (see impactlab.jit), and their sources' hash."""

from pathlib import Path

from impactlab.jit import Compiler

_COMPILER = Compiler(Path(__file__).parent)
SOURCES_HASH = _COMPILER.sources_hash
"""Hash of the kernels that this process runs: the same hash, the same numbers."""

FOLDER = _COMPILER.folder
"""Where the compiled kernels are kept; None where they cannot be."""

compiled = _COMPILER.decorator()
"""It can neither make arrays nor free any: what a kernel works on belongs to its caller."""
allocating = _COMPILER.decorator(allocates=True)
"""A record of an array does not keep it alive here, so arrays of records come from Python."""
vectorised = _COMPILER.decorator(fastmath=True)
"""Free to reorder sums and blind to NaN: for loops over arrays."""
summing = _COMPILER.decorator(fastmath=True, inline=FOLDER is None)
"""As vectorised; inlined where each process compiles, whose kernel would link another copy, with
sums in another order, than a kernel from the cache."""
joined = _COMPILER.decorator(inline=FOLDER is None)
"""As compiled, for callers of `summing`: inlined with it, or the compiler inlines them only in some
kernels, and the sums in them have another order there."""
fused = _COMPILER.decorator(fastmath=True, inline=True)
inlined = _COMPILER.decorator(inline=True)
"""Part of its callers: a State handed on at every step takes longer than the step."""
