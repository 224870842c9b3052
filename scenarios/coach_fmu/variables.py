"""The variables of the coach's FMU: one table, from which model description, C code and server take their order.

A value reference is the place in this table. Between library and server all values travel as doubles in this order,
those that the tool sets (inputs and parameters) before those that it gets.
"""

import hashlib
from dataclasses import dataclass, replace
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


def _each(names: tuple[str, ...], one: Variable) -> list[Variable]:
    """One variable per axle or axis: `{}` in name and description stands for it."""
    return [replace(one, name=one.name.format(n), description=one.description.format(n)) for n in names]


def _output(name: str, unit: str, description: str, kind: Kind = "real") -> Variable:
    return Variable(name, kind, "output", description, unit)


def _truth(name: str, unit: str, description: str) -> Variable:
    return _output(f"true_{name}", unit, f"truth, for judging: {description}")


VARIABLES: tuple[Variable, ...] = (
    Variable(
        "external_driver", "boolean", "parameter",
        "true: the inputs demand and traction_n drive the coach; false: the scenario's driver, and both are ignored",
        start=0,
    ),
    *_each(AXLES, Variable(
        "valve_command[{}]", "integer", "input", "magnet valves of axle {}: 0 fill, 1 hold, 2 vent",
        start=0, range=(0, 2),
    )),
    *_each(AXLES, Variable(
        "sand[{}]", "boolean", "input", "sand at wheelset {}, where the scenario has a sander", start=0,
    )),
    Variable("track_brake", "boolean", "input", "magnetic track brake, where the coach has one", start=0),
    Variable("demand", "real", "input", "brake demand, share of full service", "1", 0.0, (0.0, 1.0)),
    Variable("traction_n", "real", "input", "tractive force of the whole coach, shared by its wheelsets", "N", 0.0),
    Variable("time", "real", "independent", "simulated time", "s"),
    *_each(AXLES, _output("pulse_count[{}]", "", "pulses of axle {} since the start, less backward ones", "integer")),
    *_each(AXLES, _output("last_pulse_s[{}]", "s", "time of the last pulse of axle {}, before the start if none came")),
    *_each(AXLES, _output("axle_speed_mps[{}]", "m/s", "speed of axle {}, as its front end makes it of the pulses")),
    *_each(AXLES, _output("axle_speed_valid[{}]", "", "whether the speed of axle {} is valid", "boolean")),
    _output("demand_in_force", "1", "brake demand that acts, share of full service"),
    _output("distributor_pressure_bar", "bar", "output pressure of the distributor, gauge"),
    _output("reservoir_pressure_bar", "bar", "auxiliary reservoir, gauge"),
    *_each(AXLES, _output("cylinder_pressure_bar[{}]", "bar", "brake cylinder pressure of axle {}, gauge")),
    *_each(AXLES, _output("valve_state[{}]", "", "valves of axle {} as energised: 0 fill, 1 hold, 2 vent", "integer")),
    _output("air_nl", "", "air drawn from the supply so far, normal litres"),
    _output("imu_sampled_s", "s", "time of the IMU's last reading"),
    *_each(AXES, _output("imu_specific_force_{}_mps2", "m/s2", "IMU: specific force, {} axis of the sensor")),
    *_each(AXES, _output("imu_angular_rate_{}_radps", "rad/s", "IMU: angular rate, {} axis of the sensor")),
    _output("imu_temperature_degc", "degC", "IMU: its temperature"),
    _truth("position_m", "m", "place of the carbody's centre on the track"),
    _truth("speed_mps", "m/s", "speed along the track"),
    _truth("acceleration_mps2", "m/s2", "acceleration along the track"),
    *_each(AXLES, _truth("rim_speed_mps[{}]", "m/s", "speed of the rims of wheelset {}")),
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
