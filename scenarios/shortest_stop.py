"""The shortest stop that the rail allows: a point mass that always uses all the adhesion there is."""

import numpy as np

from scenarios.cosimulation.line import Line
from scenarios.metrics import stop_span
from scenarios.schema import Scenario
from scenarios.truth import Truth
from vehicle import GRAVITY_MPS2
from wheel_rail.adhesion_condition import NO_KIND, rail_conditions
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, Vector, compiled
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import offered_to_wheels
from wheel_rail.recovery import CONDITION
from wsp import FILL, Brake
from wsp.brake import advance_brake

_STEP_S = 0.01


def shortest_stop(scenario: Scenario, truth: Truth, begin: int | None = None) -> float | None:
    """Distance in m from the brake demand to standstill of a point mass with the same demand build-up, resistance and
    gradient, braked by the smaller of the brake's force and peak adhesion x static load, summed over the wheels, on the
    rail as it was found, before any wheel of this coach ran over it; and by the magnetic track brakes as they were
    switched. None for a run without a stop.

    `begin`: row of the motion to count from in place of the brake demand, such as the end of a drag brake. What the
    brake did before, it has done: it is as full then as the demands so far have made it.
    """
    span = stop_span(truth)
    if span is None:
        return None
    start, end = span
    if begin is not None:
        start = begin
    line = Line(scenario)
    coach = scenario.coach
    brake = Brake(scenario.brake_at_load, _STEP_S)
    motion = truth.motion
    # the demand as it was given; held at its last value should this stop take longer
    before_s = motion.t_s[start] - motion.t_s[0]
    times = np.arange(0.0, before_s + 3.0 * (motion.t_s[end] - motion.t_s[start]) + 60.0, _STEP_S)
    demand = np.interp(motion.t_s[0] + times, truth.brake.t_s[: end + 1], truth.brake.demand[: end + 1])
    magnets = np.interp(motion.t_s[0] + times, truth.brake.t_s[: end + 1], truth.brake.track_brake_command[: end + 1])
    radius_m = 0.5 * coach.wheelset.wheel_diameter_m
    offsets = truth.wheelsets.position_m[start] - motion.position_m[start]
    distance = _point_mass_stop(
        float(motion.position_m[start]),
        float(motion.speed_mps[start]),
        demand,
        magnets,
        np.interp(motion.t_s[0] + times[: round(before_s / _STEP_S)], motion.t_s, motion.speed_mps),
        brake.record,
        np.full(4, FILL, np.int8),
        radius_m,
        offsets,
        coach.mass_kg,
        coach.effective_mass_kg,
        (coach.resistance.a_n, coach.resistance.b_nspm, coach.resistance.c_ns2pm2),
        line.track.gradient_permille(np.arange(0.0, line.track.length_m + 1.0)),
        line.rail,
        (line.contact.law.number, line.contact.law.address),
        line.contact.law.extra,
        tuple(line.contact.patch),
        line.contact.load_n,
        line.contact.parameters.shear_modulus_pa,
    )
    return float(distance) if np.isfinite(distance) else None


@compiled
def _point_mass_stop(
    position_m: float, speed_mps: float, demand: Array, magnets: Array, before_mps: Array, brake: Record,
    no_wsp: np.ndarray, radius_m: float, offsets_m: Array, mass_kg: float, effective_mass_kg: float, resistance: Vector,
    gradient_permille: Array, rail: RailTables, law: tuple[int, int], extra: Array, patch: Vector, load_n: float,
    shear_modulus_pa: float,
) -> float:  # fmt: skip
    """Distance to standstill, nan if the time of `demand` (per 10 ms) does not suffice; midpoint in speed.

    The demands come from the begin of the run; while it had the speeds `before_mps` the brake alone goes along.
    """
    condition, kinds = np.empty((CONDITION, LANES)), np.full(LANES, NO_KIND)
    load, wheel_speed, peak, at_creep = np.full((4, LANES), load_n)
    rate_radps = np.empty(4)
    start = position_m
    for k in range(before_mps.shape[0]):
        brake[0].track_brake_on = magnets[k] > 0.5
        rate_radps[:] = before_mps[k] / radius_m
        advance_brake(brake[0], demand[k], no_wsp, rate_radps, before_mps[k])
    for k in range(before_mps.shape[0], demand.shape[0]):
        rate_radps[:] = speed_mps / radius_m
        brake[0].track_brake_on = magnets[k] > 0.5
        advance_brake(brake[0], demand[k], no_wsp, rate_radps, speed_mps)
        force_n = (np.sum(brake[0].torque_nm) + np.sum(brake[0].dynamic_torque_nm)) / radius_m
        for i in range(4):
            rail_conditions(i, position_m + offsets_m[i], speed_mps, rail, condition, kinds)
        wheel_speed[:] = speed_mps
        offered_to_wheels(
            law[0], law[1], extra, wheel_speed, load, patch, load_n, condition, shear_modulus_pa, False, peak, at_creep
        )
        limit = load_n * np.sum(peak)
        drag = resistance[0] + speed_mps * (resistance[1] + speed_mps * resistance[2])
        drag += np.sum(brake[0].track_brake_force_n)  # not through the wheels
        place = min(max(int(position_m), 0), gradient_permille.shape[0] - 1)
        slope = mass_kg * GRAVITY_MPS2 * gradient_permille[place] / 1000.0
        # what the discs take out of the wheels' rotation does not pass through the rail
        deceleration = min((force_n + drag + slope) / effective_mass_kg, (limit + drag + slope) / mass_kg)
        if speed_mps - deceleration * _STEP_S <= 0.0:
            return position_m + 0.5 * speed_mps * speed_mps / deceleration - start
        position_m += speed_mps * _STEP_S - 0.5 * deceleration * _STEP_S * _STEP_S
        speed_mps -= deceleration * _STEP_S
    return np.nan
