"""Dynamic brake of a bogie, blended with its pneumatic brake, and the magnetic track brake."""

from wsp.brake_record import BOGIES, TRACK_FRICTION
from wsp.compiled import FloatArray, Record, compiled
from wsp.friction import curve_value
from wsp.valves import FILL


@compiled
def blend(wheel_rate_radps: FloatArray, b: Record) -> None:
    """Dynamic torque of each bogie one step on, and the pressure that its relay still asks for.

    The torque takes over all that the distributor asks for if it can; the relay stays at the pressure that lays the
    pads on then. The only thing that it hears of the WSP are the valves: see DynamicBrakeParameters.
    """
    torque_per_bar = b.force_per_bar_n * b.friction * b.radius_m
    asked = min(b.dynamic_limit_nm, torque_per_bar * max(0.0, b.control_bar - b.lay_on_bar))
    for bogie in range(BOGIES):
        b.relay_bar[bogie] = b.control_bar
        if not b.has_dynamic[bogie]:
            continue
        first, second = 2 * bogie, 2 * bogie + 1
        cut = b.valve[first] != FILL or b.valve[second] != FILL
        wanted = 0.0 if cut else asked
        level = b.dynamic_level_nm[bogie]
        level = min(wanted, level + b.return_nm) if wanted > level else max(wanted, level - b.cut_nm)
        front, rear = _available_nm(wheel_rate_radps[first], b), _available_nm(wheel_rate_radps[second], b)
        level = min(level, max(front, rear))
        b.dynamic_level_nm[bogie] = level
        b.dynamic_torque_nm[first] = min(level, front)
        b.dynamic_torque_nm[second] = min(level, rear)
        mean = 0.5 * (b.dynamic_torque_nm[first] + b.dynamic_torque_nm[second])
        b.relay_bar[bogie] = max(0.0, b.control_bar - mean / torque_per_bar)


@compiled
def _available_nm(wheel_rate_radps: float, b: Record) -> float:
    """Largest torque of a motor: limit and power, faded out as its own wheels slow down."""
    rate = abs(wheel_rate_radps)
    torque = b.dynamic_limit_nm * min(1.0, max(0.0, (rate - b.fade_to_radps) * b.fade_s))
    return min(torque, b.dynamic_power_w / max(rate, 1e-6))


@compiled
def press_magnets(speed_mps: float, b: Record) -> None:
    """Force of the magnetic track brake of each bogie one step on: TrackBrakeParameters' equation."""
    speed = abs(speed_mps)
    if b.track_brake_on and speed > b.track_cut_out_mps:
        b.track_brake_share = min(1.0, b.track_brake_share + b.track_rise_share)
    else:
        b.track_brake_share = max(0.0, b.track_brake_share - b.track_rise_share)
    force = 0.0
    if b.track_brake_share > 0.0:
        force = b.attraction_n * b.track_brake_share * curve_value(TRACK_FRICTION, speed, b)
    b.track_brake_force_n[0] = force
    b.track_brake_force_n[1] = force
