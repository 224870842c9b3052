"""A coach in figures: masses, static loads, suspension, modes, hunting speeds, and how it stands in a curve."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenarios.units import KMH_PER_MPS
from vehicle import CoachParameters
from vehicle.curving import CurveLoads, deficiency_speed_mps, run_in_curve
from vehicle.hunting import AMPLITUDE_M, Hunting, hunting_speed, hunting_speed_on_cones, profile_conicity, swings
from vehicle.linear import Linearisation
from vehicle.modes import DampedMode, damped_modes
from vehicle.parameters import GRAVITY_MPS2
from vehicle.static_loads import StaticLoads, static_loads

CONICITIES = (0.05, 0.1, 0.2, 0.3, 0.4)
CURVE_RADIUS_M, CURVE_CANT_MM, DEFICIENCIES_MM = 600.0, 100.0, (0.0, 100.0)
LOCUS_TO_MPS, LOCUS_POINTS = 120.0, 59


@dataclass(frozen=True)
class Body:
    """A kind of body: how many there are, their mass, inertias about their own axes, and height over the rails."""

    name: str
    count: int
    mass_kg: float
    roll_inertia_kgm2: float
    pitch_inertia_kgm2: float
    yaw_inertia_kgm2: float
    height_m: float


@dataclass(frozen=True)
class Spring:
    """A kind of suspension element and its linear constants along and about x, y, z; None where it has none."""

    name: str
    count: int
    stiffness_npm: tuple[float | None, ...] = (None,) * 3
    damping_nspm: tuple[float | None, ...] = (None,) * 3
    rotational_stiffness_nmprad: tuple[float | None, ...] = (None,) * 3


@dataclass(frozen=True)
class InCurve:
    """Steady running in a curve: cant deficiency, speed, both rails' loads, roll of the body over that of the plane."""

    deficiency_mm: float
    loads: CurveLoads

    @property
    def flexibility(self) -> float | None:
        """Flexibility coefficient: roll against the track plane per angle of unbalanced acceleration."""
        unbalanced = self.loads.unbalanced_mps2 / GRAVITY_MPS2
        return None if abs(self.deficiency_mm) < 1.0 else self.loads.body_roll_rad / unbalanced


@dataclass(frozen=True)
class RootLocus:
    """Eigenvalues of all swings, 1/s, at rising speeds: `rates[k]` at `speed_mps[k]`."""

    speed_mps: np.ndarray
    rates: list[np.ndarray]


@dataclass(frozen=True)
class CoachSheet:
    """All figures of one coach; modes at `speed_mps`. `hunting`: on its profiles for small swings, then on cones."""

    name: str
    parameters: CoachParameters
    speed_mps: float
    bodies: tuple[Body, ...]
    loads: StaticLoads
    springs: tuple[Spring, ...]
    modes: list[DampedMode]
    hunting: tuple[tuple[str, Hunting], ...]
    curves: tuple[InCurve, ...]
    locus: RootLocus

    def tree(self) -> dict[str, Any]:
        """For a JSON file."""
        return {
            "coach": self.name,
            "parameters": self.parameters.model_dump(mode="json", exclude_none=True),
            "mass_kg": self.parameters.mass_kg,
            "wheel_load_n": _plain(self.loads.wheel_load_n),
            "spring_load_n": _plain(self.loads.spring_load_n),
            "spring_deflection_m": _plain(self.loads.spring_deflection_m),
            "speed_kmh": self.speed_mps * KMH_PER_MPS,
            "modes": [
                {"name": mode.name, "frequency_hz": mode.frequency_hz, "damping_ratio": mode.damping_ratio}
                for mode in self.modes
            ],
            "hunting": [
                {
                    "on": on,
                    "conicity": found.conicity,
                    "speed_kmh": None if found.speed_mps is None else found.speed_mps * KMH_PER_MPS,
                    "frequency_hz": found.frequency_hz,
                }
                for on, found in self.hunting
            ],
            "curve": [
                {
                    "radius_m": CURVE_RADIUS_M,
                    "cant_mm": CURVE_CANT_MM,
                    "deficiency_mm": curve.deficiency_mm,
                    "speed_kmh": curve.loads.speed_mps * KMH_PER_MPS,
                    "wheel_load_n": _plain(curve.loads.wheel_load_n),
                    "lateral_force_n": _plain(curve.loads.lateral_force_n),
                    "guiding_force_n": _plain(curve.loads.guiding_force_n),
                    "body_roll_rad": curve.loads.body_roll_rad,
                    "flexibility": curve.flexibility,
                }
                for curve in self.curves
            ],
        }


def coach_sheet(name: str, coach: CoachParameters, speed_mps: float) -> CoachSheet:
    """Work everything out. Raises ValueError for a coach that finds no balance in its springs."""
    linearisation = Linearisation(coach)
    speeds = np.linspace(4.0, LOCUS_TO_MPS, LOCUS_POINTS)
    return CoachSheet(
        name=name,
        parameters=coach,
        speed_mps=speed_mps,
        bodies=_bodies(coach),
        loads=static_loads(coach),
        springs=_springs(coach),
        modes=damped_modes(linearisation.at(speed_mps)),
        hunting=tuple(_hunting(coach, linearisation)),
        curves=tuple(
            InCurve(
                deficiency_mm,
                run_in_curve(
                    coach,
                    CURVE_RADIUS_M,
                    CURVE_CANT_MM,
                    deficiency_speed_mps(CURVE_RADIUS_M, CURVE_CANT_MM, deficiency_mm),
                    step_s=0.002,
                ),
            )
            for deficiency_mm in DEFICIENCIES_MM
        ),
        locus=RootLocus(speeds, [swings(linearisation, float(speed)) for speed in speeds]),
    )


def _bodies(p: CoachParameters) -> tuple[Body, ...]:
    wheelset = p.wheelset
    return (
        Body("carbody", 1, *p.laden_body.model_dump(include=_RIGID).values()),
        Body("bogie frame", 2, *p.bogie.model_dump(include=_RIGID).values()),
        Body(
            "wheelset",
            4,
            wheelset.mass_kg,
            wheelset.roll_inertia_kgm2,
            wheelset.spin_inertia_kgm2,
            wheelset.yaw_inertia_kgm2,
            0.5 * wheelset.wheel_diameter_m,
        ),
    )


_RIGID = {"mass_kg", "roll_inertia_kgm2", "pitch_inertia_kgm2", "yaw_inertia_kgm2", "height_m"}


def _springs(p: CoachParameters) -> tuple[Spring, ...]:
    rod = p.traction_rod
    stages = (("primary spring", 8, p.primary), ("secondary spring", 4, p.secondary))
    return (
        *(
            Spring(name, count, stage.stiffness_npm, stage.damping_nspm, stage.rotational_stiffness_nmprad)
            for name, count, stage in stages
        ),
        *([Spring("traction rod", 2, (rod.stiffness_npm, None, None), (rod.damping_nspm, None, None))] if rod else []),
        Spring("anti-roll bar", 2, rotational_stiffness_nmprad=(p.anti_roll_bar_nmprad, None, None)),
    )


def _hunting(coach: CoachParameters, linearisation: Linearisation) -> Iterator[tuple[str, Hunting]]:
    equivalent = profile_conicity(coach)
    if coach.contact.geometry == "profiles":
        yield "profiles, vanishing swings", hunting_speed(linearisation)
        if math.isfinite(equivalent):
            words = f"cones as steep as the profiles at {1e3 * AMPLITUDE_M:g} mm"
            yield words, hunting_speed_on_cones(coach, equivalent)
    else:
        yield "its own cones", hunting_speed(linearisation)
    for conicity in CONICITIES:
        yield "cones", hunting_speed_on_cones(coach, conicity)


def _plain(values: np.ndarray) -> list[float]:
    return [float(value) for value in values]
