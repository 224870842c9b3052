"""The brake plant of four axles: demand -> distributor -> hold and vent valves -> cylinders -> friction torque.

Beside it the dynamic brake, blended in per bogie, and the magnetic track brake. Order of a step from t to t + step_s:
distributor and reservoir pressure, valves by the commands of t - dead time, blending, cylinders, friction (at the
wheels' speeds of t and the temperature before the step), reservoir.
"""

import numpy as np
from numpy.typing import NDArray

from wsp.brake_record import AXLES, BRAKE, brake_record, conductance_step_dm3pbar
from wsp.compiled import CodeArray, FloatArray, Record, compiled
from wsp.cylinder import exchange_air
from wsp.dynamic_brake import blend, press_magnets
from wsp.friction import friction_coefficient, heat_disc
from wsp.parameters import BrakeParameters
from wsp.pneumatics import ATMOSPHERE_BAR, pressure_filled_bar
from wsp.valves import (
    FILL,
    FREE,
    HOLD,
    STUCK_OPEN,
    STUCK_SHUT,
    VENT,
    exhaust_open,
    mean_passage,
    passage_after,
    stuck_at,
    supply_open,
)

__all__ = ["AXLES", "BRAKE", "Brake", "advance_brake"]

_POSITIONS = {None: FREE, "open": STUCK_OPEN, "shut": STUCK_SHUT}
_STUCK_FIELDS = {"hold": "supply_stuck", "vent": "exhaust_stuck"}


@compiled
def _follow_demand(demand: float, b: Record) -> None:
    target = demand * b.full_bar
    if target >= b.control_bar:
        b.control_bar = min(target, b.control_bar + b.rise_bar)
    else:
        b.control_bar = max(target, b.control_bar - b.fall_bar)
    # at the end of the step: a cylinder in balance with the distributor is then in step with it
    b.distributor_bar = min(b.control_bar, b.reservoir_bar)


@compiled
def _energise(command: CodeArray, b: Record) -> None:
    """Valve codes in force in this step: the commands of one dead time ago, if the safety timer lets them."""
    slots = b.slots
    written = b.tick % slots
    read = (b.tick + 1) % slots  # the oldest; the one of this very step when there is no dead time
    for axle in range(AXLES):
        b.commands[written, axle] = command[axle]
    for axle in range(AXLES):
        code = b.commands[read, axle]
        if code == FILL:
            b.energised_steps[axle] = 0
            b.timer_fired[axle] = 0
        elif b.energised_steps[axle] >= b.timer_steps:
            b.timer_fired[axle] = 1
            code = FILL
        else:
            b.energised_steps[axle] += 1
        b.valve[axle] = code
    b.tick += 1


@compiled
def _supply(axle: int, passage_dm3pbar: float, b: Record) -> float:
    """Air from the distributor's relay, or back to it, which lets it out; returns what was drawn, bar dm3.

    Cylinders above a reservoir that cannot supply the relay's pressure keep their air: a check valve.
    """
    relay = b.relay_bar[axle // 2]
    source = min(relay, b.reservoir_bar)
    if b.cylinder_bar[axle] < source:
        return exchange_air(axle, source, passage_dm3pbar, b)
    if b.cylinder_bar[axle] > relay:
        b.vented_nl -= exchange_air(axle, relay, passage_dm3pbar, b) * b.nl_per_bar_dm3
    return 0.0


@compiled
def _let_out(axle: int, vent_dm3pbar: float, b: Record) -> None:
    leak = b.leak_dm3pbar[axle]
    passage = vent_dm3pbar + leak
    if passage <= 0.0 or b.cylinder_bar[axle] <= 0.0:
        return
    lost = -exchange_air(axle, 0.0, passage, b) * b.nl_per_bar_dm3
    share = leak / passage
    b.leaked_nl += share * lost
    b.vented_nl += lost - share * lost


@compiled
def _advance_cylinder(axle: int, b: Record) -> float:
    """Valves and pressure of an axle over one step; returns the air drawn, bar dm3."""
    code = b.valve[axle]
    share = b.opening_share
    supply, exhaust = b.supply[axle], b.exhaust[axle]
    supply_target = stuck_at(supply_open(code), b.supply_stuck[axle])
    exhaust_target = stuck_at(exhaust_open(code), b.exhaust_stuck[axle])
    if b.cut_out[axle]:
        supply_target, exhaust_target = 0.0, 1.0
    fill = b.fill_dm3pbar
    vent = 0.0
    if supply != supply_target:
        fill *= mean_passage(supply, supply_target, share)
        b.supply[axle] = passage_after(supply, supply_target, share)
    else:
        fill *= supply
    if exhaust != exhaust_target:
        vent = b.vent_dm3pbar * mean_passage(exhaust, exhaust_target, share)
        b.exhaust[axle] = passage_after(exhaust, exhaust_target, share)
    elif exhaust > 0.0:
        vent = b.vent_dm3pbar
    drawn = 0.0
    if vent > 0.0 and fill > 0.0:
        # both passages are open, as while the pair changes over: split symmetrically
        fill *= 0.5
        drawn = _supply(axle, fill, b)
    if vent + b.leak_dm3pbar[axle] > 0.0:
        _let_out(axle, vent, b)
    if fill > 0.0:
        drawn += _supply(axle, fill, b)
    return drawn


@compiled
def _resupply(drawn: float, b: Record) -> None:
    """Take the air drawn (bar dm3) from the reservoir and let the feed pipe charge it."""
    pressure = b.reservoir_bar
    if drawn > 0.0:
        b.drawn_nl += drawn * b.nl_per_bar_dm3
        pressure -= drawn / b.reservoir_dm3
    if b.feed_open and pressure < b.feed_bar:
        source = b.feed_bar + ATMOSPHERE_BAR
        exchange = b.feed_dm3pbar / b.reservoir_dm3
        after = pressure_filled_bar(pressure + ATMOSPHERE_BAR, source, exchange, b.critical_ratio)
        # not below the pressure before by rounding
        charged = b.feed_bar if after >= source else max(pressure, after - ATMOSPHERE_BAR)
        b.supplied_nl += (charged - pressure) * b.reservoir_dm3 * b.nl_per_bar_dm3
        pressure = charged
    b.reservoir_bar = pressure


@compiled
def advance_brake(
    record: Record, demand: float, command: CodeArray, wheel_rate_radps: FloatArray, speed_mps: float
) -> bool:
    """One step of the plant, on a record of BRAKE; False (and nothing changed) for input that makes no sense.

    demand 0..1; command (4,) int8 valve codes; wheel_rate_radps (4,) and speed_mps as they are when the step begins.
    """
    if not (0.0 <= demand <= 1.0) or command.shape[0] != AXLES or wheel_rate_radps.shape[0] != AXLES:
        return False
    if not np.isfinite(speed_mps):
        return False
    for axle in range(AXLES):
        if command[axle] < FILL or command[axle] > VENT or not np.isfinite(wheel_rate_radps[axle]):
            return False

    _follow_demand(demand, record)
    _energise(command, record)
    if record.blends:
        blend(wheel_rate_radps, record)
    else:
        record.relay_bar[0] = record.control_bar
        record.relay_bar[1] = record.control_bar
    if record.attraction_n > 0.0:
        press_magnets(speed_mps, record)

    drawn = 0.0
    for axle in range(AXLES):
        drawn += _advance_cylinder(axle, record)
        torque = 0.0
        if record.pad_bar[axle] > 0.0:
            force = record.force_per_bar_n * record.pad_bar[axle]
            torque = force * record.radius_m * friction_coefficient(axle, wheel_rate_radps[axle], record)
        record.torque_nm[axle] = torque
        if record.heats:
            heat_disc(axle, torque * abs(wheel_rate_radps[axle]), speed_mps, record)
    _resupply(drawn, record)
    return True


@compiled
def _advance_first(records: np.ndarray, demand: float, command: CodeArray, rate: FloatArray, speed: float) -> bool:
    return advance_brake(records[0], demand, command, rate, speed)


class Brake:
    """The brake plant, advanced by one base step at a time from empty cylinders and a full reservoir.

    The command of the step that begins at t acts from t + dead time on, to the sample. Isothermal air; flow by ISO 6358
    (wsp.pneumatics), stroke and linkage by wsp.cylinder, friction and heat by wsp.friction. Faults are set by methods,
    axles counted 0..3, and last until they are taken back.
    """

    def __init__(self, parameters: BrakeParameters, step_s: float) -> None:
        """Raises ValueError for a step that is not positive and finite, or too short for the valves' dead time."""
        self.parameters = parameters
        self.step_s = step_s
        self.record: np.ndarray = brake_record(parameters, step_s)
        """(1,) of BRAKE: all that the plant is; compiled code hands `record[0]` to advance_brake."""
        self._b = self.record[0]
        self._torque_nm: NDArray[np.float64] = self.record["torque_nm"][0]
        self.cylinder_pressure_bar: NDArray[np.float64] = self.record["cylinder_bar"][0]
        """(4,) gauge; a view that follows the plant."""
        self.valve_state: NDArray[np.int8] = self.record["valve"][0]
        """(4,) FILL, HOLD or VENT as the valves were energised in the step done last, dead time included; a view."""

    @property
    def distributor_pressure_bar(self) -> float:
        """Output pressure of the distributor, gauge."""
        return float(self._b["distributor_bar"])

    @property
    def reservoir_pressure_bar(self) -> float:
        """Pressure in the auxiliary reservoir, gauge."""
        return float(self._b["reservoir_bar"])

    @property
    def air_nl(self) -> float:
        """Air drawn from the reservoir so far, in normal litres (1.013 bar, 20 degC)."""
        return float(self._b["drawn_nl"])

    @property
    def vented_nl(self) -> float:
        """Air let out so far, by the vent valves and by releasing: air_nl less what leaked and what cylinders hold."""
        return float(self._b["vented_nl"])

    @property
    def track_brake_on(self) -> bool:
        """Whether the magnetic track brake is switched on; without effect where there is none."""
        return bool(self._b["track_brake_on"])

    @track_brake_on.setter
    def track_brake_on(self, on: bool) -> None:
        self._b["track_brake_on"] = on

    def step(
        self,
        demand: float,
        valve: NDArray[np.int8],
        wheel_rate_radps: NDArray[np.float64],
        speed_mps: float,
    ) -> NDArray[np.float64]:
        """Advance by one base step; return the friction torque capacity of each axle at its end, (4,) Nm >= 0, a view.

        demand 0..1 of full service; valve (4,) int8 commands; wheel_rate_radps (4,) and the train's speed_mps as they
        are when the step begins, of either sign. Raises ValueError for anything else.
        """
        if not _advance_first(self.record, demand, valve, wheel_rate_radps, speed_mps):
            raise ValueError(
                f"demand = {demand}, valve = {valve}, wheel_rate_radps = {wheel_rate_radps}, speed_mps = {speed_mps}: "
                f"a demand of 0..1 and {AXLES} valve codes are needed, {FILL} (fill), {HOLD} (hold) or {VENT} (vent), "
                f"with {AXLES} finite speeds of rotation and a finite speed"
            )
        return self._torque_nm

    def stick_valve(self, axle: int, valve: str, position: str | None) -> None:
        """The passage of the axle's "hold" or "vent" valve stays "open" or "shut" from now on; None frees it.

        Open is the passage: a hold valve stuck open always fills, a vent valve stuck open always vents.
        """
        if valve not in _STUCK_FIELDS or position not in _POSITIONS:
            raise ValueError(f"valve = {valve!r}, position = {position!r}: 'hold' or 'vent', 'open', 'shut' or None")
        self._b[_STUCK_FIELDS[valve]][_checked(axle)] = _POSITIONS[position]

    def leak(self, axle: int, conductance_dm3psbar: float) -> None:
        """The axle's cylinders lose air through a hole of this conductance beside their usual leakage; 0: mended."""
        if not 0.0 <= conductance_dm3psbar <= 1000.0:
            raise ValueError(f"conductance_dm3psbar = {conductance_dm3psbar}: 0 to 1000 is needed")
        total = self.parameters.leakage_dm3psbar + conductance_dm3psbar
        self._b["leak_dm3pbar"][_checked(axle)] = conductance_step_dm3pbar(total, self.parameters, self.step_s)

    def cut_out(self, axle: int, out: bool) -> None:
        """Shut the axle's pneumatic brake off by its cock, which vents its cylinders, or put it in again."""
        self._b["cut_out"][_checked(axle)] = out

    def fail_supply(self, pressure_bar: float | None) -> None:
        """The feed pipe is lost and the reservoir has fallen to pressure_bar (gauge) at most; None: it is back."""
        b = self._b
        if pressure_bar is None:
            b["feed_open"] = True
            return
        if not 0.0 <= pressure_bar <= 12.0:
            raise ValueError(f"pressure_bar = {pressure_bar}: 0 to 12 bar gauge is needed, or None")
        b["feed_open"] = False
        lost = max(0.0, b["reservoir_bar"] - pressure_bar)
        b["let_off_nl"] += lost * b["reservoir_dm3"] * b["nl_per_bar_dm3"]
        b["reservoir_bar"] -= lost


def _checked(axle: int) -> int:
    if axle not in range(AXLES):
        raise ValueError(f"axle = {axle}: 0 to {AXLES - 1} is needed, counted from the front")
    return axle
