"""Names of the coach's modes, from the share that each symmetric motion has in a mode's kinetic energy.

With unit masses (coordinates times the root of their mass) the motions below are orthonormal, so that the squares of a
mode's components along them are shares that sum to one. Like bodies move together in patterns: all alike, front against
rear, and the like.
"""

from collections import Counter, defaultdict
from dataclasses import dataclass
from functools import cache

import numpy as np

from vehicle.layout import SPIN, first_coordinate

LONGITUDINAL, LATERAL, BOUNCE, ROLL, PITCH, YAW = range(6)
DIRECTIONS = ("longitudinal", "lateral", "bounce", "roll", "pitch", "yaw")
IN_PHASE, OUT_OF_PHASE = "in phase", "out of phase"
_PATTERNS: dict[int, dict[str, tuple[int, ...]]] = {
    1: {"": (1,)},
    2: {IN_PHASE: (1, 1), OUT_OF_PHASE: (1, -1)},
    4: {
        IN_PHASE: (1, 1, 1, 1),
        OUT_OF_PHASE: (1, 1, -1, -1),
        "in each bogie opposed": (1, -1, 1, -1),
        "inner against outer": (1, -1, -1, 1),
    },
}
KLINGEL_SLIP = 0.3
"""Share of lateral sliding, in the squares, up to which wheelsets count as rolling along their wave."""


@dataclass(frozen=True)
class Motion:
    """A symmetric motion: the kind of bodies, the direction, their pattern, and the unit vector along it."""

    part: str
    direction: str
    pattern: str
    vector: np.ndarray


@cache
def motions(coordinates: int) -> tuple[Motion, ...]:
    """An orthonormal basis of all coordinates."""
    parts = {"body": (0,), "bogie": (1, 2), "wheelset": (3, 4, 5, 6)}
    groups = [
        (part, DIRECTIONS[k], tuple(first_coordinate(body) + k for body in bodies))
        for part, bodies in parts.items()
        for k in range(6)
    ]
    groups.append(("wheels", "spin", tuple(range(SPIN, SPIN + 4))))
    found = []
    for part, direction, at in groups:
        for pattern, signs in _PATTERNS[len(at)].items():
            vector = np.zeros(coordinates)
            vector[list(at)] = np.array(signs) / len(at) ** 0.5
            found.append(Motion(part, direction, pattern, vector))
    for at_box in range(SPIN + 4, coordinates):
        vector = np.zeros(coordinates)
        vector[at_box] = 1.0
        found.append(Motion("axle box", DIRECTIONS[(at_box - SPIN - 4) % 6], "", vector))
    return tuple(found)


def shares(shape: np.ndarray, mass: np.ndarray) -> dict[tuple[str, str, str], float]:
    """Share of each motion (part, direction, pattern) in the kinetic energy of the mode; they sum to one.

    `shape` (n,) may be complex; `mass` (n,): diagonal of the mass matrix.
    """
    weighted = np.sqrt(mass) * shape
    weighted = weighted / np.linalg.norm(weighted)
    found: dict[tuple[str, str, str], float] = defaultdict(float)
    for motion in motions(len(shape)):
        found[motion.part, motion.direction, motion.pattern] += float(abs(motion.vector @ weighted) ** 2)
    return dict(found)


def mode_name(shape: np.ndarray, mass: np.ndarray, rate: complex, speed_mps: float) -> str:
    """Name of one mode, by the kind of body and the direction that take most of the energy, then by their pattern.

    Lateral motion and roll of the body are one: sway, lower or upper by the height of the point it turns about. A
    lateral or yaw mode of bogies or wheelsets in which the wheelsets roll along their wave, y' = v psi, is Klingel's.
    `rate`: the eigenvalue, 1/s.
    """
    found = shares(shape, mass)
    kinds: dict[tuple[str, str], float] = defaultdict(float)
    for (part, direction, _), share in found.items():
        kinds[part, "sway" if part == "body" and direction in ("lateral", "roll") else direction] += share
    part, direction = max(kinds, key=lambda kind: kinds[kind])
    if (part, direction) == ("body", "sway"):
        # it turns about the point that the roll leaves where it is, at y/roll above the centre of mass
        above = (shape[LATERAL] * np.conj(shape[ROLL])).real > 0.0
        return "body upper sway" if above else "body lower sway"
    if part in ("bogie", "wheelset") and direction in ("lateral", "yaw") and _rolls(shape, rate, speed_mps):
        part, direction = "klingel", ""
        patterns = {
            pattern: sum(found["bogie", way, pattern] + found["wheelset", way, pattern] for way in ("lateral", "yaw"))
            for pattern in (IN_PHASE, OUT_OF_PHASE)
        }
    else:
        patterns = {p: share for (a, b, p), share in found.items() if (a, b) == (part, direction)}
    pattern = max(patterns, key=lambda key: patterns[key])
    if (part, direction) == ("wheelset", "pitch"):
        part = "axle boxes'"  # what does not spin of a wheelset
    return " ".join(filter(None, (part, direction))) + (f", {pattern}" if pattern else "")


def unique_names(names: list[str]) -> list[str]:
    """The names in their order, those that occur several times with a number."""
    often, seen = Counter(names), Counter[str]()
    numbered = []
    for name in names:
        seen[name] += 1
        numbered.append(f"{name} ({seen[name]})" if often[name] > 1 else name)
    return numbered


def _rolls(shape: np.ndarray, rate: complex, speed_mps: float) -> bool:
    wheelsets = np.array([first_coordinate(body) for body in (3, 4, 5, 6)])
    sideways, steered = rate * shape[wheelsets + LATERAL], speed_mps * shape[wheelsets + YAW]
    size = np.sum(np.abs(sideways) ** 2) + np.sum(np.abs(steered) ** 2)
    return bool(np.sum(np.abs(sideways - steered) ** 2) < KLINGEL_SLIP * size)
