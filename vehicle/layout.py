"""From parameters to the record of numbers that the compiled routines work on.

Bodies: 0 carbody, 1 and 2 bogies, 3..6 wheelsets (carriers that do not spin). Coordinates: six per body, then the four
spin angles: 46. A body's coordinates are its world position and its turn, the integral of its angular velocity in body
axes; velocities are world velocity and angular velocity in body axes. A turn has no meaning by itself: what it grows by
in a step is the rotation vector of that step (the incremental rotation of a Lie-group integrator), and `attitude` is
where the body had turned to when the turn was `turned`.
"""

import numpy as np

from vehicle.parameters import GRAVITY_MPS2, Characteristic, CoachParameters
from wheel_rail import CONTACT, Contact
from wheel_rail.adhesion_memory import MEMORY
from wheel_rail.adhesion_state import RAIL
from wheel_rail.compiled import record_reader
from wheel_rail.contact import REPORT
from wheel_rail.recovery import CONDITION
from wheel_rail.sanding import MOST_SANDERS

BODIES = 7
COORDINATES = 46
SPIN = 42  # first spin coordinate
ELEMENTS = 20  # 8 primary, 4 secondary, 4 yaw dampers, 2 traction rods, 2 anti-roll bars
CURVE_POINTS = 12
CURVES = 7
CLASSES = 9  # of forces
ACTUATION = 10  # brake torque (4) and drive torque (4) of the wheelsets, track brake force (2) of the bogies

COACH = np.dtype(
    [
        # constants
        ("mass", "f8", (BODIES,)),
        ("inertia", "f8", (BODIES, 3)),
        ("spin_inertia", "f8"),
        ("resistance", "f8", (3,)),
        ("caliper_stiffness", "f8"),
        ("caliper_damping", "f8"),
        ("contact", CONTACT),
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
        ("curve_x", "f8", (CURVES, CURVE_POINTS)),
        ("curve_force", "f8", (CURVES, CURVE_POINTS)),
        ("curve_slope", "f8", (CURVES, CURVE_POINTS)),  # of the piece that ends at the point
        ("curve_points", "i8", (CURVES,)),
        ("bogie_of", "i8", (4,)),
        ("track_brake_arm", "f8"),  # height of a bogie's centre over the rails, m
        ("track_origin_m", "f8"),
        # where the arrays of a run stand: q, v, accelerations and forces of the solver, track and rail
        ("solver_at", "i8", (4,)),
        ("track_at", "i8"),
        ("track_nodes", "i8"),
        # table of the rails' irregularities, its nodes (0 on smooth rails), their first place and spacing
        ("offsets_at", "i8"),
        ("offset_nodes", "i8"),
        ("offset_first_m", "f8"),
        ("offset_cell_m", "f8"),
        ("rail", RAIL),
        ("actuation_at", "i8"),
        # what changes from step to step
        ("attitude", "f8", (BODIES, 4)),  # unit quaternion (w, x, y, z) of the last committed rotation
        ("turned", "f8", (BODIES, 3)),  # turn coordinates at that rotation
        ("memory", "f8", (2, 4, MEMORY)),  # what each wheel remembers of its friction
        ("passed", "f8", (4,)),  # place up to which each wheelset has left its mark on the rail
        ("sanders", "f8", (MOST_SANDERS, 3)),  # rows of `Sanders.rows`
        ("sander_count", "i8"),
        ("s", "f8", (5,)),  # place of the wheelsets and of the carbody's centre along the track
        ("capacity", "f8", (4,)),  # friction torque that the brake can hold, Nm
        ("drive", "f8", (4,)),  # drive torque, Nm
        ("track_brake", "f8", (2,)),  # friction of each bogie's magnets, N
        ("wind_up", "f8", (4,)),  # elastic angle of a stuck caliper, rad
        ("angle", "f8", (4,)),  # spin angle at which wind_up was taken, rad
        ("steps", "i8"),
        ("last_v", "f8", (COORDINATES,)),
        ("algorithmic", "f8", (COORDINATES,)),  # accelerations of the generalised-alpha method
        ("ahead_q", "f8", (COORDINATES,)),  # the predictor
        ("ahead_v", "f8", (COORDINATES,)),
        # worked out in every evaluation
        ("rotation", "f8", (BODIES, 3, 3)),
        ("rate", "f8", (BODIES, 3)),  # angular velocity in the world
        ("frame", "f8", (5, 14)),
        ("along", "f8", (4,)),  # speed of the wheelsets along the track
        ("condition", "f8", (2, 4, CONDITION)),  # of the rail under each wheel
        ("report", "f8", (4, 2, REPORT)),
        ("brake_torque", "f8", (4,)),
        ("stuck", "f8", (4,)),
        # of the last Jacobian, to tell when it has aged
        ("old_tangent", "f8", (4, 2)),
        ("old_secant", "f8", (4, 2)),
        ("old_slide", "f8", (4, 2)),  # of the last step
        ("old_touch", "f8", (4, 2)),
        ("old_stuck", "f8", (4,)),
        ("regaining", "f8", (4,)),  # 1: a step with its tangents would carry the wheelset through zero slip
        ("old_heading", "f8", (2,)),  # of the carbody, as x and y of its x axis
        # scratch
        ("force", "f8", (CLASSES, COORDINATES)),
        ("moment", "f8", (BODIES, 3)),
        ("probe_element", "f8", (12,)),
        ("probe_map", "f8", (12,)),
        ("probe_wheelset", "f8", (2, 7)),
        ("probe_rows", "f8", (6, 7)),
        ("offsets", "f8", (8,)),
        ("rail_frame", "f8", (4, 2, 14)),  # the track as the rail under each wheel has it; on rough rails only
    ]
)

coach_at = record_reader(COACH)
"""For compiled code: the coach whose record stands at an address."""


def coach_record(parameters: CoachParameters, contact: Contact) -> np.ndarray:
    """Array of one `COACH` record with all constants set; the elements carry the static loads of level track."""
    p = parameters
    coach = np.zeros(1, COACH)
    c = coach[0]
    wheelset = p.wheelset
    carrier = (wheelset.roll_inertia_kgm2, wheelset.box_pitch_inertia_kgm2, wheelset.yaw_inertia_kgm2)
    c["mass"] = [p.body.mass_kg] + [p.bogie.mass_kg] * 2 + [wheelset.mass_kg] * 4
    c["inertia"] = [
        (b.roll_inertia_kgm2, b.pitch_inertia_kgm2, b.yaw_inertia_kgm2) for b in (p.body, p.bogie, p.bogie)
    ] + [carrier] * 4
    c["spin_inertia"] = wheelset.spin_inertia_kgm2
    c["resistance"] = (p.resistance.a_n, p.resistance.b_nspm, p.resistance.c_ns2pm2)
    c["caliper_stiffness"] = p.caliper.stiffness_nmprad
    c["caliper_damping"] = p.caliper.damping_nmsprad
    c["contact"] = contact.constants
    c["bogie_of"] = (1, 1, 2, 2)
    c["track_brake_arm"] = p.bogie.height_m
    _curves(c, p)
    _elements(c, p, centres(p, contact))
    c["turns"] = np.any(c["rotational_stiffness"] + c["rotational_damping"] > 0.0, axis=1)
    c["pushes"] = np.any(c["stiffness"] + c["damping"] > 0.0, axis=1) | np.any(c["damper"] >= 0, axis=1)
    return coach


def masses(coach: np.void) -> np.ndarray:
    """Diagonal of the mass matrix (46,)."""
    bodies = [m for i in range(BODIES) for m in ([coach["mass"][i]] * 3 + list(coach["inertia"][i]))]
    return np.array(bodies + [coach["spin_inertia"]] * 4)


def centres(parameters: CoachParameters, contact: Contact) -> np.ndarray:
    """Centres of the seven bodies on level straight track, relative to the track below the carbody: (7, 3) m."""
    p = parameters
    bogies = [0.5 * p.bogie_distance_m, -0.5 * p.bogie_distance_m]
    wheels = [b + 0.5 * side * p.wheelbase_m for b in bogies for side in (1, -1)]
    sink = contact.radius_m - contact.rest_height_m
    rows = [(0.0, p.body.height_m)] + [(x, p.bogie.height_m) for x in bogies] + [(x, contact.radius_m) for x in wheels]
    return np.array([(x, 0.0, z - sink) for x, z in rows])


def _curves(c: np.void, p: CoachParameters) -> None:
    characteristics: list[Characteristic | None] = [
        p.primary.vertical_damper,
        p.primary.vertical_stop,
        p.secondary.vertical_damper,
        p.secondary.lateral_damper,
        p.secondary.vertical_stop,
        p.secondary.lateral_stop,
        p.yaw_dampers.damper,
    ]
    for k, curve in enumerate(characteristics):
        if curve is not None:
            c["curve_points"][k] = len(curve.x)
            c["curve_x"][k, : len(curve.x)] = curve.x
            c["curve_force"][k, : len(curve.x)] = curve.force_n
            c["curve_slope"][k, 1 : len(curve.x)] = np.diff(curve.force_n) / np.diff(curve.x)


def _elements(c: np.void, p: CoachParameters, at: np.ndarray) -> None:
    """Fill the element arrays; a point is given in its body's axes from the body's centre, `at` (7, 3)."""
    sink = at[3, 2] - 0.5 * p.wheelset.wheel_diameter_m
    k = 0

    def place(upper: int, lower: int, x: float, y: float, z: float) -> int:
        nonlocal k
        point = np.array([x, y, z + sink])
        c["upper"][k], c["lower"][k] = upper, lower
        c["upper_point"][k], c["lower_point"][k] = point - at[upper], point - at[lower]
        c["damper"][k] = c["stop"][k] = -1
        k += 1
        return k - 1

    body_share = p.body.mass_kg * GRAVITY_MPS2 / 4.0
    bogie_share = (p.body.mass_kg / 2.0 + p.bogie.mass_kg) * GRAVITY_MPS2 / 4.0
    for wheelset in range(4):
        for side in (1, -1):
            e = place(
                1 + wheelset // 2,
                3 + wheelset,
                at[3 + wheelset, 0],
                side * p.primary.half_spacing_m,
                p.primary.height_m,
            )
            c["stiffness"][e] = p.primary.stiffness_npm
            c["damping"][e] = p.primary.damping_nspm
            c["rotational_stiffness"][e] = p.primary.rotational_stiffness_nmprad
            c["rotational_damping"][e] = p.primary.rotational_damping_nmsprad
            c["preload"][e] = bogie_share
            c["damper"][e] = (-1, -1, 0)
            c["stop"][e] = (-1, -1, 1)
    for bogie in (1, 2):
        x = at[bogie, 0]
        for side in (1, -1):
            e = place(0, bogie, x, side * p.secondary.half_spacing_m, p.secondary.height_m)
            c["stiffness"][e] = p.secondary.stiffness_npm
            c["damping"][e] = p.secondary.damping_nspm
            c["rotational_stiffness"][e] = p.secondary.rotational_stiffness_nmprad
            c["rotational_damping"][e] = p.secondary.rotational_damping_nmsprad
            c["preload"][e] = body_share
            c["damper"][e] = (-1, 3 if p.secondary.lateral_damper else -1, 2)
            c["stop"][e] = (-1, 5 if p.secondary.lateral_stop else -1, 4)
            e = place(0, bogie, x, side * p.yaw_dampers.half_spacing_m, p.yaw_dampers.height_m)
            c["damper"][e] = (6, -1, -1)
        e = place(0, bogie, x, 0.0, p.traction_rod.height_m)
        c["stiffness"][e, 0] = p.traction_rod.stiffness_npm
        c["damping"][e, 0] = p.traction_rod.damping_nspm
        e = place(0, bogie, x, 0.0, p.secondary.height_m)
        c["rotational_stiffness"][e, 0] = p.anti_roll_bar_nmprad
