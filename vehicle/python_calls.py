"""Python objects called by compiled code, and compiled code called with Python objects.

The interpreter takes as long as a good part of a solver's step to run a few lines between two calls of C functions.
Whoever hands over an address keeps the object alive.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import NativeValue, models, register_model, unbox

from wheel_rail.lanes import intrinsic


class HandedType(types.Opaque):
    """Numba's type of a Python object that compiled code is handed and does not look at."""

    def __init__(self) -> None:
        super().__init__("handed")


HANDED = HandedType()
register_model(HandedType)(models.OpaqueModel)


@unbox(HandedType)
def _as_it_is(_kind: Any, value: Any, _context: Any) -> Any:
    return NativeValue(value)


@intrinsic
def call_python(_typing: Any, function: Any, arguments: Any) -> Any:
    """Call the Python object at an address with the tuple at another one: whether it answers something true.

    Needs the interpreter's lock. What the object raises leaves the compiled function that calls it, too.
    """

    def code(context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        python = context.get_python_api(builder)
        function, arguments = (builder.inttoptr(address, python.pyobj) for address in args)
        answer = python.call(function, arguments)
        with builder.if_then(cgutils.is_null(builder, answer), likely=False):
            context.call_conv.return_exc(builder)
        true = python.object_istrue(answer)
        python.decref(answer)
        return builder.icmp_signed(">", true, ir.IntType(32)(0))

    return types.boolean(types.int64, types.int64), code
