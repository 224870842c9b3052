"""Limits of the scorecard: one editable file, each with its source; a figure beyond one is marked, nothing more."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.errors import BadInput, Fault
from scenarios.faults import validate_section
from scenarios.layers import Merged, read_toml
from scenarios.names import nearest
from scenarios.wsp_test.results import METRICS, Result

LIMITS = Path(__file__).with_name("limits.toml")
EVERYWHERE = "*"


class Limit(BaseModel):
    """One limit: a metric of the scorecard, its bound, the limit groups of stops that it applies to, and its source."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    metric: str
    at_most: float | None = None
    at_least: float | None = None
    unit: str = Field(description="the metric's, for whoever reads the file")
    applies_to: tuple[str, ...] = Field(
        min_length=1, description=f"limit groups of the programme, or {EVERYWHERE} for all"
    )
    known: Literal["quoted", "second-hand", "own"] = Field(
        description="quoted from its source, known at second hand (shown with M), or this project's own"
    )
    source: str = Field(min_length=10, description="where the figure comes from, in words")

    @model_validator(mode="after")
    def _names_a_metric_and_a_bound(self) -> Self:
        metric = METRICS.get(self.metric)
        if metric is None:
            best = nearest(self.metric, METRICS)
            hint = f"did you mean {' or '.join(best)}? " if best else ""
            raise ValueError(f"metric = {self.metric!r}: no such metric; {hint}there are {', '.join(METRICS)}")
        if self.unit != metric.unit:
            raise ValueError(f"unit = {self.unit!r}: {self.metric} has the unit {metric.unit!r}")
        if (self.at_most is None) == (self.at_least is None):
            raise ValueError("at_most: exactly one of at_most and at_least is needed")
        return self

    @property
    def bound(self) -> float:
        return self.at_most if self.at_most is not None else self.at_least if self.at_least is not None else math.nan

    @property
    def mark(self) -> str:
        """The bound in short, with M where it is known at second hand."""
        sign = "<=" if self.at_most is not None else ">="
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{sign} {self.bound:g}{unit}" + (" (M)" if self.known == "second-hand" else "")

    def applies(self, groups: tuple[str, ...]) -> bool:
        """Whether it counts for a stop of these limit groups."""
        return EVERYWHERE in self.applies_to or any(group in self.applies_to for group in groups)

    def exceeded(self, value: float) -> bool:
        """Whether the value lies beyond, rounding aside."""
        room = 1e-9 * abs(self.bound)
        return value > self.bound + room if self.at_most is not None else value < self.bound - room


class LimitFile(BaseModel):
    """The whole file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    limits: tuple[Limit, ...] = ()


@dataclass(frozen=True)
class Beyond:
    """A figure beyond its limit; without limit: the coach did not come to a standstill."""

    metric: str
    value: float | None
    limit: Limit | None

    def __str__(self) -> str:
        if self.limit is None:
            return "no standstill"
        return f"{METRICS[self.metric].about} {self.value:.3g}, {self.limit.mark}"


def load_limits(path: Path, groups: set[str]) -> tuple[Limit, ...]:
    """The limits of a file; `groups` are the limit groups that the programme uses.

    Raises BadInput with every fault, a group that no stop is in among them.
    """
    tree = read_toml(path)
    merged = Merged(tree, {(): str(path)})
    faults: list[Fault] = []
    built = validate_section(LimitFile, tree, (), merged, faults)
    if built is not None:
        for k, limit in enumerate(built.limits):
            for group in limit.applies_to:
                if group != EVERYWHERE and group not in groups:
                    message = f"no stop of the programme is in this limit group; there are {', '.join(sorted(groups))}"
                    faults.append(Fault(str(path), f"limits.{k}.applies_to = {group!r}", message))
    if built is None or faults:
        raise BadInput(*faults)
    return built.limits


def beyond(result: Result, limits: tuple[Limit, ...]) -> list[Beyond]:
    """What of a stop lies beyond its limits. A figure that the stop does not have is beyond none."""
    found = [] if result.score.ended == "standstill" else [Beyond("distance_m", None, None)]
    for limit in limits:
        value = METRICS[limit.metric].value(result) if limit.applies(result.stop.limits) else None
        if value is not None and limit.exceeded(value):
            found.append(Beyond(limit.metric, value, limit))
    return found
