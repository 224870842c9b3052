"""The decorator of the plant's compiled functions, and the types in their signatures.

Compiled code is cached on disk. Division follows IEEE (inf, nan) instead of raising; floating point is never reordered.
"""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
CodeArray = NDArray[np.int8]
Record = Any  # a record of a structured array, whose fields are attributes in compiled code

compiled = njit(cache=True, error_model="numpy")
