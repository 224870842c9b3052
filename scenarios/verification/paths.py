"""The ten test paths: full runs of the coach against the published tables.

The tables do not say whether their shares are of time or of distance, speed excepted. Paths 7 and 9 tell: they are of
the same length, and 9 differs by a first uphill that is met slower. Its shares of slow running and of steep slope are
larger by 0.43 and 0.81 points, which the seconds lost there make of time and no metres make of distance, while the
share of degraded adhesion stays within 0.01: so speed, slope and with them yaw rate are of time, adhesion of distance.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cache, partial

import numpy as np

from scenarios.compare_models import speed_difference
from scenarios.cosimulation.simulation import simulate
from scenarios.errors import RunInterrupted
from scenarios.interruption import Interruption
from scenarios.path_classes import PathFigures, path_figures
from scenarios.point_mass import POINT_MASSES
from scenarios.point_mass_drive import drive_point_mass
from scenarios.scenario_file import load_scenario
from scenarios.truth import MotionStream
from scenarios.units import KMH_PER_MPS
from scenarios.verification.case import Case

MALVEZZI = "Malvezzi et al. 2014"
TOLERANCE_POINTS = 2.0
LENGTH_TOLERANCE = 0.01
PATH_GROUP = "Test path"
SLIDES_FROM = 5.0
_NO_LIMIT = 1e3
COURSE_PERIOD_S = 0.1

PUBLISHED: dict[int, tuple[float, ...]] = {
    # length km; degraded; speed below 50, 50 to 150, above 150 km/h; yaw rate low, mid, high; slope low, mid, high: %
    1: (20.91, 40.14, 7.28, 51.56, 41.15, 100.0, 0.0, 0.0, 86.96, 1.37, 11.67),
    2: (20.71, 41.84, 7.15, 50.48, 42.36, 71.18, 5.36, 23.46, 100.0, 0.0, 0.0),
    3: (20.63, 49.51, 7.24, 47.92, 44.84, 71.86, 5.21, 22.94, 73.10, 2.46, 24.45),
    4: (26.59, 40.25, 6.61, 49.16, 44.23, 73.48, 4.39, 22.13, 84.22, 3.21, 12.58),
    5: (31.40, 33.07, 4.92, 52.48, 42.60, 57.12, 6.48, 36.40, 83.85, 4.66, 11.49),
    6: (36.76, 43.59, 4.22, 51.87, 43.91, 72.13, 5.14, 22.74, 62.91, 6.95, 30.15),
    7: (21.31, 39.26, 8.85, 50.40, 40.76, 100.0, 0.0, 0.0, 83.75, 2.01, 14.23),
    8: (21.03, 39.70, 8.22, 49.88, 41.89, 100.0, 0.0, 0.0, 85.82, 8.15, 6.03),
    9: (21.31, 39.27, 9.28, 50.21, 40.52, 100.0, 0.0, 0.0, 82.92, 2.04, 15.04),
    10: (21.16, 42.63, 7.99, 48.60, 43.41, 71.52, 13.28, 15.20, 81.07, 1.74, 17.19),
}
_SHARES = (
    "degraded adhesion, of distance",
    "speed below 50 km/h, of time",
    "speed 50 to 150 km/h, of time",
    "speed above 150 km/h, of time",
    "yaw rate below 1e-4 rad/s, of time",
    "yaw rate 1e-4 to 0.005 rad/s, of time",
    "yaw rate above 0.005 rad/s, of time",
    "slope below 5 per mille, of time",
    "slope 5 to 15 per mille, of time",
    "slope above 15 per mille, of time",
)


@dataclass(frozen=True)
class PathRun:
    """A full run of a path: its figures, the error of its energy balance as a share of the absolute work, its course at
    10 Hz, (n,) each, the speed at which its first slope is met and the one at which its first curve is left, -inf
    where it has none."""

    figures: PathFigures
    energy_error: float
    t_s: np.ndarray
    position_m: np.ndarray
    speed_mps: np.ndarray
    first_slope_kmh: float
    first_curve_kmh: float

    def row(self) -> tuple[float, ...]:
        """The figures in the order of `PUBLISHED`."""
        figures, time = self.figures, self.figures.by_time
        return (figures.length_km, figures.by_distance.degraded, *time.speed, *time.yaw_rate, *time.slope)


_runs: dict[int, PathRun | Exception] = {}


def run_path(number: int, stop_requested: Callable[[], bool] = lambda: False) -> PathRun:
    """Run the scenario of a path, from its start to its end."""
    truth = simulate(load_scenario(f"path-{number:02d}", ()), lambda *_: None, stop_requested)
    if truth.solve.ended != "standstill":
        raise ValueError(f"path-{number:02d} did not come to its stop within its longest_s")
    motion = truth.motion
    every = slice(None, None, round(COURSE_PERIOD_S / (motion.t_s[1] - motion.t_s[0])))
    course = (motion.t_s[every], motion.position_m[every], motion.speed_mps[every])
    return PathRun(path_figures(truth), energy_error(motion), *course, *first_met_kmh(motion))


def first_met_kmh(motion: MotionStream) -> tuple[float, float]:
    """Speed where the first slope begins and where the first curve ends; -inf without one."""
    slope_row = np.flatnonzero(motion.gradient_permille != 0.0)[:1]
    curve_row = np.flatnonzero(np.diff((motion.curvature_radpm != 0.0).astype(int)) < 0)[:1]  # the last one in it
    slope_mps, curve_mps = (float(motion.speed_mps[row].max(initial=-np.inf)) for row in (slope_row, curve_row))
    return KMH_PER_MPS * slope_mps, KMH_PER_MPS * curve_mps


def run_all(workers: int, interruption: Interruption) -> Iterator[int]:
    """Run the paths that have not been run yet, on several cores, and keep their figures; yields those done."""
    from scenarios.wsp_test.runner import Workers  # it starts processes, which tests of single rows need not

    # the longest one first
    waiting = sorted((k for k in PUBLISHED if k not in _runs), key=lambda k: -PUBLISHED[k][0])
    with Workers(min(workers, max(len(waiting), 1)), interruption) as processes:
        for number, outcome in processes.each(_attempt, waiting):
            _runs[number] = outcome
            yield number


def _attempt(number: int, stop_requested: Callable[[], bool]) -> PathRun | Exception:
    """What breaks one path down is told by its own rows."""
    try:
        return run_path(number, stop_requested)
    except RunInterrupted:
        raise
    except Exception as error:
        return RuntimeError(f"{type(error).__name__}: {error}")


def path_run(number: int) -> PathRun:
    """The run of this path, done once."""
    if number not in _runs:
        _runs[number] = _attempt(number, lambda: False)
    run = _runs[number]
    if isinstance(run, Exception):
        raise run
    return run


def energy_error(motion: MotionStream) -> float:
    """Kinetic energy gained less the work of all forces, over the sum of the absolute work of their classes."""
    names = [field.name for field in fields(motion) if field.name.startswith("power_")]
    powers = [getattr(motion, name) for name in names]
    work = sum(float(np.trapezoid(power, motion.t_s)) for power in powers)
    absolute = sum(float(np.trapezoid(np.abs(power), motion.t_s)) for power in powers)
    return float(motion.kinetic_energy_j[-1] - motion.kinetic_energy_j[0] - work) / absolute


def _figure(number: int, k: int) -> float:
    return path_run(number).row()[k]


def _least_slide(number: int) -> float:
    """Largest slip of any wheelset in that degraded phase where it is least, %."""
    return min((100.0 * max(phase.largest_slip) for phase in path_run(number).figures.phases), default=0.0)


def _phases(number: int) -> float:
    """Degraded phases, if traction and braking take turns; nan otherwise."""
    kinds = [phase.kind for phase in path_run(number).figures.phases]
    turns = all(kind == ("traction", "braking")[k % 2] for k, kind in enumerate(kinds))
    return float(len(kinds)) if turns else float("nan")


def _energy_percent(number: int) -> float:
    return 100.0 * path_run(number).energy_error


def path_cases(numbers: Sequence[int] = tuple(PUBLISHED)) -> tuple[Case, ...]:
    """Every cell of the tables for these paths, whether they slide as often as they should, and their energy."""
    cases = []
    for number in numbers:
        group, published = f"{PATH_GROUP} {number}", PUBLISHED[number]
        cases.append(
            Case(
                f"path-{number:02d}-length", group, "length", MALVEZZI, published[0], "km",
                partial(_figure, number, 0), LENGTH_TOLERANCE, relative=True,
            )
        )  # fmt: skip
        for k, quantity in enumerate(_SHARES, start=1):
            cases.append(
                Case(
                    f"path-{number:02d}-share-{k}", group, quantity, MALVEZZI, published[k], "%",
                    partial(_figure, number, k), TOLERANCE_POINTS,
                )
            )  # fmt: skip
        cases += [
            Case(
                f"path-{number:02d}-phases", group, "traction and braking in turn on degraded rail", MALVEZZI, 6.0,
                "phases", partial(_phases, number),
            ),
            Case(
                f"path-{number:02d}-slides", group, "largest slip in the phase where it is least", "requirement",
                (SLIDES_FROM, _NO_LIMIT), "%", partial(_least_slide, number),
            ),
            Case(
                f"path-{number:02d}-energy", group, "energy gained less the work of all forces, of the absolute work",
                "balance of energy", 0.0, "%", partial(_energy_percent, number), 1.0,
            ),
        ]  # fmt: skip
    return tuple(cases)


@cache
def _point_mass_on_path(number: int) -> tuple[float, float]:
    """The point mass beside the coach: rms difference of the speeds at the same places in km/h, ratio of the times."""
    run = path_run(number)
    point = drive_point_mass(load_scenario(f"path-{number:02d}", ()), POINT_MASSES["point-mass"])
    difference = speed_difference(point.position_m, point.speed_mps, run.position_m, run.speed_mps)
    return difference.rms_kmh, float(point.t_s[-1] / run.t_s[-1])


def _first_met(number: int, what: str) -> float:
    return float(getattr(path_run(number), what))


CASES = (
    *path_cases(),
    *(
        Case(
            f"path-{number:02d}-first-slope", f"{PATH_GROUP}s that start on a slope or in a curve",
            f"path {number}: speed at which the first uphill is met", MALVEZZI, expected, "km/h",
            partial(_first_met, number, "first_slope_kmh"), 1.0,
        )
        for number, expected in ((7, 15.0), (8, 35.0), (9, 8.0))
    ),
    Case(
        "path-10-first-curve", f"{PATH_GROUP}s that start on a slope or in a curve",
        "path 10: speed at which the first curve is left", MALVEZZI, (0.0, 40.0), "km/h",
        partial(_first_met, 10, "first_curve_kmh"),
    ),
    Case(
        "path-01-point-mass-speed", f"{PATH_GROUP} 1 by the reduced model",
        "speed at the same places, rms of the difference to the coach", "the coach", (0.0, 5.0), "km/h",
        lambda: _point_mass_on_path(1)[0],
    ),
    Case(
        "path-01-point-mass-time", f"{PATH_GROUP} 1 by the reduced model", "time over that of the coach", "the coach",
        1.0, "-", lambda: _point_mass_on_path(1)[1], 0.02,
    ),
)  # fmt: skip
