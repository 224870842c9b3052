"""Faults of a scenario at work: each is put in at its time and taken out again."""

from collections.abc import Callable, Sequence

from scenarios.cosimulation.fault_entries import (
    BrakeCutOut,
    ControllerDead,
    FaultEntry,
    LowReservoir,
    PipeLeak,
    TachometerFrozen,
    TachometerLost,
    ToothCount,
    ValveStuck,
    WheelDiameter,
)
from sensors import Tachometers
from wsp import Brake

_ROUNDING_S = 1e-9


class FaultsAtWork:
    """Puts faults into brake plant and tachometers as their time comes; `controller_dead` tells the loop."""

    def __init__(self, entries: Sequence[FaultEntry], brake: Brake, tachometers: Tachometers) -> None:
        self._brake = brake
        self._tachometers = tachometers
        self._dead = 0
        self.controller_dead = False
        """Whether the controller has stopped to answer."""
        events: list[tuple[float, Callable[[], None]]] = []
        for entry in entries:
            comes, goes = self._switch(entry)
            events.append((entry.at_s, comes))
            if entry.until_s is not None:
                events.append((entry.until_s, goes))
        # of two at the same time the one that stands first in the file acts first
        self._events = sorted(events, key=lambda event: event[0])
        self.next_s = self._events[0][0] if self._events else float("inf")

    def step(self, t_s: float) -> None:
        """Put in and take out what is due at `t_s`; to be called when `next_s` is reached."""
        while self._events and self._events[0][0] <= t_s + _ROUNDING_S:
            _, act = self._events.pop(0)
            act()
        self.next_s = self._events[0][0] if self._events else float("inf")

    def _kill(self, count: int) -> None:
        self._dead += count
        self.controller_dead = self._dead > 0

    def _switch(self, entry: FaultEntry) -> tuple[Callable[[], None], Callable[[], None]]:
        """What brings a fault and what takes it away."""
        brake, tachometers = self._brake, self._tachometers
        match entry:
            case ValveStuck(axle=axle, valve=valve, position=position):
                return (
                    lambda: brake.stick_valve(axle - 1, valve, position),
                    lambda: brake.stick_valve(axle - 1, valve, None),
                )
            case TachometerLost(axle=axle):
                return lambda: tachometers.lose(axle - 1), lambda: tachometers.restore(axle - 1)
            case TachometerFrozen(axle=axle):
                return lambda: tachometers.freeze(axle - 1), lambda: tachometers.restore(axle - 1)
            case ToothCount(axle=axle, teeth=teeth):
                return lambda: tachometers.believe(axle - 1, teeth=teeth), lambda: tachometers.believe(axle - 1)
            case WheelDiameter(axle=axle, diameter_mm=diameter):
                return (
                    lambda: tachometers.believe(axle - 1, radius_m=0.0005 * diameter),
                    lambda: tachometers.believe(axle - 1),
                )
            case PipeLeak(axle=axle, conductance_dm3psbar=conductance):
                return lambda: brake.leak(axle - 1, conductance), lambda: brake.leak(axle - 1, 0.0)
            case LowReservoir(pressure_bar=pressure):
                return lambda: brake.fail_supply(pressure), lambda: brake.fail_supply(None)
            case BrakeCutOut(axle=axle):
                return lambda: brake.cut_out(axle - 1, True), lambda: brake.cut_out(axle - 1, False)
            case ControllerDead():
                return lambda: self._kill(1), lambda: self._kill(-1)
