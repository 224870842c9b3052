"""The decorator of the plant's compiled functions, and the types in their signatures.

Compiled code is cached on disk. Division follows IEEE (inf, nan) instead of raising; floating point is never reordered,
nor a product taken into a sum. That is said although it is numba's default: a function that leaves it open takes it
from whoever calls it first, and results would hang on the order of compiling.
"""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
CodeArray = NDArray[np.int8]
Record = Any  # a record of a structured array, whose fields are attributes in compiled code

compiled = njit(cache=True, error_model="numpy", fastmath=False)
