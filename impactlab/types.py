"""Array types that several modules name in their signatures."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""An array of real numbers; docstrings tell its shape and units."""
