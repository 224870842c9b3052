"""A contact of usual size and load, twice as wide as long."""

import numpy as np
import pytest

from wheel_rail.kalker import creep_coefficients
from wheel_rail.polach import SURFACES

SHEAR_PA = 82e9
LOAD_N = 106_700.0


@pytest.fixture(scope="session")
def patch() -> np.ndarray:
    return np.array([6.304e-3, 12.61e-3, *creep_coefficients(0.5, 0.28), 1.0 + 6.3 * (1.0 - np.exp(-0.5))])


def law(surface: str) -> np.ndarray:
    s = SURFACES[surface]
    return np.array([s.mu0, s.falling_a, s.falling_b_spm, s.k_adhesion, s.k_slip])
