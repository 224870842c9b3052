"""The decorator of the plant's compiled functions, the types in their signatures, and a call by address.

Compiled code is cached on disk. Division follows IEEE (inf, nan) instead of raising; floating point is never reordered,
nor a product taken into a sum. That is said although it is numba's default: a function that leaves it open takes it
from whoever calls it first, and results would hang on the order of compiling.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
CodeArray = NDArray[np.int8]
Record = Any  # a record of a structured array, whose fields are attributes in compiled code

OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": False}
compiled = njit(**OPTIONS)


@intrinsic
def _call(_typing: Any, address: Any, argument: Any, t_s: Any) -> Any:
    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        integer, double = ir.IntType(64), ir.DoubleType()
        kind = ir.FunctionType(integer, [integer, double])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), list(arguments[1:]))

    return types.int64(types.int64, types.int64, types.float64), code


@compiled
def call_at(address: int, argument: int, t_s: float) -> int:
    """Call the C function int64(int64, double) that stands at an address."""
    said: int = _call(address, argument, t_s)  # type: ignore[call-arg]
    return said
