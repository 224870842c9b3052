"""The brake: times of valves and cylinder, air, deceleration of the coach, and how fast a wheelset locks."""

import tomllib
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np

from scenarios.units import KMH_PER_MPS
from scenarios.verification.adhesion import LOAD_N, SHEAR_PA, conical_contact
from scenarios.verification.case import Case
from vehicle import GRAVITY_MPS2
from wheel_rail.compiled import Array, Record, Vector, compiled
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.recovery import CONDITION, DEGRADED, RECOVERED, adhesive_force
from wsp import BRAKE_PRESETS, FILL, HOLD, VENT, Brake, BrakeParameters
from wsp.brake import advance_brake

SECOND_HAND = "second hand (M)"
PUBLIC_DESIGN = "public design of the LHB class"
CLASS_MASS_KG, CLASS_PRESSURE_BAR = 52_000.0, 3.0
WHEEL_RADIUS_M, WHEELSET_INERTIA_KGM2 = 0.46, 110.0
LOCKING_SPEED_MPS = 120.0 / KMH_PER_MPS
_STEP_S = 0.0005
_STILL = np.zeros(4)
# 2.5 l that do not grow: what the published times belong to
_FIXED_VOLUME = {"cylinder_volume_dm3": 2.5, "clearance_volume_dm3": 0.0, "elastic_volume_dm3pbar": 0.0}
# and what the published decelerations know nothing of
_PLAIN_DISCS = {"return_spring_pressure_bar": 0.0, "clearance_volume_dm3": 0.0, "friction_curve": {}, "heat": None}


@cache
def _preset() -> dict[str, Any]:
    return tomllib.loads(BRAKE_PRESETS["lhb-discs-56t"].read_text(encoding="utf-8"))


def _parameters(**changes: Any) -> BrakeParameters:
    return BrakeParameters.model_validate(_preset() | {"leakage_dm3psbar": 0.0} | changes)


def _codes(code: int) -> np.ndarray:
    return np.full(4, code, np.int8)


def _applied(parameters: BrakeParameters, step_s: float = _STEP_S) -> Brake:
    """A brake that has come to rest at full service, wheels still."""
    brake = Brake(parameters, step_s)
    for _ in range(round((parameters.application_time_s + 1.0) / step_s)):
        brake.step(1.0, _codes(FILL), _STILL, 0.0)
    return brake


def _time_s(brake: Brake, code: int, pressure_bar: float) -> float:
    """Until the cylinders of a commanded brake pass a pressure, within 5 s; nan if they do not."""
    start_bar = brake.cylinder_pressure_bar[0]
    for step in range(1, round(5.0 / brake.step_s)):
        brake.step(1.0, _codes(code), _STILL, 0.0)
        if (brake.cylinder_pressure_bar[0] - pressure_bar) * (start_bar - pressure_bar) <= 0.0:
            return step * brake.step_s
    return float("nan")


def _vent_s(down_to_bar: float, **volume: float) -> float:
    brake = _applied(_parameters(full_service_pressure_bar=3.8, valve_dead_time_s=0.0, **volume))
    return _time_s(brake, VENT, down_to_bar)


def _fill_s(from_bar: float, to_bar: float, supply_bar: float = 3.8, **volume: float) -> float:
    # the feed is well above, so that the source does not fall while the cylinders draw
    pressures = {"full_service_pressure_bar": supply_bar, "feed_pressure_bar": supply_bar + 2.0}
    brake = _applied(_parameters(valve_dead_time_s=0.0, **pressures, **volume))
    if from_bar > 0.0:
        _time_s(brake, VENT, from_bar)
    else:
        for _ in range(round(3.0 / _STEP_S)):
            brake.step(1.0, _codes(VENT), _STILL, 0.0)
    for _ in range(round(0.1 / _STEP_S)):  # shut, so that the filling starts from still valves
        brake.step(1.0, _codes(HOLD), _STILL, 0.0)
    return _time_s(brake, FILL, to_bar)


def _application_s() -> float:
    """Distributor from 0 to 3.6 bar."""
    brake = Brake(_parameters(full_service_pressure_bar=3.6), _STEP_S)
    step = 0
    while brake.distributor_pressure_bar < 3.6 - 1e-9 and step * _STEP_S < 60.0:
        brake.step(1.0, _codes(FILL), _STILL, 0.0)
        step += 1
    return step * _STEP_S


def _release_s() -> float:
    """Cylinders from 3.8 to 0.4 bar through the distributor."""
    brake = _applied(_parameters(full_service_pressure_bar=3.8), 0.005)
    step = 0
    while brake.cylinder_pressure_bar[0] > 0.4 and step * 0.005 < 60.0:
        brake.step(0.0, _codes(FILL), _STILL, 0.0)
        step += 1
    return step * 0.005


def _cycle(brake: Brake) -> None:
    """Vent and refill the first axle, 3 s each; the others hold what they have."""
    for code in (VENT, FILL):
        valve = np.array([code, HOLD, HOLD, HOLD], np.int8)
        for _ in range(round(3.0 / brake.step_s)):
            brake.step(1.0, valve, _STILL, 0.0)


def _cycle_nl(**volume: float) -> float:
    brake = _applied(_parameters(full_service_pressure_bar=3.8, **volume))
    before_nl = brake.air_nl
    _cycle(brake)
    return brake.air_nl - before_nl


def _cycles_of_the_reservoir() -> float:
    """How many times 125 l without resupply refill the axle while they fall from 6 to 4 bar."""
    charged_quickly = {"feed_conductance_dm3psbar": 100.0}  # so that it is full when the feed pipe is lost
    brake = _applied(_parameters(full_service_pressure_bar=3.8, **charged_quickly, **_FIXED_VOLUME), 0.005)
    brake.fail_supply(6.0)
    reservoir_bar = [float(brake.record["reservoir_bar"][0])]
    while reservoir_bar[-1] > 4.0 and len(reservoir_bar) < 100:
        _cycle(brake)
        reservoir_bar.append(float(brake.record["reservoir_bar"][0]))
    return float(np.interp(-4.0, -np.array(reservoir_bar), np.arange(len(reservoir_bar), dtype=float)))


def _coach_force_n(**changes: Any) -> float:
    """Brake force at the treads of all four axles at full service."""
    return float(_applied(_parameters(**changes), 0.005).record["torque_nm"].sum()) / WHEEL_RADIUS_M


def _class_deceleration_mps2() -> float:
    rotating_kg = 4.0 * WHEELSET_INERTIA_KGM2 / WHEEL_RADIUS_M**2
    force_n = _coach_force_n(full_service_pressure_bar=CLASS_PRESSURE_BAR, **_PLAIN_DISCS)
    return force_n / (CLASS_MASS_KG + rotating_kg)


def _class_adhesion() -> float:
    force_n = _coach_force_n(full_service_pressure_bar=CLASS_PRESSURE_BAR, **_PLAIN_DISCS)
    return force_n / (CLASS_MASS_KG * GRAVITY_MPS2)


def _locking_mps2(adhesion: float) -> float:
    """Mean rim deceleration of a wheelset from 10 to 90 % slip, under a train that keeps its 120 km/h."""
    brake = _applied(_parameters(full_service_pressure_bar=CLASS_PRESSURE_BAR, **_PLAIN_DISCS), 0.001)
    law = CREEP_LAWS["polach"].in_force()
    # friction that does not fall with the slip speed, all of it used when the contact slides
    condition = np.zeros(CONDITION)
    condition[DEGRADED:RECOVERED] = adhesion, 1.0, 0.0, 1.0, 1.0
    load_n = CLASS_MASS_KG * GRAVITY_MPS2 / 8.0
    grown = np.cbrt(load_n / LOAD_N)
    a, b, *shape = conical_contact().patch
    patch = (a * grown, b * grown, *shape)
    in_force = (law.number, law.address)
    return float(_spin_down_mps2(brake.record, in_force, law.extra, LOCKING_SPEED_MPS, load_n, patch, condition))


@compiled
def _spin_down_mps2(
    brake: Record, law: tuple[int, int], extra: Array, speed_mps: float, load_n: float, patch: Vector, condition: Array
) -> float:
    step_s = 0.001
    fill = np.zeros(4, np.int8)
    rim_mps = 0.99 * speed_mps
    began_s = ended_s = -1.0
    for k in range(20_000):
        if began_s < 0.0 and rim_mps <= 0.9 * speed_mps:
            began_s = k * step_s
        if rim_mps <= 0.1 * speed_mps:
            ended_s = k * step_s
            break
        rate = np.full(4, rim_mps / WHEEL_RADIUS_M)
        advance_brake(brake[0], 1.0, fill, rate, speed_mps)
        # the wheel falls behind the rail: the rail drives it on
        creep = (speed_mps - rim_mps) / speed_mps
        force_n, _, _, _ = adhesive_force(
            law[0], law[1], extra, creep, 0.0, 0.0, speed_mps - rim_mps, speed_mps, load_n, patch, condition, SHEAR_PA
        )
        torque_nm = 2.0 * abs(force_n) * WHEEL_RADIUS_M - brake[0].torque_nm[0]
        rim_mps += torque_nm / WHEELSET_INERTIA_KGM2 * WHEEL_RADIUS_M * step_s
    return 0.8 * speed_mps / (ended_s - began_s)


def _both_volumes(
    id: str, quantity: str, expected: float, unit: str, obtain: Callable[..., float]
) -> tuple[Case, Case]:
    """A figure of valves and cylinder at the fixed volume that it was published for, and with the preset's stroke."""
    group = "Valves and cylinder"
    return (
        Case(f"{id}-fixed", group, f"{quantity}, 2.5 l", SECOND_HAND, expected, unit,
             partial(obtain, **_FIXED_VOLUME), 0.10, relative=True),
        Case(f"{id}-stroke", group, f"{quantity}, volume growing with the stroke", SECOND_HAND, expected, unit,
             obtain, 0.10, relative=True),
    )  # fmt: skip


CASES = (
    *_both_volumes("vent-0.4", "vent 3.8 to 0.4 bar", 0.40, "s", partial(_vent_s, 0.4)),
    *_both_volumes("vent-1.9", "vent 3.8 to 1.9 bar", 0.16, "s", partial(_vent_s, 1.9)),
    *_both_volumes("fill-1.9", "fill 0.4 to 1.9 bar", 0.16, "s", partial(_fill_s, 0.4, 1.9)),
    *_both_volumes("fill-3.6", "fill 0 to 3.6 bar", 0.47, "s", partial(_fill_s, 0.0, 3.6)),
    *_both_volumes("fill-6", "fill 0 to 3.6 bar from 6 bar", 0.27, "s", partial(_fill_s, 0.0, 3.6, 6.0)),
    *_both_volumes("cycle-air", "air of a full vent and refill at 3.8 bar", 9.4, "nl", _cycle_nl),
    Case(
        "reservoir-cycles", "Valves and cylinder", "such cycles from 125 l, 6 to 4 bar, no resupply, 2.5 l",
        SECOND_HAND, 27.0, "-", _cycles_of_the_reservoir, 0.10, relative=True,
    ),
    Case(
        "distributor-application", "Valves and cylinder", "distributor 0 to 3.6 bar", PUBLIC_DESIGN, (3.0, 5.0), "s",
        _application_s,
    ),
    Case(
        "distributor-release", "Valves and cylinder", "release 3.8 to 0.4 bar", PUBLIC_DESIGN, (15.0, 20.0), "s",
        _release_s,
    ),
    Case(
        "brake-deceleration", "Brake of a coach", "deceleration, 52 t at 3.0 bar, pad friction 0.35", PUBLIC_DESIGN,
        0.90, "m/s2", _class_deceleration_mps2, 0.03, relative=True,
    ),
    Case(
        "brake-adhesion", "Brake of a coach", "adhesion that it needs", PUBLIC_DESIGN, 0.096, "-", _class_adhesion,
        0.03, relative=True,
    ),
    *(
        Case(
            f"locking-{adhesion}", "Brake of a coach",
            f"rim deceleration of a wheelset that locks on adhesion {adhesion}, 52 t at 3.0 bar, 120 km/h",
            SECOND_HAND, expected, "m/s2", partial(_locking_mps2, adhesion), 0.05, relative=True,
        )
        for adhesion, expected in ((0.03, 16.5), (0.08, 4.4))
    ),
)  # fmt: skip
