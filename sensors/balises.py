"""Balises in the track: each tells a position that is known to some accuracy."""

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BaseModel, ConfigDict, Field

from sensors.random_streams import BALISE_SENSOR, random_stream
from sensors.readings import BaliseReadings


class BaliseParameters(BaseModel):
    """Balises at `first_m`, `first_m + spacing_m`, ...; the position told is off by up to `accuracy_m`, uniformly."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    spacing_m: float = Field(default=1000.0, gt=0.0, le=1e6)
    first_m: float = Field(default=0.0, ge=-1e7, le=1e7)
    accuracy_m: float = Field(default=5.0, ge=0.0, le=100.0)


class Balises:
    """The balises of a line. The error of each belongs to its number: every passage of it reads the same."""

    def __init__(self, parameters: BaliseParameters, seed: int) -> None:
        self.parameters = parameters
        self._seed = seed

    def passed(self, t_s: ArrayLike, position_m: ArrayLike) -> BaliseReadings:
        """Balises that a train passes, in either direction, from its true position (n,) over time (n,)."""
        time = np.asarray(t_s, dtype=float)
        place = np.asarray(position_m, dtype=float)
        reached = np.floor((place - self.parameters.first_m) / self.parameters.spacing_m).astype(int)
        times, told = [], []
        for k in np.flatnonzero(np.diff(reached)):
            low, high = sorted((reached[k], reached[k + 1]))
            numbers = range(max(low + 1, 0), high + 1)
            for number in numbers if reached[k + 1] > reached[k] else reversed(numbers):
                at_m = self.parameters.first_m + number * self.parameters.spacing_m
                share = (at_m - place[k]) / (place[k + 1] - place[k])
                times.append(time[k] + share * (time[k + 1] - time[k]))
                told.append(at_m + self._error_m(number))
        return BaliseReadings(t_s=np.array(times), position_m=np.array(told))

    def _error_m(self, number: int) -> float:
        accuracy_m = self.parameters.accuracy_m
        return float(random_stream(self._seed, BALISE_SENSOR, number).uniform(-accuracy_m, accuracy_m))
