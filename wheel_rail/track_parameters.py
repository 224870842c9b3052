"""Parameters of the line: curves with their transitions and cant, gradients with their roundings, irregularities.

Curves and gradients stand in the scenario file, or in CSV files named by `curves_file` and `gradients_file`, whose
columns are called as the keys are (`wheel_rail.track_files`).
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wheel_rail.irregularity_parameters import IrregularityParameters
from wheel_rail.track_files import read_entries
from wheel_rail.transitions import TRANSITIONS, TransitionKind

RAIL_SPACING_M = 1.5  # between the rails' running lines; cant is measured over it
TIGHTEST_CURVE_M = 80.0
MOST_CANT_MM = 200.0
STEEPEST_GRADIENT_PERMILLE = 100.0
STEEPEST_RAMP_MMPM = 5.0  # twice what lines are built with
TIGHTEST_VERTICAL_M = 300.0  # the hump of a marshalling yard
USUAL_ROUNDING_M = 50.0
JOINT_GAP_M = 1e-6  # between curves that join: what the rounding of their lengths may leave


class Curve(BaseModel):
    """A circular curve between two transitions; cant grows and falls with them.

    A curve that `joins_previous` begins where the circular part of the curve before ends: its first transition and
    cant ramp lead from that curve's radius and cant to its own (compound curve, or reverse curve through curvature
    zero), and that curve has a first transition alone.

    Its length is given by `length_m` or `end_m`, its transitions by `transition_m` or one by one. Cant ramps are as
    long and of the same kind as the transitions; one with a length of its own ends (begins) where the circular part
    begins (ends), so that a longer one reaches out into the straight.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    start_m: float = Field(ge=0.0, description="begin of the first transition")
    joins_previous: bool = Field(default=False, description="comes from the curve before, not from straight track")
    end_m: float | None = Field(default=None, description="end of the second transition, or of the circle without one")
    length_m: float | None = Field(default=None, ge=0.0, description="of the circular part")
    radius_m: float = Field(description="positive to the left, negative to the right")
    transition_m: float | None = Field(default=None, gt=0.0, description="length of both transitions")
    transition_in_m: float | None = Field(default=None, gt=0.0, description="length of the first transition")
    transition_out_m: float | None = Field(default=None, gt=0.0, description="length of the second transition")
    transition_kind: TransitionKind = "clothoid"
    cant_mm: float = Field(default=0.0, description="positive with the right rail raised")
    cant_ramp_in_m: float | None = Field(default=None, gt=0.0, description="length of the first cant ramp")
    cant_ramp_out_m: float | None = Field(default=None, gt=0.0, description="length of the second cant ramp")

    @model_validator(mode="after")
    def _is_a_railway_curve(self) -> Self:
        if self.transition_m is None and self.transition_in_m is None:
            raise ValueError("transition_m: it, or both transition_in_m and transition_out_m, must be given")
        if self.transition_m is not None and (self.transition_in_m or self.transition_out_m):
            raise ValueError("transition_m: stands for both; leave out transition_in_m and transition_out_m")
        if (self.length_m is None) == (self.end_m is None):
            raise ValueError("length_m: either it (of the circular part) or end_m (of the whole curve) must be given")
        if abs(self.radius_m) < TIGHTEST_CURVE_M:
            raise ValueError(f"radius_m = {self.radius_m}: the tightest curve allowed is {TIGHTEST_CURVE_M:g} m")
        if abs(self.cant_mm) > MOST_CANT_MM:
            raise ValueError(f"cant_mm = {self.cant_mm}: at most {MOST_CANT_MM:g} mm")
        if self.circle_end_m < self.circle_start_m - 1e-9:
            raise ValueError(
                f"end_m = {self.end_m}: the transitions, {self.entry_m:g} + {self.exit_m:g} m, are longer than the "
                f"curve, {self.last_m - self.start_m:g} m"
            )
        if not self.joins_previous:
            self._check_ramp("in", self.ramp_in_m, self.cant_mm)
        if self.exit_m > 0.0:
            self._check_ramp("out", self.ramp_out_m, self.cant_mm)
        return self

    def _check_ramp(self, name: str, ramp_m: float, change_mm: float, key: str = "") -> None:
        steepness = abs(change_mm) * TRANSITIONS[self.transition_kind].steepest / ramp_m
        if steepness > STEEPEST_RAMP_MMPM:
            raise ValueError(
                f"{key}cant_mm = {self.cant_mm}: its ramp {name}, {ramp_m:g} m, is too steep: {steepness:.2f} mm/m, at "
                f"most {STEEPEST_RAMP_MMPM:g}"
            )

    def check_joint(self, before: "Curve", key: str) -> None:
        """Raise ValueError if it cannot join the curve `before`; `key` is its own, for messages."""
        if before.exit_m > 0.0:
            raise ValueError(
                f"{key}.joins_previous = true: the curve before has a transition out, {before.exit_m:g} m long; it "
                "needs transition_in_m alone"
            )
        if before.cant_ramp_out_m is not None:
            raise ValueError(
                f"{key}.joins_previous = true: the curve before has cant_ramp_out_m = {before.cant_ramp_out_m}; leave "
                "it out, the ramp between the two is that of cant_ramp_in_m here"
            )
        gap_m = self.start_m - before.circle_end_m
        if abs(gap_m) > JOINT_GAP_M:
            raise ValueError(
                f"{key}.start_m = {self.start_m}: {'a gap of' if gap_m > 0.0 else 'overlaps by'} {abs(gap_m):.6g} m; a "
                f"curve that joins the one before must begin where the circular part of that ends, at "
                f"{before.circle_end_m:.12g}"
            )
        ramp_begin_m = self.circle_start_m - self.ramp_in_m
        if ramp_begin_m < before.circle_start_m - JOINT_GAP_M:
            raise ValueError(
                f"{key}.cant_ramp_in_m = {self.ramp_in_m}: begins at {ramp_begin_m:g}, where the curve before has not "
                f"all of its cant yet; at most {self.circle_start_m - before.circle_start_m:g}"
            )
        name = f"in from the {before.cant_mm:g} mm before"
        self._check_ramp(name, self.ramp_in_m, self.cant_mm - before.cant_mm, f"{key}.")

    @property
    def entry_m(self) -> float:
        """Length of the first transition."""
        return self.transition_m if self.transition_m is not None else self.transition_in_m or 0.0

    @property
    def exit_m(self) -> float:
        """Length of the second transition; 0 without one, where the next curve joins."""
        return self.transition_m if self.transition_m is not None else self.transition_out_m or 0.0

    @property
    def circle_start_m(self) -> float:
        return self.start_m + self.entry_m

    @property
    def circle_end_m(self) -> float:
        return self.circle_start_m + self.length_m if self.length_m is not None else self.last_m - self.exit_m

    @property
    def last_m(self) -> float:
        """Where the second transition ends."""
        return self.end_m if self.end_m is not None else self.circle_end_m + self.exit_m

    @property
    def ramp_in_m(self) -> float:
        return self.cant_ramp_in_m or self.entry_m

    @property
    def ramp_out_m(self) -> float:
        return self.cant_ramp_out_m or self.exit_m

    @property
    def reach_m(self) -> tuple[float, float]:
        """Where curvature or cant begin and end."""
        if self.cant_mm == 0.0:
            return self.start_m, self.last_m
        return (
            min(self.start_m, self.circle_start_m - self.ramp_in_m),
            max(self.last_m, self.circle_end_m + self.ramp_out_m),
        )

    @property
    def full_roll_rad(self) -> float:
        """Roll of the track plane in the circular part, positive with the left rail up."""
        return -math.asin(self.cant_mm / 1000.0 / RAIL_SPACING_M)


class GradientChange(BaseModel):
    """From `from_m` on the gradient is `gradient_permille`; the change is rounded by a parabola centred there.

    The parabola's length is `rounding_m`, or follows from its radius `vertical_radius_m`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    from_m: float = Field(ge=0.0)
    gradient_permille: float = Field(
        ge=-STEEPEST_GRADIENT_PERMILLE, le=STEEPEST_GRADIENT_PERMILLE, description="positive uphill"
    )
    rounding_m: float | None = Field(default=None, gt=0.0, description="length of the vertical curve; usually 50")
    vertical_radius_m: float | None = Field(default=None, ge=TIGHTEST_VERTICAL_M, description="in place of rounding_m")

    @model_validator(mode="before")
    @classmethod
    def _usual_rounding(cls, values: Any) -> Any:
        if isinstance(values, dict) and values.get("rounding_m") is None and values.get("vertical_radius_m") is None:
            return {**values, "rounding_m": USUAL_ROUNDING_M}
        return values

    @model_validator(mode="after")
    def _one_rounding(self) -> Self:
        if self.rounding_m is not None and self.vertical_radius_m is not None:
            raise ValueError("rounding_m: either it or vertical_radius_m must be given, not both")
        return self


class TrackParameters(BaseModel):
    """A line of `length_m` that starts straight; level (or `initial_gradient_permille`) until the first change."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    length_m: float = Field(gt=0.0, le=100_000.0)
    initial_gradient_permille: float = Field(default=0.0, ge=-STEEPEST_GRADIENT_PERMILLE, le=STEEPEST_GRADIENT_PERMILLE)
    curves: tuple[Curve, ...] = ()
    curves_file: str | None = Field(default=None, description="CSV file in place of curves")
    gradients: tuple[GradientChange, ...] = ()
    gradients_file: str | None = Field(default=None, description="CSV file in place of gradients")
    irregularities: IrregularityParameters | None = Field(default=None, description="smooth rails without")

    @model_validator(mode="before")
    @classmethod
    def _files_are_read(cls, values: Any) -> Any:
        """The entries of the files take the files' place: what is validated stands for itself."""
        if not isinstance(values, dict):
            return values
        read = dict(values)
        for key, model in (("curves", Curve), ("gradients", GradientChange)):
            name = read.get(f"{key}_file")
            if isinstance(name, str):
                if read.get(key):
                    raise ValueError(f"{key}_file = {name}: leave out {key} (or set it to []), or the file")
                read[key] = read_entries(name, f"{key}_file", model)
                if key == "curves":
                    check_order(read[key], f"curves_file = {name}: ")
                del read[f"{key}_file"]
            elif isinstance(read.get(key), list):
                read[key] = tuple(read[key])  # strict validation takes no list from here on
        return read

    @model_validator(mode="after")
    def _nothing_overlaps(self) -> Self:
        last_m = check_order(self.curves)
        if last_m > self.length_m:
            raise ValueError(f"curves: reach to {last_m} m, beyond length_m = {self.length_m}")
        end = 0.0
        for k, (change, rounding) in enumerate(zip(self.gradients, self.roundings(), strict=True)):
            start, reaches_m, before, after = rounding
            length = reaches_m - start
            if start < end - 1e-9:
                raise ValueError(
                    f"gradients.{k}.from_m = {change.from_m}: its vertical curve overlaps the one before or the start, "
                    f"which reaches to {end:g}"
                )
            if length < TIGHTEST_VERTICAL_M * abs(after - before) - 1e-9:
                raise ValueError(
                    f"gradients.{k}.rounding_m = {length:g}: too short for a change of {1000 * (after - before):g} per "
                    f"mille: its radius is {length / abs(after - before):.0f} m, at least {TIGHTEST_VERTICAL_M:g}"
                )
            end = reaches_m
        if end > self.length_m:
            raise ValueError(f"gradients: reach to {end} m, beyond length_m = {self.length_m}")
        if self.irregularities is not None:
            self.irregularities.span_m(self.length_m)
        return self

    def roundings(self) -> Iterator[tuple[float, float, float, float]]:
        """Of every gradient change: where its rounding begins and ends, and the gradients before and after (-)."""
        before = self.initial_gradient_permille / 1000.0
        for change in self.gradients:
            after = change.gradient_permille / 1000.0
            length = change.rounding_m
            if length is None:
                length = (change.vertical_radius_m or 0.0) * abs(after - before)
            yield change.from_m - 0.5 * length, change.from_m + 0.5 * length, before, after
            before = after


def check_order(curves: Sequence[Curve], place: str = "") -> float:
    """Where the last of the curves ends (m). Raises ValueError, with `place` in front, if they do not fit together."""
    end_m = 0.0
    for k, curve in enumerate(curves):
        key = f"{place}curves.{k}"
        start_m, reaches_m = curve.reach_m
        if curve.joins_previous:
            if k == 0:
                raise ValueError(f"{key}.joins_previous = true: there is no curve before the first")
            curve.check_joint(curves[k - 1], key)
        elif start_m < end_m - 1e-9:
            raise ValueError(
                f"{key}.start_m = {curve.start_m}: the curve with its cant ramps begins at {start_m:g} and "
                f"overlaps {f'the curve before, which ends at {end_m:g}' if k else 'the begin of the line'}"
            )
        if curve.exit_m == 0.0 and not (k + 1 < len(curves) and curves[k + 1].joins_previous):
            raise ValueError(
                f"{key}.transition_m: it, or both transition_in_m and transition_out_m, must be given; "
                "transition_in_m alone where the next curve has joins_previous = true"
            )
        end_m = reaches_m
    return end_m


def curve_ends(curves: Sequence[Curve]) -> list[float]:
    """Every place where a transition or a cant ramp begins or ends."""
    return [
        place
        for c in curves
        for place in (c.start_m, c.circle_start_m, c.circle_end_m, c.last_m, *c.reach_m,
                      c.circle_start_m - c.ramp_in_m, c.circle_end_m + c.ramp_out_m)
    ]  # fmt: skip
