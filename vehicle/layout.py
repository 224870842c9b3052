"""From parameters to the record of numbers that the compiled routines work on.

Bodies: 0 carbody, 1 and 2 bogies, 3..6 wheelsets (carriers that do not spin), and with explicit axle boxes 7..14, left
and right box of each wheelset. Coordinates: six per body 0..6, then the four spin angles, then six per axle box: 46 or
94, the first 46 the same in both forms. A body's coordinates are its world position and its turn, the integral of its
angular velocity in body axes; velocities are world velocity and angular velocity in body axes. A turn has no meaning by
itself: what it grows by in a step is the rotation vector of that step (the incremental rotation of a Lie-group
integrator), and `attitude` is where the body had turned to when the turn was `turned`.
"""

import numpy as np

from vehicle.elements import CURVE_POINTS, CURVES, ELEMENTS, RUBBING, fill_elements
from vehicle.pairs import KNOT, KNOTS, MOST_BATCHES, PLACES, SLOT, SLOTS, arrange_pairs
from vehicle.parameters import CoachParameters
from vehicle.rotations import BODY_LANES
from vehicle.wheels import MOST_HARMONICS
from wheel_rail import CONTACT, Contact
from wheel_rail.adhesion_condition import NO_KIND
from wheel_rail.adhesion_memory import MEMORY
from wheel_rail.adhesion_state import RAIL
from wheel_rail.compiled import aligned, record_reader
from wheel_rail.contact import GROWTH, REPORT, WHEEL
from wheel_rail.irregularities import OFFSETS
from wheel_rail.lanes import LANES
from wheel_rail.recovery import CONDITION
from wheel_rail.track_frame import FRAME_ROWS

BODIES = 7  # without axle boxes
COORDINATES = 46
SPIN = 42  # first spin coordinate
MOST_BODIES = 15
MOST_COORDINATES = 94
MOST_ROWS = 96  # coordinates filled up to whole registers
CLASSES = 9  # of forces
FRAMES, BODY_FRAME = 5, 4  # track frames; which of them is the carbody's
ACTUATION = 10  # brake torque (4) and drive torque (4) of the wheelsets, track brake force (2) of the bogies

COACH = np.dtype(
    [
        # what the contacts of the wheels are given, their forces and their report; first, because registers are read
        # fastest from where their own size goes into the address
        ("wheels", "f8", (WHEEL, LANES)),
        # track frames at wheelsets and carbody, the places s they belong to, and where the bodies are by now; further
        # lanes follow the carbody
        ("frame", "f8", (FRAME_ROWS, LANES)),
        ("frame_s", "f8", (LANES,)),
        ("s", "f8", (LANES,)),
        ("along", "f8", (LANES,)),  # their speed along the track
        ("frame_place", "i8", (LANES,)),  # their first coordinates
        ("condition", "f8", (CONDITION, LANES)),  # of the rail under each wheel
        ("condition_kind", "f8", (LANES,)),  # whose curves stand there
        ("memory", "f8", (MEMORY, LANES)),  # what each wheel remembers of its friction
        ("offsets", "f8", (4, OFFSETS)),  # of the rails at the wheelsets
        ("wheel_normal", "f8", (7, LANES)),
        ("wheel_creep", "f8", (7, LANES)),
        ("report", "f8", (REPORT, LANES)),
        ("marks", "f8", (2, LANES)),  # power and speed of sliding in the step under way, for the rail
        # the elements in lanes, see `vehicle.pairs`
        ("pair_place", "i8", (MOST_BATCHES, PLACES, LANES)),
        ("pair_turning", "f8", (MOST_BATCHES, 6, LANES)),  # rotational stiffness and damping
        ("slot", "f8", (SLOTS, SLOT, LANES)),
        ("knot", "f8", (KNOTS, KNOT, LANES)),
        # forces by class, and the speeds that they work with where they are observed; zero beyond the coordinates
        ("force", "f8", (CLASSES, MOST_ROWS)),
        ("speeds", "f8", (MOST_ROWS,)),
        ("masses", "f8", (MOST_ROWS,)),  # diagonal of the mass matrix
        # constants
        ("bodies", "i8"),
        ("body_place", "i8", (BODY_LANES,)),  # first coordinate of each
        ("coordinates", "i8"),
        ("elements", "i8"),
        ("mass", "f8", (MOST_BODIES,)),
        ("inertia", "f8", (MOST_BODIES, 3)),
        ("spin_inertia", "f8"),
        ("resistance", "f8", (3,)),
        ("caliper_stiffness", "f8"),
        ("caliper_damping", "f8"),
        ("contact", CONTACT),
        ("uneven", "i8"),  # whether any wheel is out of round
        ("oversize", "f8", (4, 2)),  # radius of each wheel less the nominal one
        ("harmonics", "i8", (4, 2)),
        ("harmonic", "f8", (4, 2, MOST_HARMONICS, 3)),  # order, amplitude, phase
        ("upper", "i8", (ELEMENTS,)),
        ("lower", "i8", (ELEMENTS,)),
        ("upper_point", "f8", (ELEMENTS, 3)),
        ("lower_point", "f8", (ELEMENTS, 3)),
        ("stiffness", "f8", (ELEMENTS, 3)),
        ("damping", "f8", (ELEMENTS, 3)),
        ("preload", "f8", (ELEMENTS,)),  # vertical force on the lower body at zero deflection, downwards
        ("rotational_stiffness", "f8", (ELEMENTS, 3)),
        ("rotational_damping", "f8", (ELEMENTS, 3)),
        ("turns", "i8", (ELEMENTS,)),  # whether it has rotational stiffness or damping
        ("pushes", "i8", (ELEMENTS,)),  # whether it has forces
        ("damper", "i8", (ELEMENTS, 3)),  # index of the curve, -1 for none
        ("stop", "i8", (ELEMENTS, 3)),
        # curves: the side above 0 and the side below, as magnitudes
        ("curve_x", "f8", (CURVES, 2, CURVE_POINTS)),
        ("curve_force", "f8", (CURVES, 2, CURVE_POINTS)),
        ("curve_slope", "f8", (CURVES, 2, CURVE_POINTS)),  # of the piece that ends at the point
        ("curve_points", "i8", (CURVES, 2)),
        ("batches", "i8"),
        ("pair_slots", "i8", (MOST_BATCHES, 2)),  # from, to
        ("slot_knots", "i8", (SLOTS, 3, 2, 2)),  # of each axis over deflection and over speed: from, to
        ("rubbing", "i8", (RUBBING, 2)),  # elements and axes with dry friction
        ("rubbing_count", "i8"),
        ("bogie_of", "i8", (4,)),
        ("track_brake_arm", "f8"),  # height of a bogie's centre over the rails, m
        ("track_origin_m", "f8"),
        # where the arrays of a run stand: q, v, accelerations and forces of the solver, track and rail
        ("solver_at", "i8", (4,)),
        ("iterates", "i8"),  # whether the solver iterates with Jacobians of its own
        ("response_at", "i8"),  # see `vehicle.implicit`
        ("track_at", "i8"),
        ("track_nodes", "i8"),
        # table of the rails' irregularities, its nodes (0 on smooth rails), their first place and spacing
        ("offsets_at", "i8"),
        ("offset_nodes", "i8"),
        ("offset_first_m", "f8"),
        ("offset_cell_m", "f8"),
        ("rail", RAIL),
        ("actuation_at", "i8"),
        ("step_s", "f8"),
        # Python objects and the tuples they are called with: at every so many steps, with the forces of each step, and
        # when a step does not begin as usual
        ("steps_per_turn", "i8"),
        ("turn_at", "i8", (2,)),
        ("hand_over_at", "i8", (2,)),
        ("copes_at", "i8", (2,)),
        # the step under way: when it began, and how
        ("begin_s", "f8"),
        ("began", "i8"),
        # compiled work at every so many steps (0: none): its function, its argument; what it has answered
        ("plant_every", "i8"),
        ("plant_at", "i8", (2,)),
        ("plant_said", "i8"),
        # what changes from step to step
        ("attitude", "f8", (4, BODY_LANES)),  # unit quaternion (w, x, y, z) of each body's last committed rotation
        ("turned", "f8", (3, BODY_LANES)),  # turn coordinates at that rotation
        ("passed", "f8", (4,)),  # place up to which each wheelset has left its mark on the rail
        ("sanders_at", "i8"),  # rows of `Sanders.rows`, so many
        ("sander_count", "i8"),
        ("capacity", "f8", (4,)),  # friction torque that the brake can hold, Nm
        ("drive", "f8", (4,)),  # drive torque, Nm
        ("track_brake", "f8", (2,)),  # friction of each bogie's magnets, N
        ("wind_up", "f8", (4,)),  # elastic angle of a stuck caliper, rad
        ("angle", "f8", (4,)),  # spin angle at which wind_up was taken, rad
        ("steps", "i8"),
        ("last_v", "f8", (MOST_COORDINATES,)),
        ("algorithmic", "f8", (MOST_COORDINATES,)),  # accelerations of the generalised-alpha method
        ("ahead_q", "f8", (MOST_COORDINATES,)),  # the predictor
        ("ahead_v", "f8", (MOST_COORDINATES,)),
        # worked out in every evaluation
        ("rotation", "f8", (3, 3, BODY_LANES)),
        ("brake_torque", "f8", (4,)),
        ("stuck", "f8", (4,)),
        # of the last Jacobian, to tell when it has aged
        ("old_tangent", "f8", (4, 2)),
        ("old_secant", "f8", (4, 2)),
        ("old_slide", "f8", (4, 2)),  # of the last step
        ("old_touch", "f8", (4, 2)),
        ("old_stuck", "f8", (4,)),
        ("old_rubbing", "f8", (RUBBING,)),  # slopes of dry friction in the last step
        ("regaining", "f8", (4,)),  # 1: a step with its tangents would carry the wheelset through zero slip
        ("old_axes", "f8", (9,)),  # of the track at the carbody: ahead, left, up
        ("old_yaw", "f8", (4,)),  # of the wheelsets to those
        ("jacobians", "i8"),
        # scratch
        ("probe_element", "f8", (12,)),
        ("probe_map", "f8", (12,)),
        ("probe_rows", "f8", (6, 7)),
        ("probe_force", "f8", (2, MOST_ROWS)),
    ]
)

coach_at = record_reader(COACH)
"""For compiled code: the coach whose record stands at an address."""


def coach_record(parameters: CoachParameters, contact: Contact) -> np.ndarray:
    """Array of one `COACH` record with all constants set; the elements carry the static loads of level track."""
    p = parameters
    coach = aligned(np.zeros(1, COACH))
    c = coach[0]
    explicit = p.axle_boxes == "explicit"
    c["bodies"] = MOST_BODIES if explicit else BODIES
    c["coordinates"] = MOST_COORDINATES if explicit else COORDINATES
    c["body_place"][: c["bodies"]] = [first_coordinate(i) for i in range(c["bodies"])]
    _masses(c, p)
    c["spin_inertia"] = p.wheelset.spin_inertia_kgm2
    c["resistance"] = (p.resistance.a_n, p.resistance.b_nspm, p.resistance.c_ns2pm2)
    c["caliper_stiffness"] = p.caliper.stiffness_nmprad
    c["caliper_damping"] = p.caliper.damping_nmsprad
    c["contact"] = contact.constants
    c["bogie_of"] = (1, 1, 2, 2)
    c["track_brake_arm"] = p.bogie.height_m
    c["oversize"] = p.wheels.oversize_m(p.wheelset.wheel_diameter_m)
    c["wheels"][GROWTH] = c["oversize"].ravel()
    c["condition_kind"] = NO_KIND
    c["frame_place"][:4] = [first_coordinate(i) for i in range(BODIES - 4, BODIES)]
    c["harmonics"], c["harmonic"] = p.wheels.harmonics()
    c["uneven"] = bool(p.wheels.out_of_roundness)
    c["masses"][: c["coordinates"]] = _diagonal(c)
    fill_elements(c, p, centres(p, contact))
    arrange_pairs(c)
    return coach


def _masses(c: np.void, p: CoachParameters) -> None:
    wheelset, box = p.wheelset, p.axle_box
    mass_kg = wheelset.mass_kg
    carrier = np.array([wheelset.roll_inertia_kgm2, 2.0 * box.pitch_inertia_kgm2, wheelset.yaw_inertia_kgm2])
    if p.axle_boxes == "explicit":
        mass_kg -= 2.0 * box.mass_kg
        offset = box.mass_kg * p.primary.half_spacing_m**2
        carrier -= 2.0 * (box.inertia_kgm2 + np.array([offset, 0.0, offset]))
        c["mass"][BODIES:] = box.mass_kg
        c["inertia"][BODIES:] = box.inertia_kgm2
    body, bogie = p.laden_body, p.bogie
    c["mass"][:BODIES] = [body.mass_kg] + [bogie.mass_kg] * 2 + [mass_kg] * 4
    c["inertia"][:3] = [(b.roll_inertia_kgm2, b.pitch_inertia_kgm2, b.yaw_inertia_kgm2) for b in (body, bogie, bogie)]
    c["inertia"][3:BODIES] = carrier


def first_coordinate(body: int) -> int:
    """Where the six coordinates of a body begin."""
    return 6 * body if body < BODIES else COORDINATES + 6 * (body - BODIES)


def masses(coach: np.void) -> np.ndarray:
    """Diagonal of the mass matrix (coordinates,)."""
    diagonal: np.ndarray = coach["masses"][: coach["coordinates"]]
    return diagonal


def _diagonal(coach: np.void) -> np.ndarray:
    bodies = [m for i in range(coach["bodies"]) for m in ([coach["mass"][i]] * 3 + list(coach["inertia"][i]))]
    return np.array([*bodies[:SPIN], *[coach["spin_inertia"]] * 4, *bodies[SPIN:]])


def centres(parameters: CoachParameters, contact: Contact) -> np.ndarray:
    """Centres of the bodies on level straight track, relative to the track below the carbody: (bodies, 3) m."""
    p = parameters
    bogies = [0.5 * p.bogie_distance_m, -0.5 * p.bogie_distance_m]
    wheels = [b + 0.5 * side * p.wheelbase_m for b in bogies for side in (1, -1)]
    sink = contact.radius_m - contact.rest_height_m
    rows = [(0.0, 0.0, p.laden_body.height_m)]
    rows += [(x, 0.0, p.bogie.height_m) for x in bogies] + [(x, 0.0, contact.radius_m) for x in wheels]
    if p.axle_boxes == "explicit":
        rows += [(x, side * p.primary.half_spacing_m, contact.radius_m) for x in wheels for side in (1, -1)]
    return np.array([(x, y, z - sink) for x, y, z in rows])
