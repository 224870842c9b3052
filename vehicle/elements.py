"""The elements between the bodies of a coach: springs, dampers, stops, links, bearings, as rows of arrays.

An element joins an upper and a lower body; along each axis it has a linear spring and damper, and up to one curve over
deflection (springs and stops summed) and one over speed (dampers and friction summed), so that a coach with more
characteristics costs no more than one with fewer. With axle boxes lumped, its elements are 8 primary and 4 secondary
springs, and as the coach has them 4 yaw dampers, 2 traction rods, 2 anti-roll bars with or without a lateral stop;
explicit boxes add 8 swing arms and 8 bearings.
"""

from collections.abc import Sequence

import numpy as np

from vehicle.axle_boxes import AxleBox, lumped_stage
from vehicle.characteristics import MOST_POINTS, summed
from vehicle.parameters import GRAVITY_MPS2, CoachParameters, Stage

ELEMENTS = 36
CURVES = 16
CURVE_POINTS = 2 * MOST_POINTS
RUBBING = 36  # springs with dry friction, times their axes

_FIRST_WHEELSET, _FIRST_BOX = 3, 7


def fill_elements(c: np.void, p: CoachParameters, at: np.ndarray) -> None:
    """Set the elements of a coach record, whose bodies stand at `at` (bodies, 3)."""
    elements = _Elements(c, p, at)
    body_share = p.laden_body.mass_kg * GRAVITY_MPS2 / 4.0
    bogie_share = (p.laden_body.mass_kg / 2.0 + p.bogie.mass_kg) * GRAVITY_MPS2 / 4.0
    for wheelset in range(4):
        for side in (1, -1):
            elements.add_primary(wheelset, side, bogie_share)
    for bogie in (1, 2):
        x = at[bogie, 0]
        for side in (1, -1):
            e = elements.place(0, bogie, x, side * p.secondary.half_spacing_m, p.secondary.height_m)
            elements.make_stage(e, p.secondary, body_share)
            if p.yaw_dampers is not None:
                e = elements.place(0, bogie, x, side * p.yaw_dampers.half_spacing_m, p.yaw_dampers.height_m)
                c["damper"][e, 0] = elements.curve([p.yaw_dampers.damper])
        if p.traction_rod is not None:
            e = elements.place(0, bogie, x, 0.0, p.traction_rod.height_m)
            c["stiffness"][e, 0] = p.traction_rod.stiffness_npm
            c["damping"][e, 0] = p.traction_rod.damping_nspm
            c["stop"][e, 0] = elements.curve([p.traction_rod.spring])
            c["damper"][e, 0] = elements.curve([p.traction_rod.damper])
        if p.anti_roll_bar_nmprad > 0.0 or p.lateral_stop is not None:
            # the bar has no place of its own: what it turns against is the same everywhere
            height_m = p.secondary.height_m if p.lateral_stop is None else p.lateral_stop.height_m
            e = elements.place(0, bogie, x, 0.0, height_m)
            c["rotational_stiffness"][e, 0] = p.anti_roll_bar_nmprad
            if p.lateral_stop is not None:
                c["stop"][e, 1] = elements.curve([p.lateral_stop.stop])
    if p.axle_boxes == "explicit":
        for wheelset in range(4):
            for side in (1, -1):
                elements.add_arm_and_bearing(wheelset, side, bogie_share)
    _turn_once(c)
    c["turns"] = np.any(c["rotational_stiffness"] + c["rotational_damping"] > 0.0, axis=1)
    springs = np.any(c["stiffness"] + c["damping"] > 0.0, axis=1)
    c["pushes"] = springs | np.any(c["damper"] >= 0, axis=1) | np.any(c["stop"] >= 0, axis=1)


def _turn_once(c: np.void) -> None:
    """Let the first of the springs between two bodies have what all of them resist to turning: it knows no place."""
    first: dict[tuple[int, int], int] = {}
    for e in range(int(c["elements"])):
        if not np.any(c["stiffness"][e] + c["damping"][e] > 0.0):
            continue
        k = first.setdefault((int(c["upper"][e]), int(c["lower"][e])), e)
        for name in ("rotational_stiffness", "rotational_damping") if k != e else ():
            c[name][k] += c[name][e]
            c[name][e] = 0.0


class _Elements:
    """The element arrays of one record while they are filled."""

    def __init__(self, c: np.void, p: CoachParameters, at: np.ndarray) -> None:
        self._c, self._p, self._at = c, p, at
        self._sink = at[_FIRST_WHEELSET, 2] - 0.5 * p.wheelset.wheel_diameter_m
        self._curves: dict[tuple[str, ...], int] = {}
        c["elements"] = c["rubbing_count"] = 0
        c["damper"] = c["stop"] = -1

    def place(self, upper: int, lower: int, x: float, y: float, z: float) -> int:
        """A new element at a point; its number. Points are kept in the bodies' axes from their centres."""
        c, at = self._c, self._at
        e = int(c["elements"])
        c["elements"] = e + 1
        point = np.array([x, y, z + self._sink])
        c["upper"][e], c["lower"][e] = upper, lower
        c["upper_point"][e], c["lower_point"][e] = point - at[upper], point - at[lower]
        return e

    def curve(self, names: Sequence[str | None]) -> int:
        """Number of the curve that is the sum of these characteristics, -1 without any."""
        given = tuple(name for name in names if name is not None)
        if not given:
            return -1
        if given not in self._curves:
            k = self._curves[given] = len(self._curves)
            c = self._c
            for side, (x, force) in enumerate(summed([self._p.characteristics[name] for name in given])):
                n = len(x)
                c["curve_points"][k, side] = n
                c["curve_x"][k, side, :n] = x
                c["curve_force"][k, side, :n] = force
                c["curve_slope"][k, side, 1:n] = np.diff(force) / np.diff(x)
        return self._curves[given]

    def make_stage(self, e: int, stage: Stage, preload_n: float, box: AxleBox | None = None) -> None:
        """Let element `e` be a spring of the stage, lumped with the swing arm of `box` if there is one."""
        c = self._c
        linear = (
            stage.stiffness_npm, stage.damping_nspm, stage.rotational_stiffness_nmprad, stage.rotational_damping_nmsprad
        )  # fmt: skip
        c["stiffness"][e], c["damping"][e], c["rotational_stiffness"][e], c["rotational_damping"][e] = (
            linear if box is None else lumped_stage(box, *linear)
        )
        c["preload"][e] = preload_n
        for axis in range(3):
            c["stop"][e, axis] = self.curve(stage.named(axis, "spring", "stop"))
            c["damper"][e, axis] = self.curve(stage.named(axis, "damper", "friction"))
            if stage.named(axis, "friction"):
                c["rubbing"][c["rubbing_count"]] = e, axis
                c["rubbing_count"] += 1

    def add_primary(self, wheelset: int, side: int, preload_n: float) -> None:
        """The coil spring over an axle box, with the swing arm in it where boxes are lumped."""
        p = self._p
        explicit = p.axle_boxes == "explicit"
        lower = _FIRST_BOX + 2 * wheelset + (side < 0) if explicit else _FIRST_WHEELSET + wheelset
        x = self._at[_FIRST_WHEELSET + wheelset, 0]
        e = self.place(1 + wheelset // 2, lower, x, side * p.primary.half_spacing_m, p.primary.height_m)
        self.make_stage(e, p.primary, preload_n, None if explicit else p.axle_box)

    def add_arm_and_bearing(self, wheelset: int, side: int, preload_n: float) -> None:
        """What joins an explicit axle box to its bogie beside the spring, and to its wheelset."""
        c, p = self._c, self._p
        box, body = p.axle_box, _FIRST_BOX + 2 * wheelset + (side < 0)
        x, y, z = (
            self._at[_FIRST_WHEELSET + wheelset, 0],
            side * p.primary.half_spacing_m,
            0.5 * p.wheelset.wheel_diameter_m,
        )
        arm = box.swing_arm
        if arm is not None:
            inwards = -arm.length_m if wheelset % 2 == 0 else arm.length_m
            e = self.place(1 + wheelset // 2, body, x + inwards, y, z)
            c["stiffness"][e], c["damping"][e] = arm.stiffness_npm, arm.damping_nspm
            c["rotational_stiffness"][e] = arm.rotational_stiffness_nmprad
            c["rotational_damping"][e] = arm.rotational_damping_nmsprad
        bearing = box.bearing
        if bearing is not None:
            e = self.place(body, _FIRST_WHEELSET + wheelset, x, y, z)
            c["stiffness"][e], c["damping"][e] = bearing.stiffness_npm, bearing.damping_nspm
            pitch_stiffness, pitch_damping = box.carrier_pitch
            c["rotational_stiffness"][e] = (
                bearing.tilting_stiffness_nmprad,
                pitch_stiffness,
                bearing.tilting_stiffness_nmprad,
            )
            c["rotational_damping"][e] = (
                bearing.tilting_damping_nmsprad,
                pitch_damping,
                bearing.tilting_damping_nmsprad,
            )
            c["preload"][e] = preload_n + box.mass_kg * GRAVITY_MPS2
