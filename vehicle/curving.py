"""The coach at constant speed in a long canted curve: wheel loads and curving forces when all swings are over."""

import math
from dataclasses import dataclass

import numpy as np

from vehicle.coach import Coach
from vehicle.forces import CONTACT_NORMAL, CREEP
from vehicle.interface import Actuation, CoachState
from vehicle.layout import BODY_FRAME, SPIN
from vehicle.linear import clean_rail, polach_contact, without_resistance
from vehicle.observation import OBSERVATION
from vehicle.parameters import GRAVITY_MPS2, CoachParameters
from wheel_rail import Track, TrackParameters
from wheel_rail.contact import ALONG, LATERAL, LONGITUDINAL, NORMAL, REPORT, UPWARDS
from wheel_rail.track_parameters import RAIL_SPACING_M

_STRAIGHT_M, _TRANSITION_M = 60.0, 150.0
_HOLDS_1PS = 2.0  # how firmly the speed is held
_FIRST_WHEELSET = SPIN - 4 * 6


@dataclass(frozen=True)
class CurveLoads:
    """Means over the last seconds in a left-hand curve, in the canted track plane; wheels 1L 1R 2L ... (8,).

    `wheel_load_n`: normal to the plane; `lateral_force_n` (to the left) and `longitudinal_force_n`: all forces of the
    rail on the wheel but the flange's stop; `guiding_force_n` (4,): lateral on each wheelset, the stop included.
    `body_roll_rad`: of the carbody against the track plane, positive to the outside (right); `displacement_m` (4,):
    of the wheelsets to the left; `unbalanced_mps2`: lateral acceleration in the plane, towards the outside when
    positive; `downwards_mps2`: normal to it.
    """

    speed_mps: float
    unbalanced_mps2: float
    downwards_mps2: float
    wheel_load_n: np.ndarray
    lateral_force_n: np.ndarray
    longitudinal_force_n: np.ndarray
    guiding_force_n: np.ndarray
    body_roll_rad: float
    displacement_m: np.ndarray

    @property
    def outer_share(self) -> float:
        """Share of the outer rail in the load, less that of the inner: 0 at balance speed, 1 when it turns over."""
        inner, outer = self.wheel_load_n[0::2].sum(), self.wheel_load_n[1::2].sum()
        return float((outer - inner) / (outer + inner))


def balance_speed_mps(radius_m: float, cant_mm: float) -> float:
    """The speed at which nothing is felt in the track plane: v^2/R = g tan(cant angle)."""
    return math.sqrt(GRAVITY_MPS2 * radius_m * math.tan(_cant_angle(cant_mm)))


def deficiency_speed_mps(radius_m: float, cant_mm: float, deficiency_mm: float) -> float:
    """The speed whose balance would want `deficiency_mm` more of cant."""
    return balance_speed_mps(radius_m, cant_mm + deficiency_mm)


def run_in_curve(
    parameters: CoachParameters,
    radius_m: float,
    cant_mm: float,
    speed_mps: float,
    *,
    settles_s: float = 12.0,
    averaged_s: float = 4.0,
    step_s: float = 0.005,
    newton: bool = False,
) -> CurveLoads:
    """Run the coach, driven as much as constant speed takes, on a clean rail; it meets no running resistance."""
    still = without_resistance(parameters)
    contact = polach_contact(still)
    start_m = _STRAIGHT_M
    length_m = speed_mps * (settles_s + averaged_s) + _STRAIGHT_M
    curve = {
        "start_m": start_m,
        "transition_m": _TRANSITION_M,
        "length_m": length_m,
        "radius_m": radius_m,
        "cant_mm": cant_mm,
    }
    line = {"length_m": start_m + length_m + 3.0 * _TRANSITION_M, "curves": [curve]}
    track = Track(TrackParameters.model_validate(line))
    rail = clean_rail(track.length_m, contact)
    row = np.zeros(1, OBSERVATION)
    actuation = Actuation()
    sums = _Sums()
    firmness = _HOLDS_1PS * still.effective_mass_kg * contact.radius_m / 4.0
    settled_s = _TRANSITION_M / speed_mps + settles_s

    def on_step(t_s: float, state: CoachState) -> Actuation | None:
        actuation.drive_torque_nm[:] = firmness * (speed_mps - state.speed_mps)
        if t_s >= settled_s:
            state.observe(t_s, row, 0)
            sums.add(row[0], state.observed)
        return actuation

    begin_m = start_m - 0.5 * still.bogie_distance_m - still.wheelbase_m
    Coach(still, contact, track, rail).run(step_s, settled_s + averaged_s, begin_m, speed_mps, on_step, step_s, newton)
    mean = sums.mean()
    angle = _cant_angle(cant_mm)
    speed = float(mean.pop("speed")[0])
    outwards = speed**2 / radius_m
    return CurveLoads(
        speed_mps=speed,
        unbalanced_mps2=outwards * math.cos(angle) - GRAVITY_MPS2 * math.sin(angle),
        downwards_mps2=outwards * math.sin(angle) + GRAVITY_MPS2 * math.cos(angle),
        body_roll_rad=float(mean.pop("body_roll")[0]),
        **{f"{name}_m" if name == "displacement" else f"{name}_n": value for name, value in mean.items()},
    )


class _Sums:
    """Running sums of what is averaged."""

    def __init__(self) -> None:
        self._count = 0
        self._sums: dict[str, np.ndarray] = {}

    def add(self, row: np.void, coach: np.void) -> None:
        self._count += 1
        for name, value in _instant(row, coach).items():
            self._sums[name] = self._sums.get(name, 0.0) + value

    def mean(self) -> dict[str, np.ndarray]:
        return {name: total / self._count for name, total in self._sums.items()}


def _instant(row: np.void, coach: np.void) -> dict[str, np.ndarray]:
    report = coach["report"].T.reshape(4, 2, REPORT)
    along, normal = report[..., ALONG : ALONG + 3], report[..., UPWARDS : UPWARDS + 3]
    across = np.cross(normal, along)
    force = (
        report[..., NORMAL, None] * normal
        + report[..., LONGITUDINAL, None] * along
        + report[..., LATERAL, None] * across
    )
    axes = coach["frame"][3:12, :4].T.reshape(4, 3, 3)  # tangent, left, up at each wheelset
    forwards, left, up = np.einsum("ijk,isk->jis", axes, force)
    on_wheelset = (coach["force"][CONTACT_NORMAL] + coach["force"][CREEP])[_FIRST_WHEELSET:SPIN].reshape(4, 6)[:, :3]
    body, track = coach["rotation"][:, :, 0], coach["frame"][3:12, BODY_FRAME].reshape(3, 3)
    return {
        "speed": np.array([row["speed_mps"]]),
        "wheel_load": up.ravel(),
        "lateral_force": left.ravel(),
        "longitudinal_force": forwards.ravel(),
        "guiding_force": np.einsum("ij,ij->i", axes[:, 1], on_wheelset),
        # positive turn about the forward axis lifts the left side: to the right, the outside
        "body_roll": np.array([math.asin(float(body[:, 1] @ track[2]))]),
        "displacement": row["lateral_displacement_m"].copy(),
    }


def _cant_angle(cant_mm: float) -> float:
    return math.asin(cant_mm / 1000.0 / RAIL_SPACING_M)
