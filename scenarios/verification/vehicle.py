"""The coach's modes, hunting and curving against closed forms that are worked out here by themselves."""

import math
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from scenarios.scenario_file import load_scenario
from scenarios.verification.case import Case
from vehicle import CoachParameters
from vehicle.curving import CurveLoads, deficiency_speed_mps, run_in_curve
from vehicle.hunting import Hunting, growth_of, hunting_speed, largest_growth_1ps, swing_after_kick
from vehicle.linear import Linearisation, conical, kalker_contact, polach_contact
from vehicle.mode_names import BOUNCE, LATERAL
from vehicle.modes import DampedMode, damped_modes
from wheel_rail.contact_table import NODES, STIFFNESS
from wheel_rail.track_parameters import RAIL_SPACING_M

GROUP = "Modes, hunting and curving of malvezzi-2014"
CLOSED = "closed form"
SLOW_MPS = 5.0
GENTLE_CONICITY = 0.02
CURVE_RADIUS_M, CURVE_CANT_MM, UNBALANCED_MM = 2000.0, 100.0, 40.0
CURVE_CONICITY = 0.05
BALANCE_RADIUS_M, BALANCE_CONICITY = 3000.0, 0.15
CURVE_STEP_S, SWING_STEP_S = 0.005, 0.001
SWING_S, KICK_RAD = 3.0, 1e-5
BESIDE_CRITICAL = 0.1


@cache
def coach() -> CoachParameters:
    """The coach of the odometry paper."""
    return load_scenario("low-adhesion-stop", ["coach.preset=malvezzi-2014"]).coach


def with_springs(coach: CoachParameters, guidance: float, secondary: float) -> CoachParameters:
    """The coach with the horizontal stiffness of its primary and secondary stages scaled, without horizontal dampers.

    Yaw dampers, traction rods and the twist of the primary springs go with the secondary and the primary springs.
    """
    k, c, twist, twist_damping = coach.primary_at_axle
    primary = coach.primary.model_copy(
        update={
            "stiffness_npm": (guidance * k[0], guidance * k[1], k[2]),
            "damping_nspm": (0.0, 0.0, c[2]),
            "rotational_stiffness_nmprad": (guidance * twist[0], twist[1], guidance * twist[2]),
            "rotational_damping_nmsprad": tuple(twist_damping),
            "lateral_damper": None,
        }
    )
    k = np.array(coach.secondary.stiffness_npm)
    soft = {"stiffness_npm": (secondary * k[0], secondary * k[1], k[2]), "lateral_damper": None}
    rod = {"stiffness_npm": secondary * 5e6, "damping_nspm": 0.0}
    return coach.model_copy(  # unsound on purpose, which a validated coach must not be
        update={
            "axle_box": coach.axle_box.model_copy(update={"swing_arm": None}),
            "primary": primary,
            "secondary": coach.secondary.model_copy(update=soft),
            "yaw_dampers": None,
            "traction_rod": coach.traction_rod.model_copy(update=rod) if coach.traction_rod else None,
        }
    )


def _slowest_wave_m(coach: CoachParameters) -> float:
    """Length of the wave of the mode whose wheelsets move sideways most, for their mass, at low speed."""
    linear = Linearisation(coach).at(SLOW_MPS)
    sideways = [18 + 6 * i + LATERAL for i in range(4)]

    def of_wheelsets(mode: DampedMode) -> float:
        return float(np.sum(np.abs(mode.shape[sideways]) ** 2))

    mode = max(damped_modes(linear), key=of_wheelsets)
    return SLOW_MPS / mode.frequency_hz


def free_wheelsets_wave_m() -> float:
    """Of wheelsets that nothing guides below the coach: springs a millionth as stiff in the plane."""
    return _slowest_wave_m(conical(with_springs(coach(), 1e-6, 1.0), GENTLE_CONICITY))


def rigid_bogies_wave_m() -> float:
    """Of bogies that hold their wheelsets firmly (a hundred times as stiff), below a body that hardly guides them."""
    return _slowest_wave_m(conical(with_springs(coach(), 100.0, 1e-6), GENTLE_CONICITY))


def klingel_m(wheelbase_m: float = 0.0) -> float:
    """2 pi sqrt(r b/conicity (1 + C22 a^2/(C11 b^2))), b half the rail spacing, a half the wheelbase of a rigid bogie.

    Its wheelsets cannot both roll freely: lateral creep at the ends of the bogie works against longitudinal creep.
    """
    half, radius_m = 0.5 * RAIL_SPACING_M, 0.5 * coach().wheelset.wheel_diameter_m
    _, _, c11, c22, *_ = polach_contact(conical(coach(), GENTLE_CONICITY)).patch
    longer = 1.0 + c22 / c11 * (0.5 * wheelbase_m / half) ** 2
    return 2.0 * math.pi * math.sqrt(radius_m * half / GENTLE_CONICITY * longer)


@cache
def two_masses() -> tuple[complex, complex]:
    """Eigenvalues of body and bogies bouncing on the secondary and primary stage, dampers with their slope at rest."""
    p = coach()
    slopes = [
        sum(p.characteristics[name].slope_at_zero for name in stage.named(2, "damper"))
        for stage in (p.primary, p.secondary)
    ]
    stiffness, damping, *_ = p.primary_at_axle
    k1, k2 = 8.0 * stiffness[2], 4.0 * p.secondary.stiffness_npm[2]
    c1 = 8.0 * (damping[2] + slopes[0])
    c2 = 4.0 * (p.secondary.damping_nspm[2] + slopes[1])
    m1, m2 = 2.0 * p.bogie.mass_kg, p.body.mass_kg
    # determinant of the two equations of motion, by falling powers of the eigenvalue
    roots = np.roots(
        np.polysub(np.polymul([m1, c1 + c2, k1 + k2], [m2, c2, k2]), np.polymul([0.0, c2, k2], [0.0, c2, k2]))
    )
    low, high = sorted((root for root in roots if root.imag > 0.0), key=abs)
    return complex(low), complex(high)


@cache
def bounce_modes() -> tuple[DampedMode, DampedMode]:
    """Of the whole coach, body's and bogies' bounce."""
    modes = damped_modes(Linearisation(coach()).at(SLOW_MPS))
    body = max(modes, key=lambda mode: abs(mode.shape[BOUNCE]))
    bogies = max(modes, key=lambda mode: abs(mode.shape[6 + BOUNCE] + mode.shape[12 + BOUNCE]))
    return body, bogies


@dataclass(frozen=True)
class Curving:
    """What the closed form knows of a coach in a curve: the outer rail's surplus of load, and the body's roll."""

    outer_share: float
    body_roll_rad: float


def curving(p: CoachParameters, run: CurveLoads, contact_stiffness_npm: float) -> Curving:
    """Bogies and body as two masses on their springs in the track plane, wheelsets where `run` has them.

    Unknown: displacement and roll of the bogies and of the body, roll of the wheelsets; linear, so that bump stops must
    stay free. Springs bear the weight above them, which moves with the roll: the pendulum effect is in. A wheelset that
    stands aside is turned by its cones.
    """
    a, g = run.unbalanced_mps2, run.downwards_mps2
    aside = -float(run.displacement_m.mean())  # to the outside
    one, two, axle = p.primary, p.secondary, 0.5 * p.wheelset.wheel_diameter_m
    m1, m2, mw = 2.0 * p.bogie.mass_kg, p.body.mass_kg, 4.0 * p.wheelset.mass_kg
    h1, h2, hp, hs = p.bogie.height_m, p.body.height_m, one.height_m, two.height_m
    stiffness, _, twist, _ = p.primary_at_axle
    sway1, sway2 = 8.0 * stiffness[1], 4.0 * two.stiffness_npm[1]
    roll1 = 8.0 * (stiffness[2] * one.half_spacing_m**2 + twist[0])
    roll2 = 4.0 * (two.stiffness_npm[2] * two.half_spacing_m**2 + two.rotational_stiffness_nmprad[0])
    roll2 += 2.0 * p.anti_roll_bar_nmprad
    half = 0.5 * RAIL_SPACING_M
    y1, r1, y2, r2, rw, known = np.eye(6)
    # where the springs' lower ends are, how far the upper ones have gone from there, and the forces on what is above
    foot1, foot2 = aside * known + (hp - axle) * rw, y1 + (hs - h1) * r1
    force1 = -sway1 * (y1 + (hp - h1) * r1 - foot1) + (m1 + m2) * g * r1
    force2 = -sway2 * (y2 + (hs - h2) * r2 - foot2) + m2 * g * r2
    twist1, twist2 = roll1 * (r1 - rw), roll2 * (r2 - r1)
    turning_over = (m1 * h1 + m2 * h2 + mw * axle) * a * known + g * (m1 * y1 + m2 * y2 + mw * aside * known)
    balance = np.array(
        [
            force2 + m2 * a * known,
            force1 - force2 + m1 * a * known,
            force2 * (hs - h2) - m2 * g * (foot2 - y2) - twist2,
            force1 * (hp - h1)
            - force2 * (hs - h1)
            - (m1 + m2) * g * (foot1 - y1)
            + m2 * g * (foot2 - y1)
            + twist2
            - twist1,
            turning_over - 8.0 * contact_stiffness_npm * half**2 * (rw + CURVE_CONICITY * aside / half * known),
        ]
    )
    found = np.append(np.linalg.solve(balance[:, :5], -balance[:, 5]), 1.0)
    return Curving(float(turning_over @ found / half / ((m1 + m2 + mw) * g)), float(found[3]))


@cache
def curve_run(deficiency_mm: float, radius_m: float = CURVE_RADIUS_M, conicity: float = CURVE_CONICITY) -> CurveLoads:
    """On cones, whose contacts stay where they are: on profiles they move and shift the load."""
    speed_mps = deficiency_speed_mps(radius_m, CURVE_CANT_MM, deficiency_mm)
    on_cones = conical(coach(), conicity)
    return run_in_curve(on_cones, radius_m, CURVE_CANT_MM, speed_mps, step_s=CURVE_STEP_S, newton=True)


@cache
def _curving_error(deficiency_mm: float, roll: bool) -> float:
    """Run over closed form, of the outer rail's surplus or of the roll."""
    run = curve_run(deficiency_mm)
    on_cones = conical(coach(), CURVE_CONICITY)
    stiffness_npm = float(kalker_contact(on_cones).constants["table"][0, NODES // 2, STIFFNESS])
    expected = curving(on_cones, run, stiffness_npm)
    return run.body_roll_rad / expected.body_roll_rad if roll else run.outer_share / expected.outer_share


def _guiding_share(deficiency_mm: float) -> float:
    """Lateral force of all rails on all wheels over mass times unbalanced acceleration."""
    run = curve_run(deficiency_mm)
    return float(run.guiding_force_n.sum() / (coach().mass_kg * run.unbalanced_mps2))


def _balance_share() -> float:
    """Not nought: wheelsets stand aside towards the outer rail and take the weight along, more so in tighter curves."""
    run = curve_run(0.0, BALANCE_RADIUS_M, BALANCE_CONICITY)
    inner, outer = run.wheel_load_n[0::2].sum(), run.wheel_load_n[1::2].sum()
    return float(outer / inner - 1.0)


@cache
def critical() -> Hunting:
    """Of the coach on its profiles, with small swings."""
    return hunting_speed(Linearisation(coach()))


def _growth_1ps(factor: float) -> float:
    """Growth rate of a small swing in an iterated run at a share of the critical speed.

    Above, the growing swing is soon all there is. Below, hunting decays no more slowly than the body's own swings, and
    the rate found depends on the time looked at (-0.7 to -1.2 1/s at 90 %): only its sign means something.
    """
    p = coach()
    t_s, swing = swing_after_kick(
        p, factor * (critical().speed_mps or math.nan), heading_change_rad=KICK_RAD, duration_s=SWING_S,
        step_s=SWING_STEP_S, contact=kalker_contact(p), newton=True,
    )  # fmt: skip
    late = t_s > 1.0
    return growth_of(t_s[late], swing[late])


def _growth_error_1ps(factor: float) -> float:
    """The same less the largest eigenvalue."""
    speed_mps = factor * (critical().speed_mps or math.nan)
    return _growth_1ps(factor) - largest_growth_1ps(Linearisation(coach()), speed_mps)


def damping(rate: complex) -> float:
    """Share of the critical damping."""
    return -rate.real / abs(rate)


CASES = (
    *(
        case
        for k, what in ((0, "carbody"), (1, "bogies"))
        for case in (
            Case(
                f"vehicle-bounce-{what}", GROUP, f"bounce of the {what}, damped: two masses on two stages", CLOSED,
                two_masses()[k].imag / (2.0 * math.pi), "Hz", partial(lambda k: bounce_modes()[k].frequency_hz, k),
                0.01, relative=True,
            ),
            Case(
                f"vehicle-damping-{what}", GROUP, f"damping ratio of the bounce of the {what}: two masses", CLOSED,
                damping(two_masses()[k]), "-", partial(lambda k: bounce_modes()[k].damping_ratio, k), 0.02,
                relative=True,
            ),
        )
    ),
    Case(
        "vehicle-klingel", GROUP, "wave of the coach's wheelsets on cones when nothing guides them, 5 m/s",
        "Klingel 1883, closed form", klingel_m(), "m", free_wheelsets_wave_m, 0.01, relative=True,
    ),
    Case(
        "vehicle-klingel-bogie", GROUP, "wave of rigid bogies on cones: sqrt(1 + C22/C11 (a/b)²) longer", CLOSED,
        klingel_m(coach().wheelbase_m), "m", rigid_bogies_wave_m, 0.02, relative=True,
    ),
    Case(
        "vehicle-balance", GROUP, "outer over inner rail's load at balance speed, 3000 m, cant 100 mm, less 1", CLOSED,
        0.0, "-", _balance_share, 0.01,
    ),
    *(
        case
        for deficiency_mm in (UNBALANCED_MM, -UNBALANCED_MM)
        for case in (
            Case(
                f"vehicle-curve-load{deficiency_mm:+g}", GROUP,
                f"surplus of the outer rail's load at {deficiency_mm:g} mm cant deficiency, over that of two masses",
                CLOSED, 1.0, "-", partial(_curving_error, deficiency_mm, False), 0.03,
            ),
            Case(
                f"vehicle-curve-roll{deficiency_mm:+g}", GROUP,
                f"roll of the carbody at {deficiency_mm:g} mm cant deficiency, over that of two masses",
                CLOSED, 1.0, "-", partial(_curving_error, deficiency_mm, True), 0.03,
            ),
            Case(
                f"vehicle-curve-guiding{deficiency_mm:+g}", GROUP,
                f"lateral forces of all wheels at {deficiency_mm:g} mm, over mass times acceleration",
                CLOSED, 1.0, "-", partial(_guiding_share, deficiency_mm), 0.01,
            ),
        )
    ),
    Case(
        "vehicle-hunting-below", GROUP, "growth of a small swing in a run at 90 % of the critical speed: it decays",
        "eigenvalue of the linearised coach", (-5.0, 0.0), "1/s", partial(_growth_1ps, 1.0 - BESIDE_CRITICAL),
    ),
    Case(
        "vehicle-hunting-above", GROUP,
        "growth of a small swing in a run at 110 % of the critical speed, less its eigenvalue's",
        "eigenvalue of the linearised coach", 0.0, "1/s", partial(_growth_error_1ps, 1.0 + BESIDE_CRITICAL), 0.1,
    ),
)  # fmt: skip
