"""Contact geometry of a rigid wheelset on a rigid track, tabulated over lateral displacement and yaw.

Displacement is positive to the left, yaw positive to the left (about z), roll positive with the left wheel up.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from wheel_rail.contact_search import (
    ALONG,
    COLUMNS,
    RADIUS,
    RAIL_LATERAL,
    TRACK_Y,
    TURN,
    WHEEL_LATERAL,
    WHEEL_ROLLING,
    let_down,
)
from wheel_rail.profiles import SMOOTHING_M, Profile, gauge_point_y_m, rail_profile, wheel_profile

JUMP_M = 1e-3  # a contact that moves further than this over a vanishing displacement jumps


class ContactGeometryParameters(BaseModel):
    """A wheelset and the track below it; pairs are left and right."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    wheel_profiles: tuple[str, str] = Field(description="names of WHEEL_PROFILES or files, left and right")
    rail_profiles: tuple[str, str] = Field(description="names of RAIL_PROFILES or files, left and right")
    rail_inclination: float = Field(ge=-0.2, le=0.2, description="tangent, 0.025 for 1:40; 0 if measured as laid")
    gauge_m: float = Field(ge=0.6, le=2.0)
    gauge_below_top_m: float = Field(default=0.014, gt=0.0, le=0.02, description="where the gauge is measured")
    back_to_back_m: float = Field(ge=0.5, le=2.0, description="between the flanges' backs")
    tape_circle_from_back_m: float = Field(default=0.07, gt=0.0, le=0.1)
    smoothing_m: float = Field(default=SMOOTHING_M, ge=1.5e-4, le=5e-3, description="of the profiles, along the curve")


@dataclass(frozen=True)
class Jump:
    """The rigid contact of one side leaps: at this displacement it touches at two places of the wheel at once.

    `from_m`, `to_m`: the places in the wheel profile's y, before and beyond the displacement.
    """

    side: Literal["left", "right"]
    yaw_rad: float
    lateral_displacement_m: float
    from_m: float
    to_m: float


@dataclass(frozen=True)
class ContactTable:
    """Contacts of a wheelset for k yaws and n displacements.

    `roll_rad`, `height_m` (k, n): pose of the wheelset's centre, height above the tops of the rails.
    `contacts` (k, n, 2, 11), sides left and right, y and along counted outwards from the centre:
    0 place along the axle (m), 1 rolling radius (m), 2 slope of the wheel -d(radius)/d(along), 3 how far ahead of the
    wheelset's centre it touches (m), 4 and 5 place in the track, y from the centreline and z above the rail tops (m),
    6 contact angle (rad; positive when the normal force pushes the wheelset to the centre, as at a flange),
    7 curvature of the wheel in rolling direction, 8 in lateral direction, 9 of the rail in lateral direction (1/m,
    convex positive), 10 angle from the rail to the wheel's rolling direction in the plane of contact (rad).
    `jumps`: where the rigid contact leaps, empty for a table with penetration.
    """

    lateral_displacement_m: np.ndarray
    yaw_rad: np.ndarray
    roll_rad: np.ndarray
    height_m: np.ndarray
    contacts: np.ndarray
    tape_circle_m: float
    rail_origin_m: np.ndarray
    jumps: tuple[Jump, ...]

    @property
    def rolling_radius_difference_m(self) -> np.ndarray:
        """Rolling radius left minus right, (k, n)."""
        return self.contacts[..., 0, RADIUS] - self.contacts[..., 1, RADIUS]

    @property
    def wheel_position_m(self) -> np.ndarray:
        """Contact in the y of the wheel profiles, (k, n, 2): from the tape circle, flange negative."""
        return self.contacts[..., ALONG] - self.tape_circle_m

    @property
    def rail_position_m(self) -> np.ndarray:
        """Contact in the y of the rail profiles as laid, (k, n, 2), gauge side negative."""
        return self.contacts[..., TRACK_Y] - self.rail_origin_m


class ContactGeometry:
    """A wheelset with wheels of `wheel_radii_m` (left, right, at the tape circle) on its track.

    Raises ValueError or ProfileError for profiles that cannot be used.
    """

    def __init__(self, parameters: ContactGeometryParameters, wheel_radii_m: tuple[float, float]) -> None:
        p = parameters
        self.tape_circle_m = 0.5 * p.back_to_back_m + p.tape_circle_from_back_m
        self.wheels = []
        self.rails = []
        origins = []
        for name, radius_m in zip(p.wheel_profiles, wheel_radii_m, strict=True):
            if not 0.1 <= radius_m <= 1.0:
                raise ValueError(f"wheel_radii_m = {wheel_radii_m}: a wheel radius lies within 0.1..1 m")
            profile = _running_part(wheel_profile(name, p.smoothing_m))
            # z is down: the radius grows with it, and a wheel whose surface bends down on both sides is hollow
            self.wheels.append(_nodes(profile, self.tape_circle_m, radius_m, -1.0))
        for name in p.rail_profiles:
            rail = rail_profile(name, p.rail_inclination, p.smoothing_m)
            origins.append(0.5 * p.gauge_m - gauge_point_y_m(rail, p.gauge_below_top_m))
            nodes = _nodes(rail.between_walls(), origins[-1], 0.0, 1.0)
            self.rails.append(nodes * (1.0, -1.0, -1.0, 1.0))
        self.rail_origin_m = np.array(origins)

    def table(
        self,
        lateral_displacement_m: np.ndarray,
        yaw_rad: np.ndarray | None = None,
        penetration_m: float = 0.0,
        level: bool = False,
    ) -> ContactTable:
        """Contacts at the displacements (n,), in order, and yaws (k,); none means straight ahead.

        `penetration_m` = 0 is the rigid contact, which may leap. Beyond, the contact is the centre of the region in
        which the undeformed bodies would overlap by that depth, smooth in displacement: by exponential weights of
        the gap (Arnold and Netter 1998) with a softness of penetration/3, at which a parabolic gap has the same
        spread as the volume of the overlap. About 0.55 of Hertz' approach is right (Kik and Piotrowski 1996): 12 um
        at 10 kN, 45 um at 70 kN. `level` keeps the wheelset from rolling, as EN 15302 does.
        Raises ValueError if a side touches at the end of a profile or an argument is out of range.
        """
        displacement = np.ascontiguousarray(lateral_displacement_m, dtype=float)
        yaw = np.zeros(1) if yaw_rad is None else np.ascontiguousarray(yaw_rad, dtype=float)
        if not 0.0 <= penetration_m <= 1e-3:
            raise ValueError(f"penetration_m = {penetration_m}: must lie within 0..0.001")
        if not (np.all(np.abs(displacement) <= 0.1) and np.all(np.diff(displacement) > 0.0) and displacement.size):
            raise ValueError("lateral_displacement_m: must rise strictly within -0.1..0.1")
        if not np.all(np.abs(yaw) <= 0.1):
            raise ValueError("yaw_rad: must lie within -0.1..0.1")
        contacts, pose = self._let_down(displacement, yaw, penetration_m, level)
        if np.any(np.isnan(pose)):
            k, i = np.argwhere(np.isnan(pose[..., 1]))[0]
            raise ValueError(
                f"at a displacement of {1000 * displacement[i]:.3f} mm and a yaw of {1000 * yaw[k]:.2f} mrad a wheel "
                "touches at the end of its profile or the rail's: longer profiles or smaller displacements are needed"
            )
        jumps = self._jumps(displacement, yaw, contacts, level) if penetration_m == 0.0 else ()
        return ContactTable(
            displacement, yaw, pose[..., 0], pose[..., 1], contacts, self.tape_circle_m, self.rail_origin_m, jumps
        )

    def _let_down(
        self, displacement_m: np.ndarray, yaw_rad: np.ndarray, penetration_m: float, level: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        contacts = np.zeros((yaw_rad.size, displacement_m.size, 2, COLUMNS))
        pose = np.zeros((yaw_rad.size, displacement_m.size, 2))
        left_wheel, right_wheel = self.wheels
        left_rail, right_rail = self.rails
        let_down(
            displacement_m,
            yaw_rad,
            left_wheel,
            right_wheel,
            left_rail,
            right_rail,
            penetration_m / 3.0,
            level,
            contacts,
            pose,
        )
        return contacts, pose

    def _jumps(
        self, displacement_m: np.ndarray, yaw_rad: np.ndarray, contacts: np.ndarray, level: bool
    ) -> tuple[Jump, ...]:
        """Refine every interval in which a contact moves far until it is clear whether it moves fast or leaps."""
        jumps = []
        moves = np.abs(np.diff(contacts[..., ALONG], axis=1))
        for k, i, side in np.argwhere(moves > JUMP_M):
            low, high = displacement_m[i], displacement_m[i + 1]
            # three rounds come down to 1e-8 m; finer, rolling wheelsets may stand in either of two poses
            for _ in range(3):
                fine = np.linspace(low, high, 17)
                along = self._let_down(fine, yaw_rad[k : k + 1], 0.0, level)[0][0, :, side, ALONG]
                j = int(np.argmax(np.abs(np.diff(along))))
                low, high = fine[j], fine[j + 1]
            if abs(along[j + 1] - along[j]) > JUMP_M:
                name: Literal["left", "right"] = "right" if side else "left"
                places = along[j : j + 2] - self.tape_circle_m
                jumps.append(
                    Jump(name, float(yaw_rad[k]), float(0.5 * (low + high)), float(places[0]), float(places[1]))
                )
        return tuple(jumps)


def relative_curvatures_1pm(contacts: np.ndarray) -> np.ndarray:
    """Principal curvatures of wheel and rail together, (..., 2), 1/m: nearest the rolling, the lateral direction.

    `contacts` (..., 11). The wheel's principal directions are turned against the rail's (Johnson, section 4.1); the
    sum's are found from the two by two tensor. The lateral one is zero or negative where wheel and rail conform.
    """
    c, s = np.cos(contacts[..., TURN]), np.sin(contacts[..., TURN])
    rolling, lateral = contacts[..., WHEEL_ROLLING], contacts[..., WHEEL_LATERAL]
    xx = rolling * c * c + lateral * s * s
    yy = rolling * s * s + lateral * c * c + contacts[..., RAIL_LATERAL]
    xy = (rolling - lateral) * s * c
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    spread = np.copysign(np.hypot(half, xy), half)
    return np.stack([mean + spread, mean - spread], axis=-1)


def _running_part(wheel: Profile) -> Profile:
    """The wheel profile from the flange's tip outwards."""
    tip = int(np.argmax(wheel.z_m))
    return wheel.part(tip, len(wheel.y_m)).between_walls()


def _nodes(profile: Profile, y_m: float, z_m: float, convex: float) -> np.ndarray:
    """Nodes (n, 4) of a profile moved by y and z: y, z, dz/dy, curvature (times `convex`)."""
    return np.stack(
        [profile.y_m + y_m, profile.z_m + z_m, np.tan(profile.angle_rad), convex * profile.curvature_1pm], axis=1
    )
