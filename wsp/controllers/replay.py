"""`replay`: the valve commands of an earlier run, so that the same scenario repeats to the sample."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from wsp.controllers.interface import AXLES, ControllerOutput
from wsp.valves import FILL, VENT

_VALVES = [f"valve_command_{axle}" for axle in range(1, AXLES + 1)]
_SAND = [f"sand_command_{axle}" for axle in range(1, AXLES + 1)]
_TRACK_BRAKE = "track_brake_command"
_REFERENCE = "reference_speed_mps"


class ReplayParameters(BaseModel):
    """Which run."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    file: str = Field(min_length=1, description="brake.parquet of a run, or the run's folder")


class Replay:
    """Recorded valve commands (and sand, track brake, reference speed, as far as recorded), whatever the axles do.

    The record says what was in force at t; what is answered at one tick acts from the next one on, so at the tick t
    the answer is what was in force at t + 0.01 s. Beyond the end of the record every axle is filled.
    """

    Parameters = ReplayParameters
    period_s = 0.01

    def __init__(self, parameters: ReplayParameters) -> None:
        """Raises ValueError that begins with the key `parameters.file`."""
        self.parameters = parameters
        path = Path(parameters.file)
        path = path / "brake.parquet" if path.is_dir() else path
        try:
            self._record = _Record(path)
        except ValueError as error:
            raise ValueError(f"parameters.file = {parameters.file!r}: {error}") from None
        self._output = ControllerOutput()

    def reset(self, t_s: float, direction: int) -> None:
        """Nothing is carried over: the record is found by its time."""

    def step(
        self,
        t_s: float,
        axle_speed_mps: NDArray[np.float64],
        valid: NDArray[np.bool_],
        demand: float,
        direction: int,
        outside_reference_mps: float,
    ) -> ControllerOutput:
        """What was recorded for the next tick; the reference speed, which is not a command, for this one."""
        record, output = self._record, self._output
        now, then = record.row(t_s), record.row(t_s + self.period_s)
        output.valve[:] = FILL if then is None else record.valve[then]
        output.sand[:] = False if then is None else record.sand[then]
        output.track_brake = then is not None and bool(record.track_brake[then])
        output.reference_speed_mps = np.nan if now is None else float(record.reference_mps[now])
        return output


class _Record:
    """The columns of a brake.parquet that a controller answers, by time."""

    def __init__(self, path: Path) -> None:
        columns = _read(path)
        missing = [name for name in ("t_s", *_VALVES) if name not in columns]
        if missing:
            raise ValueError(f"has no {', '.join(missing)}: must be brake.parquet of a run")
        self.t_s = columns["t_s"].astype(float)
        rows = len(self.t_s)
        if rows < 2 or not np.all(np.diff(self.t_s) > 0.0) or not np.max(np.diff(self.t_s)) < Replay.period_s + 1e-6:
            raise ValueError(f"must have a row each {Replay.period_s} s or more often, in the order of time")
        self.valve = np.stack([columns[name] for name in _VALVES], axis=1)
        if not np.isin(self.valve, range(FILL, VENT + 1)).all():
            raise ValueError("holds valve commands other than 0 (fill), 1 (hold), 2 (vent)")
        nothing = np.zeros(rows, bool)
        self.sand = np.stack([columns.get(name, nothing) for name in _SAND], axis=1)
        self.track_brake = columns.get(_TRACK_BRAKE, nothing)
        self.reference_mps = columns.get(_REFERENCE, np.full(rows, np.nan))

    def row(self, t_s: float) -> int | None:
        """The last row at or before t; None beyond the record."""
        found = int(np.searchsorted(self.t_s, t_s + 1e-6)) - 1
        over = found == len(self.t_s) - 1 and t_s > self.t_s[-1] + 0.5 * Replay.period_s
        return None if found < 0 or over else found


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise ValueError(f"there is no file {path.name} there" if path.parent.is_dir() else "there is no such file")
    import pyarrow as pa  # slow to import, and no other controller needs it
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path)
    except (OSError, pa.ArrowException) as error:
        raise ValueError(f"cannot be read as Parquet: {error}") from None
    return {name: table.column(name).to_numpy() for name in table.column_names}
