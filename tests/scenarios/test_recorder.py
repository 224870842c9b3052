"""The recorder: what was written comes out, over the borders of its blocks, and a long run is in memory once."""

import tracemalloc
import weakref

import numpy as np
import pytest

from scenarios.cosimulation.core import BRAKE_ROW
from scenarios.cosimulation.line import Line
from scenarios.cosimulation.recorder import Recorder
from scenarios.scenario_file import load_scenario
from sensors.streams import Stream, quantities
from vehicle import OBSERVATION
from wheel_rail.adhesion_condition import NO_KIND, past_conditions
from wheel_rail.adhesion_memory import recall_friction
from wheel_rail.lanes import LANES
from wheel_rail.peak_adhesion import offered_adhesion
from wheel_rail.recovery import CONDITION, MU0

ROWS_OF_A_TICK = 2
ROWS = 30_000
ROW_BYTES = OBSERVATION.itemsize + BRAKE_ROW.itemsize


def written() -> tuple[np.ndarray, np.ndarray]:
    """Rows in which every number says where it stands, except that the coach weighs nothing: no peak is looked for."""
    row = np.arange(float(ROWS))
    motion, brake = np.zeros(ROWS, OBSERVATION), np.zeros(ROWS, BRAKE_ROW)
    for rows in (motion, brake):
        for k, name in enumerate(rows.dtype.names or ()):
            width = int(np.prod(rows.dtype[name].shape))
            if rows.dtype[name].base == np.int8:
                values = (row[:, None] + k + np.arange(width)) % 3
            else:
                values = row[:, None] + 0.01 * k + 1e-4 * np.arange(width)
            rows[name] = values.reshape(rows[name].shape)
    motion["normal_force_n"] = motion["rail_kept"] = 0.0
    return motion, brake


def recorded(motion: np.ndarray, brake: np.ndarray) -> tuple[Recorder, list["weakref.ref[np.ndarray]"]]:
    """A recorder that was filled as the loop fills it, and its blocks."""
    recorder = Recorder()
    blocks = list(map(weakref.ref, recorder.block))
    at = 0
    for first in range(0, ROWS, ROWS_OF_A_TICK):
        at = recorder.make_room(at, ROWS_OF_A_TICK)
        if at == 0 and first > 0:
            blocks += map(weakref.ref, recorder.block)
        for block, rows in zip(recorder.block, (motion, brake), strict=True):
            block[at : at + ROWS_OF_A_TICK] = rows[first : first + ROWS_OF_A_TICK]
        at += ROWS_OF_A_TICK
    recorder.rows = at
    return recorder, blocks


def held_bytes(*streams: Stream) -> int:
    return sum(getattr(stream, name).nbytes for stream in streams for name in quantities(type(stream)))


@pytest.fixture(scope="module")
def line() -> Line:
    return Line(load_scenario("low-adhesion-stop", ()))


def test_every_row_comes_out_where_it_was_written(line: Line) -> None:
    rows, brake_rows = written()
    recorder, _ = recorded(rows, brake_rows)
    motion, wheelsets = recorder.motion_and_wheelsets(line.track, line.contact, line.rail)
    brake = recorder.brake(motion.t_s)
    for name in ("t_s", "position_m", "yaw_rad", "specific_force_mps2", "momentum_ns"):
        np.testing.assert_array_equal(getattr(motion, name), rows[name])
    np.testing.assert_array_equal(motion.power_creep_w, rows["power_w"][:, 3])
    np.testing.assert_array_equal(motion.gradient_permille, line.track.gradient_permille(rows["position_m"]))
    np.testing.assert_array_equal(wheelsets.position_m, rows["wheelset_position_m"])
    np.testing.assert_array_equal(wheelsets.longitudinal_force_n, rows["longitudinal_force_n"])
    speed = rows["wheelset_speed_mps"]
    np.testing.assert_allclose(wheelsets.slip[1:] * speed[1:], (speed - rows["rim_speed_mps"])[1:], rtol=1e-9)
    for name in quantities(type(brake)):
        np.testing.assert_array_equal(getattr(brake, name), rows["t_s"] if name == "t_s" else brake_rows[name])


@pytest.mark.parametrize("memory", [(), ("adhesion.memory.distance_m=0.001",)])
def test_the_peak_on_offer_is_that_of_both_wheels_by_their_loads(memory: tuple[str, ...]) -> None:
    """On rails alike as on others; a wheelset in the air is offered nothing, and its neighbours what is theirs."""
    line = Line(load_scenario("low-adhesion-stop", memory))
    rng = np.random.default_rng(5)
    rows = np.zeros(30, OBSERVATION)
    rows["wheelset_speed_mps"] = rng.uniform(-2.0, 40.0, (30, 4))
    load = rng.uniform(4e4, 9e4, (30, 8)) * rng.choice([0.0, 1.0], (30, 8), p=[0.2, 0.8])
    rows["normal_force_n"] = load
    rows["wheelset_position_m"] = rng.uniform(1400.0, 2500.0, (30, 4))  # slippery
    rows["rail_kept"][:, 0] = 300.0
    rows["rail_kept"][::2, 1, 1::2] = 2.0  # sand on the right rail
    rows["memory"] = rng.uniform(0.5, 1.0, (30, 2, 4)).repeat(2, axis=2)
    condition = np.empty((30, CONDITION, LANES))
    for row, here in zip(rows, condition, strict=True):
        place, speed, (energy, sand) = row["wheelset_position_m"], row["wheelset_speed_mps"], row["rail_kept"]
        past_conditions(place, speed, energy, sand, line.rail, here, np.full(LANES, NO_KIND))
        if memory:
            recall_friction(here, row["memory"])
    assert np.all(condition[::2, MU0, 1::2] > 1.05 * condition[::2, MU0, ::2])
    recorder = Recorder()
    recorder.block[0][:30] = rows
    recorder.rows = 30
    _, wheelsets = recorder.motion_and_wheelsets(line.track, line.contact, line.rail)
    law, patch = line.contact.law, line.contact.patch
    for n, i in np.ndindex(30, 4):
        carried = load[n, 2 * i : 2 * i + 2]
        if not carried.any():
            assert (wheelsets.peak_adhesion[n, i], wheelsets.peak_slip[n, i]) == (0.0, 0.0)
            continue
        offered = []
        for side in range(2):
            # on rails alike one search at the mean load serves both
            load_n = max(carried.mean() if n % 2 else carried[side], 1.0)
            growth = np.cbrt(load_n / line.contact.load_n)
            offered.append(
                offered_adhesion(
                    law.number, law.address, law.extra, abs(rows["wheelset_speed_mps"][n, i]), load_n,
                    np.array([patch[0] * growth, patch[1] * growth, *patch[2:]]), condition[n, :, 2 * i + side].copy(),
                    line.contact.parameters.shear_modulus_pa, True,
                )
            )  # fmt: skip
        peak, slip = np.average(offered, axis=0, weights=carried)
        assert wheelsets.peak_adhesion[n, i] == pytest.approx(peak, rel=1e-9)
        assert wheelsets.peak_slip[n, i] == pytest.approx(slip, rel=1e-4)


def test_a_run_is_not_in_memory_twice(line: Line) -> None:
    """Beside its rows there are the streams and not much more, and no block outlives them."""
    recorder, blocks = recorded(*written())
    line.track.gradient_permille(np.zeros(1))
    tracemalloc.start()
    try:
        motion, wheelsets = recorder.motion_and_wheelsets(line.track, line.contact, line.rail)
        brake = recorder.brake(motion.t_s)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    streams = held_bytes(motion, wheelsets, brake)
    print(f"{streams / ROWS:.0f} bytes a row in streams, {peak / ROWS:.0f} at the peak, {ROW_BYTES} recorded")
    assert peak < 1.2 * streams
    last = 2  # the recorder's own, of motion and brake
    assert len(blocks) > 10
    assert all(block() is None for block in blocks[:-last])
