"""The signals between the co-simulation and a foreign controller, as they are called in C and in an FMU."""

from typing import Literal, NamedTuple

AXLES = 4
NONE = -1.0
"""Stands for a speed that there is not, either way: no outside reference speed, no reference speed."""


class Signal(NamedTuple):
    """`size` values called `name`, or `name[1]` to `name[4]`; `needed` of every FMU or not."""

    name: str
    size: int
    kind: Literal["real", "flag", "sign", "code"]
    needed: bool


INPUTS = (
    Signal("axle_speed_mps", AXLES, "real", True),
    Signal("valid", AXLES, "flag", False),
    Signal("demand", 1, "real", False),
    Signal("direction", 1, "sign", False),
    Signal("outside_reference_mps", 1, "real", False),
)
OUTPUTS = (
    Signal("valve", AXLES, "code", True),
    Signal("sand", AXLES, "flag", False),
    Signal("track_brake", 1, "flag", False),
    Signal("reference_speed_mps", 1, "real", False),
)
