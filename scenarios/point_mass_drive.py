"""A scenario driven through the point mass: its driver, brake and line, with forces limited by the adhesion found.

What the coach has and this has not: wheels that slide (and clean the rail), controllers, load transfer, curves. Where
less adhesion is found than drive or brake ask for, it uses all of the peak, on the rail as found.
"""

import numpy as np

from scenarios.cosimulation.driver import Driver
from scenarios.cosimulation.line import Line
from scenarios.cosimulation.loop import DRIVER_PERIOD_S, STANDSTILL_LASTS_S
from scenarios.point_mass import RADIUS_SPACING_M, SLOPE_SPACING_M, STEP_S, PointMass, PointMassStream, readings
from scenarios.point_mass import Line as PointMassLine
from scenarios.schema import Scenario
from scenarios.units import KMH_PER_MPS
from vehicle import GRAVITY_MPS2
from wheel_rail.adhesion_condition import NO_KIND, rail_conditions
from wheel_rail.adhesion_state import RailTables
from wheel_rail.compiled import Array, Record, Vector, compiled
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import offered_to_wheels
from wheel_rail.recovery import CONDITION
from wsp import FILL, Brake
from wsp.brake import advance_brake

_STEPS = round(DRIVER_PERIOD_S / STEP_S)
_STANDS_MPS = 1e-9

# what changes, in one row
S, V, TRACTION, DEMAND = range(4)


def drive_point_mass(scenario: Scenario, model: PointMass) -> PointMassStream:
    """Run the scenario until the train stands braked for 2 s, its time is over or its line ends."""
    line = Line(scenario)
    thesis_line = sampled_line(line)
    coach = scenario.coach
    driver = Driver(scenario.driver, scenario.traction, DRIVER_PERIOD_S)
    brake = Brake(scenario.brake, STEP_S)
    simulation = scenario.simulation
    start_mps = simulation.initial_speed_kmh / KMH_PER_MPS
    state = np.array([simulation.initial_position_m, start_mps, 0.0, 0.0])
    effective_kg = (1.0 + model.rotating_share) * coach.mass_kg
    outer_m, inner_m = (
        0.5 * (coach.bogie_distance_m + coach.wheelbase_m),
        0.5 * (coach.bogie_distance_m - coach.wheelbase_m),
    )
    constants = np.array(
        [
            coach.mass_kg,
            effective_kg,
            0.5 * coach.wheelset.wheel_diameter_m,
            model.largest_speed_kmh / KMH_PER_MPS,
            len(scenario.traction.driven_wheelsets) / 4.0,
            line.contact.load_n,
            line.contact.parameters.shear_modulus_pa,
            1000.0 * scenario.traction.largest_power_kw,
        ]
    )
    offsets_m = np.array([outer_m, inner_m, -inner_m, -outer_m])
    law = (line.contact.law.number, line.contact.law.address)
    patch = tuple(line.contact.patch)
    no_wsp = np.full(4, FILL, np.int8)
    blocks, stood_s, moved = [np.array([state[:2]])], 0.0, False
    while (len(blocks) - 1) * DRIVER_PERIOD_S < simulation.longest_s:
        # what he answered at the last tick is in force, as in the coach's loop
        state[TRACTION], state[DEMAND] = driver.traction_n, driver.demand
        driver.step(state[S], state[V])
        rows = np.empty((_STEPS, 2))
        _advance(
            rows, state, constants, model.resistance_npkn, thesis_line.gradient_permille, brake.record, no_wsp,
            offsets_m, line.rail, law, line.contact.law.extra, patch,
        )  # fmt: skip
        blocks.append(rows)
        moved = moved or state[V] > 0.0
        stood_s = stood_s + DRIVER_PERIOD_S if moved and state[V] <= _STANDS_MPS else 0.0
        stays = state[DEMAND] > 0.0 and driver.demand > 0.0 and not driver.goes_on
        if stood_s >= STANDSTILL_LASTS_S and stays:
            break
        if state[S] > line.places_m[1]:
            break
    run = np.concatenate(blocks)
    return readings(model, run[:, 0], run[:, 1], thesis_line)


def sampled_line(line: Line) -> PointMassLine:
    """The scenario's track as the thesis gives it: gradient each 100 m, radius each 50 m."""
    slope_m = np.arange(0.0, line.track.length_m + SLOPE_SPACING_M, SLOPE_SPACING_M)
    radius_m = np.arange(0.0, line.track.length_m + RADIUS_SPACING_M, RADIUS_SPACING_M)
    with np.errstate(divide="ignore"):
        radius = 1.0 / line.track.curvature_radpm(radius_m + 0.5 * RADIUS_SPACING_M)
    return PointMassLine(line.track.gradient_permille(slope_m), radius)


@compiled
def _advance(
    rows: Array, state: Array, constants: Array, resistance: Vector, slope: Array, brake: Record, no_wsp: np.ndarray,
    offsets_m: Array, rail: RailTables, law: tuple[int, int], extra: Array, patch: Vector,
) -> None:  # fmt: skip
    """The steps between two ticks of the driver; fills `rows` (n, 2) with position and speed at their ends."""
    mass, effective, radius, largest, driven_share, load_n, shear, power = constants
    condition, kinds = np.empty((CONDITION, LANES)), np.full(LANES, NO_KIND)
    load, wheel_speed, peak, at_creep = np.full((4, LANES), load_n)
    rate = np.empty(4)
    weight = mass * GRAVITY_MPS2
    for k in range(rows.shape[0]):
        s, v = state[S], state[V]
        rate[:] = v / radius
        advance_brake(brake[0], state[DEMAND], no_wsp, rate, v)
        braking = (np.sum(brake[0].torque_nm) + np.sum(brake[0].dynamic_torque_nm)) / radius
        driving = min(state[TRACTION], power / max(v, 1.0))
        for i in range(4):
            rail_conditions(i, s + offsets_m[i], v, rail, condition, kinds)
        wheel_speed[:] = v
        offered_to_wheels(
            law[0], law[1], extra, wheel_speed, load, patch, load_n, condition, shear, False, peak, at_creep
        )
        found = load_n * np.sum(peak)
        u = s / SLOPE_SPACING_M
        i = min(max(int(u), 0), slope.shape[0] - 2)
        permille = slope[i] + (u - i) * (slope[i + 1] - slope[i])
        kmh = KMH_PER_MPS * v
        drag = np.sum(brake[0].track_brake_force_n) + weight * np.sin(np.arctan(permille / 1000.0))
        if v > 0.0:
            drag += weight / 1000.0 * (resistance[0] + kmh * (resistance[1] + kmh * resistance[2]))
        asked = driving - braking
        # what turns the wheels faster or slower does not pass through the rail
        if asked > 0.0:
            a = min((asked - drag) / effective, (driven_share * found - drag) / mass)
        else:
            a = max((asked - drag) / effective, (-found - drag) / mass)
        w = min(max(v + a * STEP_S, 0.0), largest)
        state[S] = s + 0.5 * (v + w) * STEP_S
        state[V] = w
        rows[k, 0] = state[S]
        rows[k, 1] = w
