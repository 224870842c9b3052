"""The variables of the coach's FMU: one table, from which model description, C code and server take their order.

A value reference is the place in this table. Between library and server all values travel as doubles in this order,
those that the tool sets (inputs and parameters) before those that it gets.
"""

import hashlib
from dataclasses import dataclass
from typing import Literal

Kind = Literal["real", "integer", "boolean"]
Causality = Literal["parameter", "input", "independent", "output"]


@dataclass(frozen=True)
class Variable:
    """One scalar; `start` for what the tool sets, `range` (least, largest) where it is bounded."""

    name: str
    kind: Kind
    causality: Causality
    description: str
    unit: str = ""
    start: float | None = None
    range: tuple[float, float] | None = None

    @property
    def is_set(self) -> bool:
        """Whether the tool sets it."""
        return self.causality in ("parameter", "input")


AXLES = ("1", "2", "3", "4")
AXES = ("x", "y", "z")


def _each(
    names: tuple[str, ...],
    name: str,
    kind: Kind,
    causality: Causality,
    description: str,
    unit: str = "",
    start: float | None = None,
    range: tuple[float, float] | None = None,
) -> list[Variable]:
    """One variable per axle or axis: `{}` in the name stands for it."""
    return [
        Variable(name.format(one), kind, causality, description.format(one), unit, start, range) for one in names
    ]


VARIABLES: tuple[Variable, ...] = (
    Variable(
        "external_driver", "boolean", "parameter",
        "true: the inputs demand and traction_n drive the coach; false: the scenario's driver, and both are ignored",
        start=0,
    ),
    *_each(
        AXLES, "valve_command[{}]", "integer", "input", "magnet valves of axle {}: 0 fill, 1 hold, 2 vent",
        start=0, range=(0, 2),
    ),
    *_each(AXLES, "sand[{}]", "boolean", "input", "sand at wheelset {}, where the scenario has a sander", start=0),
    Variable("track_brake", "boolean", "input", "magnetic track brake, where the scenario has one", start=0),
    Variable("demand", "real", "input", "brake demand, share of full service", "1", 0.0, (0.0, 1.0)),
    Variable("traction_n", "real", "input", "tractive force of the whole coach, shared by its wheelsets", "N", 0.0),
    Variable("time", "real", "independent", "simulated time", "s"),
    *_each(AXLES, "pulse_count[{}]", "integer", "output", "tachometer pulses of axle {} since the start, backward ones subtracted"),
    *_each(AXLES, "last_pulse_s[{}]", "real", "output", "time of the last pulse of axle {}, before the start if none came", "s"),
    *_each(AXLES, "axle_speed_mps[{}]", "real", "output", "speed of axle {} as its front end makes it of the pulses", "m/s"),
    *_each(AXLES, "axle_speed_valid[{}]", "boolean", "output", "whether the speed of axle {} is valid"),
    Variable("demand_in_force", "real", "output", "brake demand that acts, share of full service", "1"),
    Variable("distributor_pressure_bar", "real", "output", "output pressure of the distributor, gauge", "bar"),
    *_each(AXLES, "cylinder_pressure_bar[{}]", "real", "output", "brake cylinder pressure of axle {}, gauge", "bar"),
    *_each(AXLES, "valve_state[{}]", "integer", "output", "magnet valves of axle {} as energised: 0 fill, 1 hold, 2 vent"),
    Variable("air_nl", "real", "output", "air drawn from the supply so far, normal litres"),
    Variable("imu_sampled_s", "real", "output", "time of the IMU's last reading", "s"),
    *_each(AXES, "imu_specific_force_{}_mps2", "real", "output", "IMU: specific force, {} axis of the sensor", "m/s2"),
    *_each(AXES, "imu_angular_rate_{}_radps", "real", "output", "IMU: angular rate, {} axis of the sensor", "rad/s"),
    Variable("imu_temperature_degc", "real", "output", "IMU: its temperature", "degC"),
    Variable("true_position_m", "real", "output", "truth, for judging: place of the carbody's centre on the track", "m"),
    Variable("true_speed_mps", "real", "output", "truth, for judging: speed along the track", "m/s"),
    Variable("true_acceleration_mps2", "real", "output", "truth, for judging: acceleration along the track", "m/s2"),
    *_each(AXLES, "true_rim_speed_mps[{}]", "real", "output", "truth, for judging: speed of the rims of wheelset {}", "m/s"),
)  # fmt: skip

SET: tuple[Variable, ...] = tuple(variable for variable in VARIABLES if variable.is_set)
GOT: tuple[Variable, ...] = VARIABLES[len(SET) :]


def slice_of(table: tuple[Variable, ...], name: str) -> slice:
    """Places of `name`, or of all `name[i]`, in SET, GOT or VARIABLES."""
    places = [k for k, variable in enumerate(table) if variable.name == name or variable.name.startswith(f"{name}[")]
    return slice(places[0], places[-1] + 1)


def interface_digest() -> str:
    """Hexadecimal digest of the table: library, model description and server must have the same."""
    return hashlib.sha256(repr(VARIABLES).encode()).hexdigest()[:32]
