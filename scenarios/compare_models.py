"""The reduced model beside the coach: one scenario through both, and how far they are apart."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.cosimulation.simulation import OnProgress, simulate
from scenarios.errors import BadInput, Fault, RunFailed, SolveFailed
from scenarios.interruption import Interruption
from scenarios.path_classes import SLOPE_BORDERS_PERMILLE, SPEED_BORDERS_KMH, class_shares
from scenarios.point_mass import POINT_MASSES, PointMassStream
from scenarios.point_mass_drive import drive_point_mass
from scenarios.schema import Scenario
from scenarios.truth import MotionStream
from scenarios.units import KMH_PER_MPS

PLACES_M = 10.0


@dataclass(frozen=True)
class SpeedDifference:
    """Speed of one run less that of another at the same places, every 10 m of the way that both have gone."""

    position_m: np.ndarray
    speed_kmh: np.ndarray

    @property
    def rms_kmh(self) -> float:
        return float(np.sqrt(np.mean(self.speed_kmh**2)))

    @property
    def largest_kmh(self) -> float:
        """Of the largest magnitude, with its sign."""
        return float(self.speed_kmh[np.argmax(np.abs(self.speed_kmh))])


def speed_difference(
    position_m: np.ndarray, speed_mps: np.ndarray, other_position_m: np.ndarray, other_speed_mps: np.ndarray
) -> SpeedDifference:
    """Of two runs that go forward, given row by row; (n,) and (m,)."""
    first = max(position_m[0], other_position_m[0])
    last = min(position_m[-1], other_position_m[-1])
    places = np.arange(first, last, PLACES_M)
    one, other = _over_place(places, position_m, speed_mps), _over_place(places, other_position_m, other_speed_mps)
    return SpeedDifference(places, KMH_PER_MPS * (one - other))


def _over_place(places_m: np.ndarray, position_m: np.ndarray, speed_mps: np.ndarray) -> np.ndarray:
    # standing still, and a coach that rocks back a little after its stop, are no way
    ahead = np.append(True, np.diff(np.maximum.accumulate(position_m)) > 0.0)
    return np.interp(places_m, position_m[ahead], speed_mps[ahead])


_CLASSES = ("low", "middle", "high")
_ROWS = (
    "way  km",
    "time  s",
    "largest speed  km/h",
    *(f"{which} class of {what}, of time  %" for what in ("speed", "slope") for which in _CLASSES),
)
_FORMS = (".3f", ".1f", ".1f", *(".2f",) * 6)


def _of(run: MotionStream | PointMassStream) -> tuple[float, ...]:
    """The figures of `_ROWS`."""
    speed_kmh, each = KMH_PER_MPS * run.speed_mps, np.ones(len(run))
    return (
        (run.position_m[-1] - run.position_m[0]) / 1000.0,
        run.t_s[-1] - run.t_s[0],
        speed_kmh.max(),
        *class_shares(speed_kmh, SPEED_BORDERS_KMH, each),
        *class_shares(run.gradient_permille, SLOPE_BORDERS_PERMILLE, each),
    )


@dataclass(frozen=True)
class Comparison:
    """A scenario driven by the coach and by a point mass."""

    model: str
    coach: MotionStream
    point_mass: PointMassStream
    difference: SpeedDifference

    def table(self) -> Table:
        """Both side by side."""
        table = Table(title=f"the coach and the {self.model}", title_justify="left")
        for heading in ("", "coach", self.model):
            table.add_column(heading, justify="left" if not heading else "right")
        for name, form, coach, point_mass in zip(_ROWS, _FORMS, _of(self.coach), _of(self.point_mass), strict=True):
            table.add_row(name, format(coach, form), format(point_mass, form))
        table.add_row("speed at the same place, rms of the difference  km/h", "", f"{self.difference.rms_kmh:.2f}")
        table.add_row("largest difference  km/h", "", f"{self.difference.largest_kmh:+.2f}")
        return table


def compare_models(
    scenario: Scenario, model: str, on_progress: OnProgress, stop_requested: Callable[[], bool]
) -> Comparison:
    """Run both; `model`: a name of `POINT_MASSES`. Raises BadInput for another one, and as `simulate` does."""
    form = POINT_MASSES.get(model)
    if form is None:
        raise BadInput(Fault("--model", model, f"must be one of {', '.join(POINT_MASSES)}"))
    coach = simulate(scenario, on_progress, stop_requested).motion
    point_mass = drive_point_mass(scenario, form)
    difference = speed_difference(point_mass.position_m, point_mass.speed_mps, coach.position_m, coach.speed_mps)
    return Comparison(model, coach, point_mass, difference)


def compare_and_report(console: Console, scenario: Scenario, model: str, interruption: Interruption) -> None:
    """What `railslide compare-models` does. Raises BadInput, RunFailed or RunInterrupted."""
    with Console(stderr=True).status("driving the coach") as status, interruption.deferred():

        def on_progress(t_s: float, position_m: float, speed_mps: float) -> None:
            status.update(f"driving the coach: {position_m:.0f} m, {KMH_PER_MPS * speed_mps:.0f} km/h")

        try:
            comparison = compare_models(scenario, model, on_progress, interruption.requested)
        except SolveFailed as failure:
            raise RunFailed(str(failure), None) from failure
    console.print(comparison.table())
