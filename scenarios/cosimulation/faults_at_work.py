"""Faults of a scenario at work: each is put in at its time and taken out again."""

from collections.abc import Sequence

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
    """Puts faults into brake plant and tachometers as their time comes; `controller_dead` tells the loop.

    Where several entries concern the same part at a time, the one that stands last in the file rules, leaks add up, and
    teeth and wheel diameter count together.
    """

    def __init__(self, entries: Sequence[FaultEntry], brake: Brake, tachometers: Tachometers) -> None:
        self._brake = brake
        self._tachometers = tachometers
        self.controller_dead = False
        """Whether the controller has stopped to answer."""
        self._entries = tuple(entries)
        self._active = [False] * len(self._entries)
        times = {entry.at_s for entry in entries} | {entry.until_s for entry in entries if entry.until_s is not None}
        self._times = sorted(times)
        self.next_s = self._times[0] if self._times else float("inf")

    def step(self, t_s: float) -> None:
        """Put in and take out what is due at `t_s`; to be called when `next_s` is reached."""
        now_s = t_s + _ROUNDING_S
        for k, entry in enumerate(self._entries):
            active = entry.at_s <= now_s and not (entry.until_s is not None and entry.until_s <= now_s)
            if active != self._active[k]:
                self._active[k] = active
                self._set(entry)
        self._times = [time for time in self._times if time > now_s]
        self.next_s = self._times[0] if self._times else float("inf")

    def _set(self, changed: FaultEntry) -> None:
        """Bring the part that an entry concerns into the state that all active entries on it give."""
        brake, tachometers = self._brake, self._tachometers
        part = _part_of(changed)
        alike = [entry for k, entry in enumerate(self._entries) if self._active[k] and _part_of(entry) == part]
        ruling = alike[-1] if alike else None
        match changed:
            case ValveStuck(axle=axle, valve=valve):
                brake.stick_valve(axle - 1, valve, ruling.position if isinstance(ruling, ValveStuck) else None)
            case TachometerLost(axle=axle) | TachometerFrozen(axle=axle):
                if isinstance(ruling, TachometerLost):
                    tachometers.lose(axle - 1)
                elif isinstance(ruling, TachometerFrozen):
                    tachometers.freeze(axle - 1)
                else:
                    tachometers.restore(axle - 1)
            case ToothCount(axle=axle) | WheelDiameter(axle=axle):
                teeth = [entry.teeth for entry in alike if isinstance(entry, ToothCount)]
                diameters_mm = [entry.diameter_mm for entry in alike if isinstance(entry, WheelDiameter)]
                tachometers.believe(
                    axle - 1,
                    teeth=teeth[-1] if teeth else None,
                    radius_m=0.0005 * diameters_mm[-1] if diameters_mm else None,
                )
            case PipeLeak(axle=axle):
                brake.leak(axle - 1, sum(entry.conductance_dm3psbar for entry in alike if isinstance(entry, PipeLeak)))
            case LowReservoir():
                brake.fail_supply(ruling.pressure_bar if isinstance(ruling, LowReservoir) else None)
            case BrakeCutOut(axle=axle):
                brake.cut_out(axle - 1, bool(alike))
            case ControllerDead():
                self.controller_dead = bool(alike)


def _part_of(entry: FaultEntry) -> tuple[object, ...]:
    """What an entry concerns: entries on one part act together."""
    match entry:
        case ValveStuck(axle=axle, valve=valve):
            return "valve", axle, valve
        case TachometerLost(axle=axle) | TachometerFrozen(axle=axle):
            return "tachometer", axle
        case ToothCount(axle=axle) | WheelDiameter(axle=axle):
            return "front end", axle
        case PipeLeak(axle=axle):
            return "pipe", axle
        case BrakeCutOut(axle=axle):
            return "brake", axle
        case _:
            return (entry.kind,)
