"""Scored stops beside their dry reference: the flat figures that tables, files and limits name."""

from collections.abc import Callable
from dataclasses import dataclass

from scenarios.wsp_test.programme import Stop
from scenarios.wsp_test.scorecard import BrakeStretch, Score, WheelsetScore

STRIP_SHORTEST_S = 10.0
"""Shorter stretches of constant demand say little about the brake's performance."""


@dataclass(frozen=True)
class Result:
    """A stop, its score, and that of the dry reference of its speed and load."""

    stop: Stop
    score: Score
    dry: Score | None

    @property
    def dry_distance_m(self) -> float | None:
        return self.dry.distance_m if self.dry is not None and self.stop.compares_with_dry else None

    @property
    def required_ratio(self) -> float | None:
        """Braking ratio of full service, as the dry reference has it in its longest stretch."""
        stretches = self.dry.stretches if self.dry is not None else ()
        longest = max(stretches, key=lambda stretch: stretch.duration_s, default=None)
        return longest.braking_ratio / longest.demand if longest is not None else None

    def performance(self, stretch: BrakeStretch) -> float | None:
        """(achieved - required)/required of a stretch: required is its demand's share of what full service does dry."""
        if self.required_ratio is None:
            return None
        required = stretch.demand * self.required_ratio
        return (stretch.braking_ratio - required) / required

    def performances(self) -> list[tuple[BrakeStretch, float]]:
        """Every stretch of 10 s and more with its performance."""
        both = [(s, self.performance(s)) for s in self.score.stretches if s.duration_s >= STRIP_SHORTEST_S]
        return [(stretch, value) for stretch, value in both if value is not None]


@dataclass(frozen=True)
class Metric:
    """A figure of a stop: its unit, what it is, and how it is had from a result."""

    unit: str
    about: str
    value: Callable[[Result], float | None]


def _ratio(part: float | None, whole: float | None) -> float | None:
    return part / whole if part is not None and whole is not None and whole > 0.0 else None


def _worst(of: Callable[[WheelsetScore], float | None]) -> Callable[[Result], float | None]:
    def worst(result: Result) -> float | None:
        known = [value for value in map(of, result.score.wheelsets) if value is not None]
        return max(known, default=None)

    return worst


def _sum(of: Callable[[WheelsetScore], float]) -> Callable[[Result], float | None]:
    return lambda result: float(sum(map(of, result.score.wheelsets)))


def _mean_slip_error(result: Result) -> float | None:
    known = [w.slip_error for w in result.score.wheelsets if w.slip_error is not None]
    return sum(known) / len(known) if known else None


def _worst_performance(result: Result) -> float | None:
    return min((value for _, value in result.performances()), default=None)


METRICS: dict[str, Metric] = {
    "distance_m": Metric("m", "stopping distance", lambda r: r.score.distance_m),
    "dry_distance_m": Metric("m", "stopping distance on dry rail", lambda r: r.dry_distance_m),
    "shortest_distance_m": Metric("m", "shortest possible on this rail", lambda r: r.score.shortest_distance_m),
    "distance_over_dry": Metric("1", "distance over dry", lambda r: _ratio(r.score.distance_m, r.dry_distance_m)),
    "distance_over_shortest": Metric(
        "1", "distance over the shortest possible", lambda r: _ratio(r.score.distance_m, r.score.shortest_distance_m)
    ),
    "adhesion_utilisation": Metric("1", "brake force over adhesion on offer", lambda r: r.score.adhesion_utilisation),
    "slip_error": Metric("1", "mean |slip - slip of the peak|, mean of the wheelsets", _mean_slip_error),
    "largest_slip": Metric("1", "largest slip above 10 km/h", _worst(lambda w: w.largest_slip)),
    "longest_lock_s": Metric("s", "longest lock above 30 km/h", _worst(lambda w: w.longest_lock_s)),
    "locked_s": Metric("s", "time locked above 30 km/h, worst wheelset", _worst(lambda w: w.locked_s)),
    "sliding_distance_m": Metric("m", "sliding distance, worst wheelset", _worst(lambda w: w.sliding_distance_m)),
    "sliding_s": Metric("s", "time of slide events", lambda r: r.score.sliding_s),
    "friction_energy_kj": Metric("kJ", "friction energy of all wheels", _sum(lambda w: sum(w.friction_energy_kj))),
    "wheel_friction_energy_kj": Metric(
        "kJ", "friction energy, worst wheel", _worst(lambda w: max(w.friction_energy_kj))
    ),
    "flat_risk_mnm": Metric("MN m", "flat risk, worst wheel", _worst(lambda w: max(w.flat_risk_mnm))),
    "valve_operations": Metric("1", "valve operations of all axles", _sum(lambda w: float(w.valve_operations))),
    "air_nl": Metric("nl", "normal litres of air", lambda r: r.score.air_nl),
    "reference_error_rms_kmh": Metric("km/h", "reference speed error, rms", lambda r: r.score.reference_error_rms_kmh),
    "reference_error_worst_kmh": Metric(
        "km/h", "reference speed error, worst", lambda r: r.score.reference_error_worst_kmh
    ),
    "longest_unfilled_s": Metric("s", "longest time without filling", _worst(lambda w: w.longest_unfilled_s)),
    "longest_unfilled_command_s": Metric(
        "s", "longest command without filling", _worst(lambda w: w.longest_unfilled_command_s)
    ),
    "safety_timer_s": Metric("s", "time under the valves' safety timer", _worst(lambda w: w.safety_timer_s)),
    "least_reservoir_bar": Metric("bar", "least reservoir pressure", lambda r: r.score.least_reservoir_bar),
    "hottest_disc_degc": Metric("degC", "hottest disc", lambda r: r.score.hottest_disc_degc),
    "longest_vent_s": Metric("s", "longest venting without a break", _worst(lambda w: w.longest_vent_s)),
    "drag_speed_change_kmh": Metric("km/h", "change of speed while dragging", lambda r: r.score.drag_speed_change_kmh),
    "brake_performance": Metric("1", "least (achieved - required)/required, 10 s and more", _worst_performance),
}
"""Name in files and limits -> the figure. Where each wheelset has one, the worst counts unless it says otherwise."""
