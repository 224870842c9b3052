"""What happens between two steps of the solver: commit the step that has ended, and look ahead to the next.

The solver (generalised-alpha, one linearised solve a step) evaluates forces at its predictor, the state that follows
from the last one with zero acceleration at the end of the step. The predictor is worked out here by the same formulas
(J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371-375, in the form with algorithmic accelerations), so that one
compiled call before the step does everything and Exudyn need not call back, neither for forces nor for Jacobians
(`vehicle.implicit`).
"""

import math

from vehicle.forces import add_classes, forces_by_class
from vehicle.implicit import ALPHA_F, ALPHA_M, BETA, GAMMA, new_response, respond, yaw_has_changed
from vehicle.layout import ACTUATION, coach_at
from vehicle.rails import meet_rails, speeds_along
from vehicle.rotations import commit_attitudes
from vehicle.suspension_jacobian import friction_has_changed
from wheel_rail.adhesion_memory import remember_friction
from wheel_rail.adhesion_state import RailTables, crush_sand, deposit, rail_of
from wheel_rail.compiled import Array, Record, array_at, call_at, compiled, inlined
from wheel_rail.contact import LONGITUDINAL, NORMAL, PENETRATION, SECANT, SLIDE, SLIDE_POWER, SLIDE_SPEED, TANGENT
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lanes import LANES, some
from wheel_rail.sanding import lay_sand

_STALE_SHARE = 0.0003

FRESH, AGED, LOST, REFUSED = range(4)


@compiled
def begin_step(address: int) -> int:
    """Commit the step that has ended in the solver's state, let the plant work if it is its turn, and put the forces of
    the next step into the solver's force vector; `address` of the coach's record.

    Returns FRESH, or AGED if a solver that iterates needs a new Jacobian, LOST when the state or the actuation is not
    finite or the step has no solution, REFUSED when the plant does not go on.
    """
    coach = coach_at(address)
    step_s, shape = coach.step_s, (coach.coordinates,)
    q, v = array_at(coach.solver_at[0], shape), array_at(coach.solver_at[1], shape)
    a, f = array_at(coach.solver_at[2], shape), array_at(coach.solver_at[3], shape)
    track = array_at(coach.track_at, (coach.track_nodes, 10))
    rail = rail_of(coach.rail)
    for j in range(coach.coordinates):
        if not math.isfinite(v[j]):
            return LOST
    if coach.plant_every > 0 and coach.steps % coach.plant_every == 0:
        coach.plant_said = call_at(coach.plant_at[0], coach.plant_at[1], coach.begin_s)  # type: ignore[call-arg]
        if coach.plant_said != 0:
            return REFUSED
    actuation = array_at(coach.actuation_at, (ACTUATION,))
    for i in range(ACTUATION):
        if not math.isfinite(actuation[i]):
            return LOST
    for i in range(4):
        coach.capacity[i], coach.drive[i] = actuation[i], actuation[4 + i]
        coach.track_brake[i // 2] = actuation[8 + i // 2]
    for i in range(4):
        # the wind-up of a stuck caliper follows the wheel up to what its capacity holds
        limit = coach.capacity[i] / coach.caliper_stiffness
        wind_up = coach.wind_up[i] + q[42 + i] - coach.angle[i]
        coach.wind_up[i] = min(max(wind_up, -limit), limit)
        coach.angle[i] = q[42 + i]
    if coach.iterates:
        _note_marks(coach)
    _mark_rail(step_s, coach, rail)
    put_lanes(coach.s, 0, lanes_at(coach.s, 0) + step_s * speeds_along(v, coach))
    commit_attitudes(q, coach)
    _to_predictor(q, v, a, step_s, coach)
    forces_by_class(coach.ahead_q, coach.ahead_v, coach, track, rail)
    _note_marks(coach)
    add_classes(coach, f)
    aged = _jacobian_has_aged(step_s, coach)
    if coach.rubbing_count > 0 and friction_has_changed(coach.ahead_q, coach.ahead_v, coach):
        aged = True
    if coach.iterates:
        return AGED if aged else FRESH
    if (aged or coach.jacobians == 0) and not new_response(step_s, coach):
        return LOST
    respond(f, coach)
    return FRESH


@inlined
def _note_marks(coach: Record) -> None:
    """Keep of the report what the step will do to the rail: who observes the coach works the forces out anew."""
    put_lanes(coach.marks, 0, lanes_at(coach.report, SLIDE_POWER * LANES))
    put_lanes(coach.marks, LANES, lanes_at(coach.report, SLIDE_SPEED * LANES))


@compiled
def _mark_rail(step_s: float, coach: Record, rail: RailTables) -> None:
    """What the wheels have done to the rail in the step that has ended: energy left, sand crushed and laid."""
    power, slide = coach.marks[0], coach.marks[1]
    for i in range(4):
        deposit(rail, coach.passed[i], coach.s[i], step_s * power[2 * i], step_s * power[2 * i + 1])
    if rail.memory_distance_m > 0.0:
        meet_rails(coach, rail)
        remember_friction(
            coach.condition, coach.memory, slide, step_s, rail.memory_distance_m, rail.memory_lowest_slip_mps
        )
    if coach.sander_count > 0:
        for i in range(4):
            for side in range(2):
                crush_sand(rail, side, coach.passed[i], coach.s[i])
        sanders = array_at(coach.sanders_at, (coach.sander_count, 3))
        lay_sand(rail, sanders, coach.passed, coach.s, step_s)
    for i in range(4):
        coach.passed[i] = coach.s[i]


@compiled
def _jacobian_has_aged(step_s: float, coach: Record) -> bool:
    """Whether the forces at the predictor call for a new Jacobian.

    It is old when the error of a creep slope, times what the slip has moved in the step, makes a false force of 0.03 %
    of the wheel load (this decides the accuracy at the edge of sliding); when a slope times step over effective mass
    has changed by over one half; when a wheel has lifted or landed, a brake has caught or let go, a wheelset regains
    its grip or has regained it, or a wheelset has another yaw.
    """
    aged = False
    radius = coach.contact.radius_m
    unit = coach.spin_inertia / (step_s * radius * radius)
    for i in range(4):
        if coach.stuck[i] != coach.old_stuck[i]:
            aged = True
        was_regaining = coach.regaining[i]
        coach.regaining[i] = 1.0 if _regains_grip(i, unit, coach) else 0.0
        if coach.regaining[i] > 0.0 or was_regaining > 0.0:
            aged = True
    tangent, secant = lanes_at(coach.report, TANGENT * LANES), lanes_at(coach.report, SECANT * LANES)
    slide, depth = lanes_at(coach.report, SLIDE * LANES), lanes_at(coach.report, PENETRATION * LANES)
    old_tangent, old_secant = lanes_at(coach.old_tangent, 0), lanes_at(coach.old_secant, 0)
    old_touch = lanes_at(coach.old_touch, 0)
    error = abs(tangent - old_tangent)
    moved = abs(slide - lanes_at(coach.old_slide, 0))
    put_lanes(coach.old_slide, 0, slide)
    false_force = error * moved > _STALE_SHARE * lanes_at(coach.report, NORMAL * LANES)
    changed = (error > 0.5 * (unit + abs(old_tangent))) | (abs(secant - old_secant) > 0.5 * (unit + old_secant))
    landed, lifted = (depth > 0.0) & (old_touch <= 0.0), (depth <= 0.0) & (old_touch > 0.0)
    if some(false_force | changed | landed | lifted):
        aged = True
    return aged or yaw_has_changed(coach)


@compiled
def _regains_grip(i: int, unit: float, coach: Record) -> bool:
    """Whether a step with the tangents of wheelset i would carry its slip through zero, out of saturated creep.

    The tangent there is flat and knows nothing of the force that reverses beyond: the wheelset would ring from one side
    to the other, step by step. `unit`: spin inertia over step and radius squared, N s/m.
    """
    left, right = coach.report[:, 2 * i], coach.report[:, 2 * i + 1]
    slide = 0.5 * (left[SLIDE] + right[SLIDE])
    tangent, secant = left[TANGENT] + right[TANGENT], left[SECANT] + right[SECANT]
    if tangent > 0.5 * secant:
        return False
    driven = (coach.brake_torque[i] + coach.drive[i]) / coach.contact.radius_m
    change = (left[LONGITUDINAL] + right[LONGITUDINAL] - driven) / max(unit + tangent, 0.1 * unit)
    return slide * (slide + change) < 0.0


@compiled
def _to_predictor(q: Array, v: Array, a: Array, step_s: float, coach: Record) -> None:
    """Predicted coordinates and velocities into `coach.ahead_q`, `coach.ahead_v`.

    The algorithmic acceleration follows from the velocities: v1 = v0 + h ((1 - gamma) A0 + gamma A1).
    """
    if coach.steps == 0:
        for j in range(coach.coordinates):
            coach.algorithmic[j] = a[j]
    else:
        rate, kept = 1.0 / (GAMMA * step_s), (1.0 - GAMMA) / GAMMA
        for j in range(coach.coordinates):
            coach.algorithmic[j] = rate * (v[j] - coach.last_v[j]) - kept * coach.algorithmic[j]
    coach.steps += 1
    # the algorithmic acceleration at the end of the step is a share of `a` less one of that at its begin
    of_a, of_begin = ALPHA_F / (1.0 - ALPHA_M), -ALPHA_M / (1.0 - ALPHA_M)
    speed_a, speed_begin = step_s * GAMMA * of_a, step_s * (1.0 - GAMMA + GAMMA * of_begin)
    place_a, place_begin = step_s * step_s * BETA * of_a, step_s * step_s * (0.5 - BETA + BETA * of_begin)
    for j in range(coach.coordinates):
        begin = coach.algorithmic[j]
        coach.last_v[j] = v[j]
        coach.ahead_v[j] = v[j] + (speed_begin * begin + speed_a * a[j])
        coach.ahead_q[j] = q[j] + step_s * v[j] + (place_begin * begin + place_a * a[j])
