"""What goes through the pipes: one frame of fixed size there, one back, with the structs of the C header inside.

Native byte order and alignment: both ends run on one machine. Frames are shorter than what a pipe passes whole.
"""

import ctypes
import struct

from wsp.foreign.signals import AXLES

RESET, STEP, END = 1, 2, 3
"""What a request asks for; a reset uses t_s and direction of the input alone."""

REQUEST = struct.Struct("@q7d5i4x")
"""What is asked, then railslide_input."""

REPLY = struct.Struct("@qd9i4x")
"""Length of the error text that follows, 0 if all went well; then railslide_output."""

BODY_AT = 8
"""Where the structs begin in either frame."""


class Input(ctypes.Structure):
    """railslide_input of the C header."""

    _fields_ = (
        ("t_s", ctypes.c_double),
        ("axle_speed_mps", ctypes.c_double * AXLES),
        ("demand", ctypes.c_double),
        ("outside_reference_mps", ctypes.c_double),
        ("valid", ctypes.c_int32 * AXLES),
        ("direction", ctypes.c_int32),
    )


class Output(ctypes.Structure):
    """railslide_output of the C header."""

    _fields_ = (
        ("reference_speed_mps", ctypes.c_double),
        ("valve", ctypes.c_int32 * AXLES),
        ("sand", ctypes.c_int32 * AXLES),
        ("track_brake", ctypes.c_int32),
    )
