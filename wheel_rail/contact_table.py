"""The contact of a wheelset with the track as the compiled contact reads it: a table over lateral displacement.

Conical wheels and profiles fill the same table. It ends where the flange rises: beyond, its end rows hold, and a
lateral stop on the rail's stiffness takes over.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from wheel_rail.contact_geometry import ContactGeometry, relative_curvatures_1pm
from wheel_rail.contact_parameters import ConicalGeometry, ContactParameters, ProfileGeometry
from wheel_rail.contact_search import ALONG, CONICITY, RADIUS, TRACK_Y, TRACK_Z
from wheel_rail.creep_laws import CREEP_LAWS, EXTRA, LawInForce
from wheel_rail.hertz import elliptic_contact
from wheel_rail.kalker import creep_coefficients
from wheel_rail.profiles import rail_profile, wheel_profile
from wheel_rail.track_parameters import RAIL_SPACING_M

NODES = 201
COLUMNS = 12
FLANGE_SLOPE = 0.3
"""The table ends where the wheel's slope reaches this: the tread has ended and the flange begins."""
_STEP_M = 1e-4
_LARGEST_RATIO = 8.0  # of the semi-axes: more slender contacts than this are no longer Hertz' (and Kalker's table ends)
_PENETRATION_M = 45e-6  # see ContactGeometry.table; right for about 70 kN

# columns of the table, y and along counted outwards from the centre: place along the axle (m), rolling radius (m),
# slope of the wheel -d(radius)/d(along), place on the track (m, from the centreline and above the rails), semi-axes of
# the ellipse at the reference load (m), C11, C22, C23, Polach's spin factor, normal stiffness with the track's in
# series (N/m)
(
    PLACE_ALONG, ROLLING_RADIUS, SLOPE, RAIL_Y, RAIL_Z, SEMI_AXIS_A, SEMI_AXIS_B, C11, C22, C23, SPIN_FACTOR, STIFFNESS,
) = range(COLUMNS)  # fmt: skip

CONTACT = np.dtype(
    [
        ("table", "f8", (2, NODES, COLUMNS)),  # left and right
        ("first_m", "f8"),  # displacement of the first node
        ("nodes_per_m", "f8"),
        ("radius_m", "f8"),  # nominal
        ("reference_load_n", "f8"),
        ("shear_modulus_pa", "f8"),
        ("damping_nspm", "f8"),
        ("flange_clearance_m", "f8"),
        ("flange_stiffness_npm", "f8"),
        ("creep_speed_mps", "f8"),
        ("law", "i8"),
        ("law_address", "i8"),
        ("law_extra", "f8", (EXTRA,)),
    ]
)


@dataclass(frozen=True)
class Contact:
    """`ContactParameters` made ready for wheels of `radius_m` at the nominal load per wheel, under a creep law."""

    parameters: ContactParameters
    radius_m: float
    load_n: float
    law: LawInForce = field(default_factory=CREEP_LAWS["polach"].in_force)

    def at_load(self, load_n: float) -> "Contact":
        """The same wheels under another nominal load."""
        return replace(self, load_n=load_n)

    @cached_property
    def constants(self) -> np.ndarray:
        """Record of dtype `CONTACT` (shape ()). Raises ValueError, which names the key, for unusable profiles."""
        p = self.parameters
        record = np.zeros((), CONTACT)
        displacement, record["table"] = _rows(p, self.radius_m, self.load_n, *_file_times(p.profiles))
        record["first_m"], record["nodes_per_m"] = displacement[0], 1.0 / (displacement[1] - displacement[0])
        record["flange_clearance_m"] = displacement[-1]
        record["radius_m"] = self.radius_m
        record["reference_load_n"] = self.load_n
        for name in ("shear_modulus_pa", "damping_nspm", "flange_stiffness_npm", "creep_speed_mps"):
            record[name] = getattr(p, name)
        record["law"], record["law_address"] = self.law.number, self.law.address
        record["law_extra"] = self.law.extra
        return record

    @property
    def displacement_m(self) -> np.ndarray:
        """Lateral displacements of the table's nodes, (NODES,)."""
        limit = self.constants["flange_clearance_m"]
        return np.linspace(-limit, limit, NODES)

    @property
    def patch(self) -> np.ndarray:
        """Contact of a centred wheel at the nominal load: (a_m, b_m, C11, C22, C23, Polach's spin factor)."""
        return self._centred[SEMI_AXIS_A : SPIN_FACTOR + 1]

    @property
    def rolling_radius_m(self) -> float:
        """Of a centred wheel."""
        return float(self._centred[ROLLING_RADIUS])

    @property
    def rest_height_m(self) -> float:
        """Height of a centred wheelset's axle above the rails at the nominal load."""
        row = self._centred
        sink = self.load_n / row[STIFFNESS] * (1.0 + row[SLOPE] ** 2)
        # level, the wheel's contact point stands on the rail's
        return float(row[ROLLING_RADIUS] + row[RAIL_Z] - sink)

    @property
    def _centred(self) -> np.ndarray:
        row: np.ndarray = self.constants["table"][0, NODES // 2]
        return row


@lru_cache(maxsize=16)
def _rows(
    parameters: ContactParameters, radius_m: float, load_n: float, *_file_times_ns: int
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (NODES,) and table (2, NODES, COLUMNS).

    Made once for each contact and state of the files: a run asks for it several times, and it takes 0.3 s.
    """
    if parameters.geometry == "conical" and parameters.conical is not None:
        displacement, table = _conical(parameters, parameters.conical, radius_m, load_n)
    elif parameters.profiles is not None:
        displacement, table = _profiles(parameters, parameters.profiles, radius_m, load_n)
    return displacement, table


def _file_times(profiles: ProfileGeometry | None) -> list[int]:
    """When the profiles that are files were written, ns."""
    files = map(Path, (profiles.wheel_profile, profiles.rail_profile) if profiles else ())
    return [file.stat().st_mtime_ns for file in files if file.is_file()]


def _conical(
    p: ContactParameters, cone: ConicalGeometry, radius_m: float, load_n: float
) -> tuple[np.ndarray, np.ndarray]:
    half = 0.5 * RAIL_SPACING_M
    displacement = np.linspace(-cone.flange_clearance_m, cone.flange_clearance_m, NODES)
    table = np.zeros((2, NODES, COLUMNS))
    for side, sign in ((0, 1.0), (1, -1.0)):
        rows = table[side]
        rows[:, PLACE_ALONG] = half - sign * displacement
        rows[:, ROLLING_RADIUS] = radius_m + cone.conicity * sign * displacement
        rows[:, SLOPE] = cone.conicity
        rows[:, RAIL_Y] = half
        rows[:, SEMI_AXIS_A:] = _hertz(p, load_n, 1.0 / radius_m, 1.0 / cone.rail_head_radius_m)
    return displacement, table


def _profiles(
    p: ContactParameters, profiles: ProfileGeometry, radius_m: float, load_n: float
) -> tuple[np.ndarray, np.ndarray]:
    for key, read in (("wheel_profile", wheel_profile), ("rail_profile", rail_profile)):
        name = getattr(profiles, key)
        try:
            read(name)
        except ValueError as error:
            raise ValueError(f"contact.profiles.{key} = {name}: {error}") from None
    try:
        geometry = ContactGeometry(profiles.geometry, (radius_m, radius_m))
        limit = _end_of_tread_m(geometry)
        displacement = np.linspace(-limit, limit, NODES)
        found = geometry.table(displacement, penetration_m=_PENETRATION_M).contacts[0]
    except ValueError as error:
        here = f"contact.profiles.gauge_m = {profiles.gauge_m}"
        raise ValueError(f"{here}: with back_to_back_m = {profiles.back_to_back_m}, {error}") from None
    table = np.zeros((2, NODES, COLUMNS))
    taken = ((PLACE_ALONG, ALONG), (ROLLING_RADIUS, RADIUS), (SLOPE, CONICITY), (RAIL_Y, TRACK_Y), (RAIL_Z, TRACK_Z))
    curvature = relative_curvatures_1pm(found)
    for side in range(2):
        for column, source in taken:
            table[side, :, column] = found[:, side, source]
        for k in range(NODES):
            table[side, k, SEMI_AXIS_A:] = _hertz(p, load_n, curvature[k, side, 0], curvature[k, side, 1])
    return displacement, table


def _end_of_tread_m(geometry: ContactGeometry) -> float:
    """Displacement at which the flange begins."""
    outwards = np.arange(0.0, 0.02, _STEP_M)
    slope = geometry.table(outwards, penetration_m=_PENETRATION_M).contacts[0, :, 0, CONICITY]
    beyond = np.flatnonzero(slope > FLANGE_SLOPE)
    if not beyond.size or beyond[0] < 5:
        raise ValueError("the flange does not meet the rail at a displacement of 0.5 to 20 mm")
    return float(outwards[beyond[0] - 1])


def _hertz(p: ContactParameters, load_n: float, rolling_1pm: float, lateral_1pm: float) -> list[float]:
    """Columns from SEMI_AXIS_A on, for these relative curvatures."""
    # conforming surfaces make no ellipse: the flattest contact that the theory bears stands for them
    lateral = max(lateral_1pm, 0.02 * rolling_1pm)
    ellipse = elliptic_contact(load_n, rolling_1pm, lateral, p.shear_modulus_pa, p.poisson)
    ratio = min(max(ellipse.a_m / ellipse.b_m, 1.0 / _LARGEST_RATIO), _LARGEST_RATIO)
    # Hertz: approach grows with load^(2/3), so that the stiffness at a load is 3/2 load over approach
    hertz = 1.5 * load_n / ellipse.approach_m
    stiffness = 1.0 / (1.0 / hertz + 1.0 / p.track_stiffness_npm)
    factor = 1.0 + 6.3 * (1.0 - np.exp(-ratio))
    return [ellipse.a_m, ellipse.b_m, *creep_coefficients(ratio, p.poisson), float(factor), stiffness]
