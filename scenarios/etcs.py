"""Limits of ETCS odometry (Subset-041, 5.3.1): how far a measured speed and a travelled distance may be off."""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

LOW_SPEED_KMH: Final = 30.0
TOP_SPEED_KMH: Final = 500.0


def speed_limit_kmh(speed_kmh: ArrayLike) -> NDArray[np.float64]:
    """Largest speed error allowed at a true speed: 2 km/h up to 30 km/h, then linear to 12 km/h at 500 km/h."""
    return np.interp(np.abs(speed_kmh), [LOW_SPEED_KMH, TOP_SPEED_KMH], [2.0, 12.0])


def distance_limit_m(travelled_m: ArrayLike) -> NDArray[np.float64]:
    """Largest distance error allowed `travelled_m` after the last reference: 5 m + 5 %."""
    return np.asarray(5.0 + 0.05 * np.abs(travelled_m), dtype=np.float64)
