"""The inverse of a matrix of a coach's size, in place and in whole registers.

A Jacobian is mostly zeros: wheelsets know their own bogie alone, bogies their wheelsets and the carbody. What comes
last in it is taken first and meets few others, and rows that do not meet are left alone. LAPACK's inverse, which knows
nothing of that, takes three times as long when compiled code calls it and six times from Python (22, 65 and 130 us for
46 coordinates, 80, 270 and 510 us for 94).
"""

import numpy as np

from wheel_rail.compiled import Array, compiled, inlined
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lanes import LANES


@compiled
def invert(matrix: Array, width: int) -> bool:
    """Put the inverse in the place of a square `matrix`, given as its rows one after the other, each filled up with
    zeros to `width`, a whole number of registers; False if it has none.

    Gauss-Jordan elimination with row pivoting, from the last column to the first.
    """
    n = matrix.size // width
    taken = np.empty(n, np.int64)
    for k in range(n - 1, -1, -1):
        pivot = k
        for i in range(k):
            if abs(matrix[i * width + k]) > abs(matrix[pivot * width + k]):
                pivot = i
        taken[k] = pivot
        largest = matrix[pivot * width + k]
        if not abs(largest) > 0.0:
            return False
        if pivot != k:
            _swap_rows(matrix, width, pivot, k)
        matrix[k * width + k] = 1.0
        for at in range(k * width, (k + 1) * width, LANES):
            put_lanes(matrix, at, lanes_at(matrix, at) * (1.0 / largest))
        for i in range(n):
            factor = matrix[i * width + k]
            if i == k or factor == 0.0:
                continue
            matrix[i * width + k] = 0.0
            for at in range(0, width, LANES):
                rest = lanes_at(matrix, i * width + at) - lanes_at(matrix, k * width + at) * factor
                put_lanes(matrix, i * width + at, rest)
    for k in range(n):
        if taken[k] != k:
            for i in range(n):
                a, b = i * width + k, i * width + taken[k]
                matrix[a], matrix[b] = matrix[b], matrix[a]
    return True


@inlined
def _swap_rows(matrix: Array, width: int, one: int, other: int) -> None:
    for at in range(0, width, LANES):
        kept = lanes_at(matrix, one * width + at)
        put_lanes(matrix, one * width + at, lanes_at(matrix, other * width + at))
        put_lanes(matrix, other * width + at, kept)
