"""The decorator of all compiled functions of track, contact and vehicle.

Compiled code is cached on disk. Division follows IEEE (inf, nan) instead of raising, which keeps branches out of the
hot loops; floating point is never reordered, so that results do not depend on the state of the cache.
"""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Record = Any  # a record of a structured array, whose fields are attributes in compiled code
Vector = Any  # an array or a tuple of floats

compiled = njit(cache=True, error_model="numpy")
