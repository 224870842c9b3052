"""Replayed valve commands: what is answered when, and which records are refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from wsp import FILL
from wsp.controllers.replay import Replay, ReplayParameters

TICKS = 200


def record(path: Path, rows_per_tick: int = 1, **changed: Any) -> tuple[Path, np.ndarray]:
    """A record of random commands that change at ticks alone, and the commands (TICKS, 4)."""
    commands = np.random.default_rng(3).integers(0, 3, (TICKS, 4)).astype(np.int8)
    in_force = np.repeat(commands, rows_per_tick, axis=0)
    columns: dict[str, Any] = {"t_s": 0.01 / rows_per_tick * np.arange(TICKS * rows_per_tick)}
    columns |= {f"valve_command_{axle + 1}": in_force[:, axle] for axle in range(4)}
    columns |= changed
    pq.write_table(pa.table({name: values for name, values in columns.items() if values is not None}), path)
    return path, commands


def answers(controller: Replay, t_s: float) -> Any:
    return controller.step(t_s, np.zeros(4), np.ones(4, bool), 1.0, 1, np.nan)


@pytest.mark.parametrize("rows_per_tick", [1, 2, 20])
def test_a_tick_is_answered_by_what_was_in_force_at_the_next(tmp_path: Path, rows_per_tick: int) -> None:
    path, commands = record(tmp_path / "brake.parquet", rows_per_tick)
    for file in (path, tmp_path):
        controller = Replay(ReplayParameters(file=str(file)))
        controller.reset(0.0, 1)
        for tick in range(TICKS - 1):
            assert answers(controller, tick * 0.01).valve.tolist() == commands[tick + 1].tolist()
        for tick in (TICKS, TICKS + 100):
            assert answers(controller, tick * 0.01).valve.tolist() == [FILL] * 4


def test_sand_track_brake_and_reference_are_given_as_far_as_recorded(tmp_path: Path) -> None:
    path, _ = record(
        tmp_path / "brake.parquet",
        sand_command_2=np.arange(TICKS) % 2,
        track_brake_command=np.arange(TICKS) >= 100,
        reference_speed_mps=np.arange(TICKS) * 0.5,
    )
    controller = Replay(ReplayParameters(file=str(path)))
    early, late = (
        (answer.sand.tolist(), answer.track_brake, answer.reference_speed_mps)
        for answer in (answers(controller, t_s) for t_s in (0.50, 1.01))
    )
    assert early == ([False, True, False, False], False, 25.0)
    assert late == ([False, False, False, False], True, 50.5)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"valve_command_3": None}, "has no valve_command_3"),
        ({"valve_command_3": np.full(TICKS, 4)}, "valve commands other than"),
        ({"t_s": 0.02 * np.arange(TICKS)}, "a row each 0.01 s"),
        ({"t_s": np.zeros(TICKS)}, "in the order of time"),
    ],
)
def test_records_that_cannot_be_replayed(tmp_path: Path, changed: dict[str, Any], message: str) -> None:
    path, _ = record(tmp_path / "brake.parquet", **changed)
    with pytest.raises(ValueError, match=f"parameters.file = .*{message}"):
        Replay(ReplayParameters(file=str(path)))


def test_files_that_are_none(tmp_path: Path) -> None:
    (tmp_path / "text.parquet").write_text("not Parquet")
    for name in (".", "gone.parquet", "gone/brake.parquet", "text.parquet"):
        with pytest.raises(ValueError, match="^parameters.file = "):
            Replay(ReplayParameters(file=str(tmp_path / name)))
