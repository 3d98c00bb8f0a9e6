"""The decorators of this solver's loops (see impactlab.jit).

Products may be fused with sums, but no sum is reordered: the same bits for any number of threads.
"""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from impactlab.jit import Compiler

Array: TypeAlias = np.ndarray[Any, Any]  # an array as an argument of compiled functions

COMPILER = Compiler(Path(__file__).parent)
compiled = COMPILER.decorator(fastmath={"contract"})
inlined = COMPILER.decorator(fastmath={"contract"}, inline=True)
