"""Named numbers for compiled code: a controller's constants and its state are parts of one record of numpy.

Every argument of a compiled function costs a little at each call, so that many numbers come as one record. A controller
adds its fields to those of `wsp.controllers.supervision`; compiled code reads `c.cut_off_mps` and
writes `s.speed_mps[axle]`.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

Function = TypeVar("Function", bound=Callable[..., Any])


def part_of_tick(function: Function) -> Function:
    """Compile what a tick is made of: not to be called from Python, and kept on disk with the tick alone.

    That halves the time that compiling takes. Numbers are treated as `wsp.compiled` says.
    """
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return cast(Function, njit(error_model="numpy", fastmath=False, **options)(function))


@cache
def _dtype_of(fields: tuple[tuple[str, np.dtype, tuple[int, ...]], ...]) -> np.dtype:
    """One object for equal fields: numba knows a record type by it at once, one that is only equal costs it 10 us."""
    return np.dtype(list(fields), align=True)


def record_of(values: Mapping[str, Any]) -> NDArray[np.void]:
    """(1,) structured array of these numbers, flags and arrays, in their order; a float stays a float, an int an int.

    Raises ValueError if there are none.
    """
    arrays = {name: np.asarray(value) for name, value in values.items()}
    if not arrays:
        raise ValueError("a record needs at least one value")
    record = np.zeros(1, dtype=_dtype_of(tuple((name, array.dtype, array.shape) for name, array in arrays.items())))
    for name, array in arrays.items():
        record[name][0] = array
    return record


def ticks(time_s: float, period_s: float) -> int:
    """Whole ticks of a time, at least one."""
    return max(1, round(time_s / period_s))
