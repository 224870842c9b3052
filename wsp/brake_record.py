"""From parameters to the record of numbers that the compiled brake plant works on: constants, state and faults.

One record, because each array handed to a compiled function costs: state and constants stand together.
"""

import math

import numpy as np

from wsp.parameters import LONGEST_CURVE, BrakeParameters
from wsp.pneumatics import ATMOSPHERE_BAR, REFERENCE_TEMPERATURE_K
from wsp.valves import FILL, FREE

AXLES, BOGIES = 4, 2
COMMAND_SLOTS = 512
"""Longest dead time in steps, and one."""

_KELVIN = 273.15
_STANDARD_K = 293.15
_KMH_PER_MPS = 3.6
CURVES = SPEED_FACTOR, TEMPERATURE_FACTOR, TRACK_FRICTION = range(3)
KARWATZKI = 1

BRAKE = np.dtype(
    [
        # what others read; all pressures gauge
        ("control_bar", "f8"),  # what the distributor is sent to
        ("distributor_bar", "f8"),  # its output: as much of it as the reservoir has
        ("relay_bar", "f8", (BOGIES,)),  # what a bogie's cylinders are sent to: less, where a dynamic brake helps
        ("cylinder_bar", "f8", (AXLES,)),
        ("pad_bar", "f8", (AXLES,)),  # pad force as a pressure, behind spring and linkage
        ("reservoir_bar", "f8"),
        ("torque_nm", "f8", (AXLES,)),  # friction capacity
        ("dynamic_torque_nm", "f8", (AXLES,)),
        ("track_brake_force_n", "f8", (BOGIES,)),
        ("valve", "i1", (AXLES,)),  # as energised in the step done last
        ("disc_temperature_degc", "f8", (AXLES,)),
        ("drawn_nl", "f8"),  # reservoir to cylinders
        ("vented_nl", "f8"),
        ("leaked_nl", "f8"),
        ("supplied_nl", "f8"),  # feed pipe to reservoir
        ("let_off_nl", "f8"),  # lost from the reservoir when the supply failed
        ("timer_fired", "i1", (AXLES,)),
        # what others set
        ("track_brake_on", "?"),
        ("supply_stuck", "i1", (AXLES,)),  # FREE, STUCK_OPEN, STUCK_SHUT
        ("exhaust_stuck", "i1", (AXLES,)),
        ("cut_out", "i1", (AXLES,)),
        ("leak_dm3pbar", "f8", (AXLES,)),  # conductance times step, as all of this unit
        ("feed_open", "?"),
        # further state
        ("supply", "f8", (AXLES,)),  # passages 0..1
        ("exhaust", "f8", (AXLES,)),
        ("energised_steps", "i8", (AXLES,)),
        ("commands", "i1", (COMMAND_SLOTS, AXLES)),  # delay line
        ("tick", "i8"),
        ("dynamic_level_nm", "f8", (BOGIES,)),
        ("track_brake_share", "f8"),
        # constants
        ("slots", "i8"),
        ("timer_steps", "i8"),
        ("step_s", "f8"),
        ("full_bar", "f8"),
        ("rise_bar", "f8"),  # per step
        ("fall_bar", "f8"),
        ("opening_share", "f8"),
        ("fill_dm3pbar", "f8"),
        ("vent_dm3pbar", "f8"),
        ("feed_dm3pbar", "f8"),
        ("feed_bar", "f8"),
        ("reservoir_dm3", "f8"),
        ("critical_ratio", "f8"),
        ("nl_per_bar_dm3", "f8"),
        ("volume_dm3", "f8"),
        ("clearance_dm3", "f8"),
        ("elastic_dm3pbar", "f8"),
        ("preload_bar", "f8"),
        ("lay_on_bar", "f8"),
        ("falling_factor", "f8"),  # 1 + hysteresis
        ("force_per_bar_n", "f8"),
        ("radius_m", "f8"),
        ("friction", "f8"),  # mean
        ("friction_law", "i8"),
        ("block_kn_per_bar", "f8"),
        ("curve_points", "i8", (len(CURVES),)),
        ("curve_x", "f8", (len(CURVES), LONGEST_CURVE)),
        ("curve_y", "f8", (len(CURVES), LONGEST_CURVE)),
        ("heats", "?"),
        ("step_per_capacity", "f8"),  # s K/J
        ("cooling_wpk", "f8"),
        ("cooling_speed_wspkm", "f8"),
        ("radiating_area_m2", "f8"),
        ("ambient_degc", "f8"),
        ("blends", "?"),  # any bogie has a dynamic brake
        ("has_dynamic", "i1", (BOGIES,)),
        ("dynamic_limit_nm", "f8"),
        ("dynamic_power_w", "f8"),
        ("fade_to_radps", "f8"),
        ("fade_s", "f8"),  # growth of the share per rad/s
        ("cut_nm", "f8"),  # per step
        ("return_nm", "f8"),
        ("attraction_n", "f8"),
        ("track_rise_share", "f8"),
        ("track_cut_out_mps", "f8"),
    ],
    align=True,
)
"""The plant's record. Names that end in _dm3pbar: conductance times step, temperature included."""


def brake_record(parameters: BrakeParameters, step_s: float) -> np.ndarray:
    """Record (1,) of BRAKE: empty cylinders, full reservoir, cold discs, no fault.

    Raises ValueError for a step that is not positive and finite or too short for the dead time.
    """
    if not (math.isfinite(step_s) and step_s > 0.0):
        raise ValueError(f"step_s = {step_s}: a positive number of seconds is needed")
    dead_steps = round(parameters.valve_dead_time_s / step_s)
    if dead_steps >= COMMAND_SLOTS:
        shortest = parameters.valve_dead_time_s / (COMMAND_SLOTS - 1)
        raise ValueError(
            f"step_s = {step_s}: must be at least {shortest:.3g} for valve_dead_time_s = {parameters.valve_dead_time_s}"
        )
    record = np.zeros(1, BRAKE)
    b = record[0]
    b["step_s"] = step_s
    b["slots"] = dead_steps + 1
    b["commands"] = FILL
    b["valve"] = FILL
    b["timer_steps"] = max(1, round(parameters.safety_timer_s / step_s))
    b["opening_share"] = step_s / parameters.valve_opening_time_s
    b["supply"] = 1.0
    b["supply_stuck"] = b["exhaust_stuck"] = FREE
    _pack_pneumatics(b, parameters, step_s)
    _pack_friction(b, parameters, step_s)
    _pack_dynamic_brake(b, parameters, step_s)
    _pack_track_brake(b, parameters, step_s)
    return record


def conductance_step_dm3pbar(conductance_dm3psbar: float, parameters: BrakeParameters, step_s: float) -> float:
    """Conductance times step, for air at its temperature: over a volume it is the exchange of wsp.pneumatics."""
    warmth = (parameters.air_temperature_degc + _KELVIN) / REFERENCE_TEMPERATURE_K
    return conductance_dm3psbar * step_s * math.sqrt(warmth)


def _pack_pneumatics(b: np.void, parameters: BrakeParameters, step_s: float) -> None:
    p = parameters
    b["full_bar"] = p.full_service_pressure_bar
    b["rise_bar"] = p.full_service_pressure_bar / p.application_time_s * step_s
    b["fall_bar"] = p.full_service_pressure_bar / p.release_time_s * step_s
    for name, conductance in (
        ("fill_dm3pbar", p.fill_conductance_dm3psbar),
        ("vent_dm3pbar", p.vent_conductance_dm3psbar),
        ("feed_dm3pbar", p.feed_conductance_dm3psbar),
        ("leak_dm3pbar", p.leakage_dm3psbar),
    ):
        b[name] = conductance_step_dm3pbar(conductance, p, step_s)
    b["critical_ratio"] = p.critical_ratio
    b["nl_per_bar_dm3"] = _STANDARD_K / (ATMOSPHERE_BAR * (p.air_temperature_degc + _KELVIN))
    b["reservoir_bar"] = b["feed_bar"] = p.feed_pressure_bar
    b["reservoir_dm3"] = p.reservoir_volume_dm3
    b["feed_open"] = True
    b["volume_dm3"] = p.cylinder_volume_dm3
    b["clearance_dm3"] = p.clearance_volume_dm3
    b["elastic_dm3pbar"] = p.elastic_volume_dm3pbar
    b["preload_bar"] = p.return_spring_preload_bar
    b["lay_on_bar"] = p.return_spring_pressure_bar
    b["falling_factor"] = 1.0 + p.linkage_hysteresis


def _pack_friction(b: np.void, p: BrakeParameters, step_s: float) -> None:
    b["force_per_bar_n"] = p.force_per_bar_n
    b["block_kn_per_bar"] = 1e-3 * p.force_per_bar_n / p.blocks_per_axle
    b["radius_m"] = p.friction_radius_m
    b["friction"] = p.pad_friction
    b["friction_law"] = KARWATZKI if p.block_friction == "karwatzki" else 0
    curve = p.friction_curve
    _pack_curve(b, SPEED_FACTOR, curve.sliding_speed_mps, curve.speed_factor)
    _pack_curve(b, TEMPERATURE_FACTOR, curve.temperature_degc, curve.temperature_factor)
    b["disc_temperature_degc"] = 20.0
    if p.heat is None:
        return
    b["heats"] = True
    b["step_per_capacity"] = step_s / p.heat.heat_capacity_jpk
    b["cooling_wpk"] = p.heat.cooling_wpk
    b["cooling_speed_wspkm"] = p.heat.cooling_speed_wspkm
    b["radiating_area_m2"] = p.heat.radiating_area_m2
    b["ambient_degc"] = b["disc_temperature_degc"] = p.heat.ambient_degc


def _pack_dynamic_brake(b: np.void, p: BrakeParameters, step_s: float) -> None:
    dynamic = p.dynamic_brake
    if dynamic is None:
        return
    b["has_dynamic"] = dynamic.bogies
    b["blends"] = any(dynamic.bogies)
    b["dynamic_limit_nm"] = dynamic.torque_limit_nm
    b["dynamic_power_w"] = 1e3 * dynamic.power_limit_kw
    radps_per_kmh = 1.0 / (_KMH_PER_MPS * dynamic.wheel_radius_m)
    b["fade_to_radps"] = dynamic.fade_to_kmh * radps_per_kmh
    b["fade_s"] = 1.0 / ((dynamic.fade_from_kmh - dynamic.fade_to_kmh) * radps_per_kmh)
    b["cut_nm"] = dynamic.cut_nmps * step_s
    b["return_nm"] = dynamic.return_nmps * step_s


def _pack_track_brake(b: np.void, p: BrakeParameters, step_s: float) -> None:
    track = p.track_brake
    if track is None:
        return
    b["attraction_n"] = track.attraction_n
    b["track_rise_share"] = step_s / track.rise_time_s
    b["track_cut_out_mps"] = track.cut_out_kmh / _KMH_PER_MPS
    _pack_curve(b, TRACK_FRICTION, tuple(v / _KMH_PER_MPS for v in track.speed_kmh), track.friction)


def _pack_curve(b: np.void, number: int, x: tuple[float, ...], y: tuple[float, ...]) -> None:
    b["curve_points"][number] = len(x)
    b["curve_x"][number, : len(x)] = x
    b["curve_y"][number, : len(y)] = y
