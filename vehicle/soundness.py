"""What makes a coach unfit to run though every number by itself is allowed, as `key = value: reason`."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from vehicle.loads import EMPTY

if TYPE_CHECKING:
    from vehicle.parameters import CoachParameters

_LEAST_DAMPING_NSPM = 1.0
_UNDAMPED = {
    ("primary", 1): "the lateral swaying of wheelsets against bogies",
    ("primary", 2): "bounce and pitch of the bogies",
    ("secondary", 1): "sway and yaw of the body",
    ("secondary", 2): "bounce and pitch of the body",
}


def first_fault(coach: "CoachParameters") -> str | None:
    """The first reason why these parameters make no coach, None if there is none."""
    faults = (_dimensions, _characteristics, _axle_boxes, _wheels, _loads, _damping)
    return next((found for check in faults for found in check(coach)), None)


def _dimensions(coach: "CoachParameters") -> Iterator[str]:
    diameter_m = coach.wheelset.wheel_diameter_m
    if coach.wheelbase_m <= diameter_m:
        yield f"wheelbase_m = {coach.wheelbase_m}: must exceed wheelset.wheel_diameter_m"
    if coach.bogie_distance_m <= coach.wheelbase_m + diameter_m:
        yield f"bogie_distance_m = {coach.bogie_distance_m}: the bogies overlap"
    if coach.secondary.stiffness_npm[0] == 0.0 and not (coach.traction_rod and coach.traction_rod.stiffness_npm):
        yield (
            "traction_rod.stiffness_npm: is missing or 0, and so is the longitudinal secondary.stiffness_npm: "
            "nothing would pull the bogies along"
        )


def _references(coach: "CoachParameters") -> Iterator[tuple[str, str, bool]]:
    """Key, name of the characteristic, and whether it must be one over speed."""
    for stage_name, stage in (("primary", coach.primary), ("secondary", coach.secondary)):
        for key, name in stage:
            if isinstance(name, str):
                yield f"{stage_name}.{key}", name, key.endswith(("_damper", "_friction"))
    if coach.yaw_dampers is not None:
        yield "yaw_dampers.damper", coach.yaw_dampers.damper, True
    if coach.lateral_stop is not None:
        yield "lateral_stop.stop", coach.lateral_stop.stop, False
    if coach.traction_rod is not None:
        for key in ("spring", "damper"):
            name = getattr(coach.traction_rod, key)
            if name is not None:
                yield f"traction_rod.{key}", name, key == "damper"


def _characteristics(coach: "CoachParameters") -> Iterator[str]:
    for key, name, over_speed in _references(coach):
        found = coach.characteristics.get(name)
        if found is None:
            known = ", ".join(coach.characteristics) or "none"
            yield f"{key} = {name!r}: no such characteristic; there are {known}"
        elif (found.speed_mps is not None) != over_speed:
            yield f"{key} = {name!r}: must be a characteristic over {'speed_mps' if over_speed else 'deflection_m'}"


def _axle_boxes(coach: "CoachParameters") -> Iterator[str]:
    box, wheelset = coach.axle_box, coach.wheelset
    if 2.0 * box.mass_kg >= wheelset.mass_kg:
        yield (
            f"axle_box.mass_kg = {box.mass_kg}: two boxes weigh as much as wheelset.mass_kg = {wheelset.mass_kg}, "
            "which holds them"
        )
    offset = box.mass_kg * coach.primary.half_spacing_m**2
    for axis in ("roll", "yaw"):
        key = f"{axis}_inertia_kgm2"
        boxes, total = 2.0 * (getattr(box, key) + offset), getattr(wheelset, key)
        if boxes >= total:
            yield (
                f"axle_box.{key} = {getattr(box, key)}: two boxes at +-{coach.primary.half_spacing_m} m "
                f"have {boxes:.4g}, as much as wheelset.{key} = {total}, which holds them"
            )
    arm = box.swing_arm
    if arm is not None and arm.length_m >= 0.5 * coach.wheelbase_m:
        yield f"axle_box.swing_arm.length_m = {arm.length_m}: must be below half of wheelbase_m = {coach.wheelbase_m}"
    if coach.axle_boxes == "explicit" and box.bearing is None:
        yield "axle_box.bearing: is missing, which explicit axle boxes need"
    held = coach.primary.rotational_stiffness_nmprad[1] if arm is None else arm.stiffness_npm[2]
    damped = coach.primary.rotational_damping_nmsprad[1] if arm is None else arm.damping_nspm[2]
    if held == 0.0 or damped == 0.0:
        key = f"rotational_{'stiffness_nmprad' if held == 0.0 else 'damping_nmsprad'}"
        given = f"primary.{key} = {list(getattr(coach.primary, key))}: nothing about y"
        if arm is not None:
            given = f"axle_box.swing_arm.damping_nspm = {list(arm.damping_nspm)}: nothing along z"
        yield f"{given}: the pitch of the axle boxes would not be {'held' if held == 0.0 else 'damped'}"


def _wheels(coach: "CoachParameters") -> Iterator[str]:
    found = coach.wheels.fault(coach.wheelset.wheel_diameter_m)
    if found is not None:
        yield f"wheels.{found}"


def _loads(coach: "CoachParameters") -> Iterator[str]:
    if EMPTY in coach.loads:
        yield f"loads.{EMPTY}: every coach has this load without a payload"
    for name, payload in coach.loads.items():
        found = payload.fault(coach.saloon)
        if found is not None:
            yield f"loads.{name}.{found}"
    if coach.load != EMPTY and coach.load not in coach.loads:
        yield f"load = {coach.load!r}: no such load; there are {', '.join([EMPTY, *coach.loads])}"


def _damping(coach: "CoachParameters") -> Iterator[str]:
    """Small motions must die away: a damper with play, or none, lets its mode grow."""
    for (stage_name, axis), mode in _UNDAMPED.items():
        stage = coach.primary if stage_name == "primary" else coach.secondary
        total = stage.damping_nspm[axis]
        total += sum(coach.characteristics[name].slope_at_zero for name in stage.named(axis, "damper", "friction"))
        arm = coach.axle_box.swing_arm
        if stage_name == "primary" and arm is not None:
            if axis < 2:
                total += arm.damping_nspm[axis]
            else:
                total += arm.rotational_damping_nmsprad[1] / arm.length_m**2
        if total < _LEAST_DAMPING_NSPM:
            yield (
                f"{stage_name}.damping_nspm = {list(stage.damping_nspm)}: nothing damps the "
                f"{('longitudinal', 'lateral', 'vertical')[axis]} axis, no damper either: {mode} would not be damped"
            )
