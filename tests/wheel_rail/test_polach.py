"""What Polach's law has of its own; what it shares with all others stands in `test_creep_laws`."""

import numpy as np
import pytest

from tests.wheel_rail.conftest import LOAD_N, SHEAR_PA
from wheel_rail.polach import polach_force


def test_small_spin_comes_near_kalkers_linear_force(patch: np.ndarray) -> None:
    """Spin alone, where Polach's approximation follows Kalker within a few per cent."""
    a, b, _, _, c23, _ = patch
    constant = np.array([0.33, 1.0, 0.0, 1.0, 1.0])
    _, fy, _, _ = polach_force(0.0, 0.0, 0.01, 0.0, LOAD_N, patch, constant, SHEAR_PA)
    assert -fy / 0.01 == pytest.approx(SHEAR_PA * (a * b) ** 1.5 * c23, rel=0.05)
