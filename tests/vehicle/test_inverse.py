"""The inverse in place against numpy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vehicle.inverse import invert

WIDTH = 48


def inverse_of(matrix: np.ndarray) -> np.ndarray | None:
    n = len(matrix)
    padded = np.zeros((n, WIDTH))
    padded[:, :n] = matrix
    flat = padded.ravel()
    found = invert(flat, WIDTH)
    assert not flat.reshape(n, WIDTH)[:, n:].any() or not found
    return flat.reshape(n, WIDTH)[:, :n].copy() if found else None


@settings(max_examples=60)
@given(n=st.integers(1, 46), seed=st.integers(0, 10_000), empty=st.floats(0.0, 0.8))
def test_any_matrix_times_its_inverse_is_one(n: int, seed: int, empty: float) -> None:
    """Rows in any order, so that the largest of a column stands anywhere, and many zeros."""
    rng = np.random.default_rng(seed)
    matrix = np.where(rng.random((n, n)) < empty, 0.0, rng.normal(size=(n, n)))
    matrix += np.diag(rng.choice([-1.0, 1.0], n) * (3.0 + n))
    matrix = matrix[rng.permutation(n)]
    found = inverse_of(matrix)
    assert found is not None
    assert matrix @ found == pytest.approx(np.eye(n), abs=1e-11)


def test_a_diagonal_of_zeros_is_no_hindrance() -> None:
    turn = np.roll(np.eye(5), 1, axis=0)
    found = inverse_of(turn)
    assert found is not None
    assert (found == turn.T).all()


@pytest.mark.parametrize("matrix", [np.zeros((3, 3)), np.ones((3, 3)), np.full((2, 2), np.nan)])
def test_what_has_no_inverse_is_told(matrix: np.ndarray) -> None:
    assert inverse_of(matrix) is None
