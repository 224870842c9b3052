"""The brake plant of four axles: demand -> distributor -> hold and vent valves -> cylinders -> disc friction torque."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from wsp.parameters import BrakeParameters
from wsp.pneumatics import ATMOSPHERE_BAR, REFERENCE_TEMPERATURE_K, pressure_emptied_bar, pressure_filled_bar
from wsp.valves import FILL, HOLD, VENT, exhaust_open, mean_passage, passage_after, supply_open

AXLES = 4

# Every array handed to a compiled function costs about 0.1 us, so state and constants share one array of floats, the
# valves and their delay line one of int8.
_DISTRIBUTOR, _DRAWN, _VENTED = 0, 1, 2
_CYLINDER, _TORQUE, _SUPPLY, _EXHAUST = 3, 7, 11, 15
_FULL, _RISE, _FALL, _OPENING, _FILL_EXCHANGE, _VENT_EXCHANGE, _CRITICAL, _NORMAL, _TORQUE_PER_BAR, _SPRING = range(
    19, 29
)
_FLOATS = 29


@njit(cache=True)
def _exchange_with_distributor(floats: NDArray[np.float64], axle: int, source_bar: float, exchange: float) -> None:
    before = floats[_CYLINDER + axle] + ATMOSPHERE_BAR
    if source_bar >= before:
        after = pressure_filled_bar(before, source_bar, exchange, floats[_CRITICAL])
        floats[_DRAWN] += (after - before) * floats[_NORMAL]
    else:  # releasing: the cylinder empties through the distributor, which lets the air out
        after = pressure_emptied_bar(before, source_bar, exchange, floats[_CRITICAL])
        floats[_VENTED] += (before - after) * floats[_NORMAL]
    floats[_CYLINDER + axle] = max(0.0, after - ATMOSPHERE_BAR)


@njit(cache=True)
def _advance(
    floats: NDArray[np.float64], valves: NDArray[np.int8], command: NDArray[np.int8], demand: float, tick: int
) -> bool:
    """One base step; False (and nothing changed) if demand or a valve code is out of range."""
    if not (0.0 <= demand <= 1.0) or command.shape[0] != AXLES:
        return False
    for axle in range(AXLES):
        if command[axle] < FILL or command[axle] > VENT:
            return False

    target = demand * floats[_FULL]
    if target >= floats[_DISTRIBUTOR]:
        floats[_DISTRIBUTOR] = min(target, floats[_DISTRIBUTOR] + floats[_RISE])
    else:
        floats[_DISTRIBUTOR] = max(target, floats[_DISTRIBUTOR] - floats[_FALL])
    # The pressure at the end of the step: a cylinder in balance with the distributor is then in step with it.
    source_bar = floats[_DISTRIBUTOR] + ATMOSPHERE_BAR

    slots = valves.shape[0] // AXLES - 1
    written = AXLES * (1 + tick % slots)
    read = AXLES * (1 + (tick + 1) % slots)  # the oldest command; the one of this very step when there is no dead time
    share = floats[_OPENING]
    for axle in range(AXLES):
        valves[written + axle] = command[axle]
        code = valves[read + axle]
        valves[axle] = code
        supply, supply_target = floats[_SUPPLY + axle], supply_open(code)
        exhaust, exhaust_target = floats[_EXHAUST + axle], exhaust_open(code)
        fill_exchange = floats[_FILL_EXCHANGE] * mean_passage(supply, supply_target, share)
        vent_exchange = floats[_VENT_EXCHANGE] * mean_passage(exhaust, exhaust_target, share)
        floats[_SUPPLY + axle] = passage_after(supply, supply_target, share)
        floats[_EXHAUST + axle] = passage_after(exhaust, exhaust_target, share)

        if vent_exchange > 0.0:
            # Both passages are open for some milliseconds while the pair changes over: split symmetrically.
            if fill_exchange > 0.0:
                _exchange_with_distributor(floats, axle, source_bar, 0.5 * fill_exchange)
            before = floats[_CYLINDER + axle] + ATMOSPHERE_BAR
            after = pressure_emptied_bar(before, ATMOSPHERE_BAR, vent_exchange, floats[_CRITICAL])
            floats[_VENTED] += (before - after) * floats[_NORMAL]
            floats[_CYLINDER + axle] = max(0.0, after - ATMOSPHERE_BAR)
            if fill_exchange > 0.0:
                _exchange_with_distributor(floats, axle, source_bar, 0.5 * fill_exchange)
        elif fill_exchange > 0.0:
            _exchange_with_distributor(floats, axle, source_bar, fill_exchange)
        floats[_TORQUE + axle] = floats[_TORQUE_PER_BAR] * max(0.0, floats[_CYLINDER + axle] - floats[_SPRING])
    return True


class Brake:
    """Pneumatic disc brake of four axles, advanced by one base step at a time from empty cylinders.

    The command of the step that begins at t acts from t + dead time on, to the sample. The air comes at the
    distributor's output pressure, from a reservoir that does not run low. Isothermal, fixed cylinder volume; flow by
    ISO 6358 (wsp.pneumatics).
    """

    DISTRIBUTOR, DRAWN, VENTED = _DISTRIBUTOR, _DRAWN, _VENTED
    CYLINDER, TORQUE = slice(_CYLINDER, _CYLINDER + AXLES), slice(_TORQUE, _TORQUE + AXLES)
    """Where these stand in plant_state."""

    def __init__(self, parameters: BrakeParameters, step_s: float) -> None:
        """Raises ValueError for a step that is not positive and finite."""
        if not (math.isfinite(step_s) and step_s > 0.0):
            raise ValueError(f"step_s = {step_s}: a positive number of seconds is needed")
        self.parameters = parameters
        self.step_s = step_s
        warmth = (parameters.air_temperature_degc + 273.15) / REFERENCE_TEMPERATURE_K
        exchange_per_conductance = step_s * math.sqrt(warmth) / parameters.cylinder_volume_dm3
        newton_per_bar = 1e5 * parameters.cylinder_area_m2 * parameters.lever_ratio
        floats = np.zeros(_FLOATS)
        floats[_SUPPLY : _SUPPLY + AXLES] = 1.0
        floats[_FULL] = parameters.full_service_pressure_bar
        floats[_RISE] = parameters.full_service_pressure_bar / parameters.application_time_s * step_s
        floats[_FALL] = parameters.full_service_pressure_bar / parameters.release_time_s * step_s
        floats[_OPENING] = step_s / parameters.valve_opening_time_s
        floats[_FILL_EXCHANGE] = parameters.fill_conductance_dm3psbar * exchange_per_conductance
        floats[_VENT_EXCHANGE] = parameters.vent_conductance_dm3psbar * exchange_per_conductance
        floats[_CRITICAL] = parameters.critical_ratio
        floats[_NORMAL] = parameters.cylinder_volume_dm3 / (ATMOSPHERE_BAR * warmth)
        floats[_TORQUE_PER_BAR] = (
            parameters.discs_per_axle * parameters.pad_friction * newton_per_bar * parameters.disc_effective_radius_m
        )
        floats[_SPRING] = parameters.return_spring_pressure_bar
        self._floats = floats
        self._valves = np.full(AXLES * (2 + round(parameters.valve_dead_time_s / step_s)), FILL, dtype=np.int8)
        self._tick = 0
        self._torque_nm = floats[_TORQUE : _TORQUE + AXLES]
        self.plant_state: NDArray[np.float64] = floats[: _TORQUE + AXLES]
        """(11,) distributor pressure, air drawn and vented, cylinder pressures, torques; a view."""
        self.cylinder_pressure_bar: NDArray[np.float64] = floats[_CYLINDER : _CYLINDER + AXLES]
        """(4,) gauge; a view that follows the plant."""
        self.valve_state: NDArray[np.int8] = self._valves[:AXLES]
        """(4,) FILL, HOLD or VENT as the valves were energised in the step done last, dead time included; a view."""

    @property
    def distributor_pressure_bar(self) -> float:
        """Output pressure of the distributor, gauge."""
        return float(self._floats[_DISTRIBUTOR])

    @property
    def air_nl(self) -> float:
        """Air drawn from the supply so far, in normal litres (1.013 bar, 20 degC)."""
        return float(self._floats[_DRAWN])

    @property
    def vented_nl(self) -> float:
        """Air let out so far, by the vent valves and by releasing: air_nl less what is in the cylinders."""
        return float(self._floats[_VENTED])

    def step(self, demand: float, valve: NDArray[np.int8]) -> NDArray[np.float64]:
        """Advance by one base step; return the friction torque capacity of each axle at its end, (4,) Nm >= 0, a view.

        demand 0..1 of full service; valve (4,) int8 commands. Raises ValueError for anything else.
        """
        if not _advance(self._floats, self._valves, valve, demand, self._tick):
            raise ValueError(
                f"demand = {demand}, valve = {valve}: a demand of 0..1 and {AXLES} valve codes are needed, "
                f"{FILL} (fill), {HOLD} (hold) or {VENT} (vent)"
            )
        self._tick += 1
        return self._torque_nm
