"""One published (or closed-form) figure and how the project comes to it: shared by the tests and `railslide verify`."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """A row of the validation table.

    `expected`: the figure, in `unit`, or lower and upper bounds that must hold as they are. `tolerance`: of the error,
    in `unit`, or a share of the figure if `relative`; `obtain` computes the figure anew. `known_deviation`: why a row
    that misses its tolerance stands all the same, None for all others.
    """

    id: str
    group: str
    quantity: str
    source: str
    expected: float | tuple[float, float]
    unit: str
    obtain: Callable[[], float]
    tolerance: float = 0.0
    relative: bool = False
    known_deviation: str | None = None

    def error(self, obtained: float) -> float:
        """Obtained less expected, as a share of the expected if `relative`; how far beyond its bound otherwise."""
        if isinstance(self.expected, tuple):
            lower, upper = self.expected
            return min(obtained - lower, 0.0) + max(obtained - upper, 0.0)
        return (obtained - self.expected) / (abs(self.expected) if self.relative else 1.0)

    def within(self, obtained: float) -> bool:
        """Whether the error stays within the tolerance; a figure that is not a number does not."""
        return abs(self.error(obtained)) <= self.tolerance


@dataclass(frozen=True)
class Outcome:
    """A case and the figure that was obtained for it; `failure`: why there is none (the figure is nan then)."""

    case: Case
    obtained: float
    failure: str | None = None

    @property
    def error(self) -> float:
        return self.case.error(self.obtained)

    @property
    def result(self) -> str:
        """`pass`, `known deviation` or `MISS`."""
        if self.case.within(self.obtained):
            return "pass"
        # not even a known deviation may be no number at all
        known = self.case.known_deviation is not None and math.isfinite(self.obtained)
        return "known deviation" if known else "MISS"
