"""The decorator of all compiled functions of track, contact and vehicle, and access to arrays by their address.

Compiled code is cached on disk. Division follows IEEE (inf, nan) instead of raising, which keeps branches out of the
hot loops. A product and the sum it goes into may become one rounded operation, where the machine has it; nothing is
reordered else, so that results do not depend on the state of the cache.

Handing an array from Python to a compiled function costs some 0.2 us, a record more. Functions that are called at every
step take addresses instead: whoever hands them over keeps the arrays alive and where they are.
"""

from collections.abc import Callable
from typing import Any, cast

import numba
import numpy as np
from llvmlite import ir
from numba import from_dtype, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

Array = NDArray[np.float64]
Record = Any  # a record of a structured array, whose fields are attributes in compiled code
Vector = Any  # an array or a tuple of floats

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}
compiled = njit(**_OPTIONS)
# the same, taken into its callers: for the small parts of the hot path, whose calls cost a tenth of a step
inlined = njit(**_OPTIONS, inline="always")


def record_reader(dtype: np.dtype) -> Callable[[int], Record]:
    """A function for compiled code that gives the record of `dtype` that stands at an address."""
    record_type = from_dtype(dtype)

    @intrinsic
    def record_at(_typing: Any, address: Any) -> Any:
        def code(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(record_type))

        return record_type(types.intp), code

    return cast(Callable[[int], Record], record_at)


@intrinsic
def _pointer(_typing: Any, address: Any) -> Any:
    pointer = types.CPointer(types.float64)

    def code(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(pointer))

    return pointer(types.intp), code


@compiled
def array_at(address: int, shape: tuple[int, ...]) -> Array:
    """The contiguous array of floats of this shape that stands at an address."""
    return numba.carray(_pointer(address), shape)  # type: ignore[attr-defined, call-arg]


@intrinsic
def call_at(_typing: Any, address: Any, argument: Any, t_s: Any) -> Any:
    """Call the C function int64(int64, double) that stands at an address."""

    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        integer, double = ir.IntType(64), ir.DoubleType()
        kind = ir.FunctionType(integer, [integer, double])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), list(arguments[1:]))

    return types.int64(types.int64, types.int64, types.float64), code


_REGISTER_BYTES = 64


def aligned(array: np.ndarray) -> np.ndarray:
    """A copy at a multiple of the size of the registers of `wheel_rail.lanes`: elsewhere each read of one is two."""
    room = np.empty(array.nbytes + _REGISTER_BYTES, np.uint8)
    first = -room.ctypes.data % _REGISTER_BYTES
    copy = room[first : first + array.nbytes].view(array.dtype).reshape(array.shape)
    copy[...] = array
    return copy


def address_of(array: np.ndarray) -> int:
    """Where the numbers of a contiguous array stand. Raises ValueError for one that is not contiguous."""
    if not array.flags.c_contiguous:
        raise ValueError("an array handed over by its address must be contiguous")
    address: int = array.ctypes.data
    return address
