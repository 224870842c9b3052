"""A controller from a C shared library, in the process that was started for it; see railslide_controller.h."""

import ctypes
import math
from collections.abc import Mapping
from typing import Any

from wsp.foreign.errors import UnusableController
from wsp.foreign.frames import Input, Output

ABI_VERSION = 1
MESSAGE_SIZE = 512


class Parameter(ctypes.Structure):
    """railslide_parameter of the C header."""

    _fields_ = (("name", ctypes.c_char_p), ("text", ctypes.c_char_p), ("number", ctypes.c_double))


_SIGNATURES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "railslide_abi_version": (ctypes.c_int32, ()),
    "railslide_create": (
        ctypes.c_void_p,
        (ctypes.c_double, ctypes.POINTER(Parameter), ctypes.c_int32, ctypes.c_void_p),
    ),
    "railslide_reset": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double, ctypes.c_int32, ctypes.c_void_p)),
    "railslide_step": (
        ctypes.c_int32,
        (ctypes.c_void_p, ctypes.POINTER(Input), ctypes.POINTER(Output), ctypes.c_void_p),
    ),
    "railslide_destroy": (None, (ctypes.c_void_p,)),
}


class LibraryController:
    """The five functions of a library and the controller that it made."""

    def __init__(self, file: str, period_s: float, parameters: Mapping[str, float | str]) -> None:
        """Raises UnusableController if it is no library, lacks a function, is of another version or refuses."""
        functions = _load(file)
        version = functions["railslide_abi_version"]()
        if version != ABI_VERSION:
            raise UnusableController(
                f"is built for version {version} of railslide_controller.h, this is version {ABI_VERSION}: "
                "compile it with the present header"
            )
        self._message = ctypes.create_string_buffer(MESSAGE_SIZE)
        self._message_at = ctypes.addressof(self._message)
        self._reset = functions["railslide_reset"]
        self._step = functions["railslide_step"]
        self._destroy = functions["railslide_destroy"]
        table = (Parameter * len(parameters))(*(_parameter(*item) for item in parameters.items()))
        self._controller = functions["railslide_create"](period_s, table, len(table), self._message_at)
        if not self._controller:
            raise UnusableController(f"railslide_create refused{self._told()}")

    def reset(self, t_s: float, direction: int) -> None:
        if self._reset(self._controller, t_s, direction, self._message_at):
            raise RuntimeError(f"railslide_reset failed{self._told()}")

    def step(self, given: Input, answer: Output) -> None:
        if self._step(self._controller, given, answer, self._message_at):
            raise RuntimeError(f"railslide_step failed{self._told()}")

    def end(self) -> None:
        self._destroy(self._controller)

    def _told(self) -> str:
        """The library's own words, which it may not have ended with a zero."""
        words = self._message.raw.partition(b"\0")[0].decode("utf-8", "replace")
        return f": {words}" if words else " without saying why"


def _load(file: str) -> dict[str, Any]:
    try:
        library = ctypes.CDLL(file)
    except OSError as error:
        raise UnusableController(f"cannot be loaded as a shared library: {error}") from None
    functions = {}
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(library, name, None)
        if function is not None:
            function.restype, function.argtypes = result, arguments
            functions[name] = function
    missing = [name for name in _SIGNATURES if name not in functions]
    if missing:
        raise UnusableController(f"does not export {', '.join(missing)}, see railslide_controller.h")
    return functions


def _parameter(name: str, value: float | str) -> Parameter:
    if isinstance(value, str):
        return Parameter(name.encode(), value.encode(), math.nan)
    return Parameter(name.encode(), None, float(value))
