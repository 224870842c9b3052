"""A braking run written down by formula: what metrics, tables and figures are tested on without any simulation."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from scenarios.truth import BrakeStream, MotionStream, SolveRecord, Truth, WheelsetStream, rail_stream
from sensors.readings import AxleSpeedReadings, TachometerReadings
from sensors.streams import Stream, quantities
from wheel_rail import RailState

PERIOD_S = 0.005
LOAD_N = 68_670.0
PEAK_ADHESION = 0.08


def build_stream(record: type[Stream], rows: int, **given: Any) -> Any:
    """A record with `rows` rows: the given fields broadcast to their shape, all others zero."""
    fields = {}
    for name, what in quantities(record).items():
        shape = (rows, *(len(axis) for axis in what.axes))
        fields[name] = np.broadcast_to(np.asarray(given.get(name, 0), dtype=what.dtype), shape)
    return record(**fields)


def braking_truth(
    initial_speed_mps: float = 30.0,
    deceleration_mps2: float = 0.75,
    brake_at_s: float = 10.0,
    used_share: float = 0.8,
    slip: float | np.ndarray = 0.1,
) -> Truth:
    """Constant speed, from `brake_at_s` on constant deceleration to a standstill held for a second.

    Every wheel carries 68.67 kN, finds a peak adhesion of 0.08 and uses `used_share` of it; `slip` (from the brake on)
    is one number or one for each wheelset.
    """
    stop_s = brake_at_s + initial_speed_mps / deceleration_mps2
    t_s = PERIOD_S * np.arange(round((stop_s + 1.0) / PERIOD_S) + 1)
    braking_s = np.clip(t_s - brake_at_s, 0.0, stop_s - brake_at_s)
    speed = initial_speed_mps - deceleration_mps2 * braking_s
    position = initial_speed_mps * np.minimum(t_s, stop_s) - 0.5 * deceleration_mps2 * braking_s**2
    braked = (t_s >= brake_at_s - 1e-9)[:, None]
    slips = np.where(braked, np.broadcast_to(slip, (len(t_s), 4)), 0.0)
    rows = len(t_s)
    force = np.where(braked & (speed[:, None] > 0.0), -used_share * PEAK_ADHESION * LOAD_N, 0.0)
    acceleration = np.where(braked[:, 0] & (speed > 0.0), -deceleration_mps2, 0.0)
    specific_force = np.stack([acceleration, 0.0 * t_s, 9.81 + 0.0 * t_s], axis=1)
    motion = build_stream(
        MotionStream,
        rows,
        t_s=t_s,
        position_m=position,
        speed_mps=speed,
        acceleration_mps2=acceleration,
        specific_force_mps2=specific_force,
    )
    wheelsets = build_stream(
        WheelsetStream,
        rows,
        t_s=t_s,
        position_m=position[:, None] + np.array([9.66, 7.24, -7.24, -9.66]),
        speed_mps=speed[:, None],
        rim_speed_mps=speed[:, None] * (1.0 - slips),
        slip=slips,
        normal_force_n=LOAD_N,
        longitudinal_force_n=force,
        peak_adhesion=PEAK_ADHESION,
        friction_power_w=-2.0 * force * slips * speed[:, None],
    )
    brake = build_stream(
        BrakeStream,
        rows,
        t_s=t_s,
        demand=braked[:, 0],
        distributor_pressure_bar=np.clip(t_s - brake_at_s, 0.0, 3.0),
        cylinder_pressure_bar=np.clip(t_s - brake_at_s, 0.0, 3.0)[:, None] * (0.6 + 0.2 * np.sin(t_s))[:, None],
        valve=np.where(braked, (t_s[:, None] * 4 + np.arange(4)).astype(int) % 3, 0),
        axle_speed_mps=speed[:, None] * (1.0 - slips),
        reference_speed_mps=speed * (1.0 - slips.min(axis=1)),
        air_nl=np.linspace(5.0, 105.0, rows),
    )
    ticks = slice(None, None, 2)
    axle_speeds = AxleSpeedReadings(
        t_s=t_s[ticks], axle_speed_mps=brake.axle_speed_mps[ticks], valid=np.ones((len(t_s[ticks]), 4), bool)
    )
    edges = np.arange(0.01, 1.0, 0.01)
    tachometer = TachometerReadings(t_s=edges, wheelset=np.ones(len(edges)), direction=np.ones(len(edges)))
    solve = SolveRecord(
        simulated_s=float(t_s[-1]), wall_s=0.2, realtime_factor=250.0, step_s=0.005, exudyn_build="", ended="standstill"
    )
    before = RailState(float(position[-1]) + 20.0)
    after = RailState(before.length_m)
    braked_cells = slice(round(10.0 * (initial_speed_mps * brake_at_s - 10.0)), None)
    after.energy_jpm[:, braked_cells] = np.array([[900.0], [1000.0]])  # left and right
    return Truth(
        motion=motion,
        wheelsets=wheelsets,
        brake=brake,
        rail_before=rail_stream(before.table),
        rail=rail_stream(after.table),
        tachometer=tachometer,
        axle_speeds=axle_speeds,
        solve=solve,
    )


@pytest.fixture
def make_truth() -> Callable[..., Truth]:
    return braking_truth


@pytest.fixture
def stream_of() -> Callable[..., Any]:
    return build_stream


@pytest.fixture
def truth() -> Truth:
    return braking_truth()


@pytest.fixture
def changed() -> Callable[..., Any]:
    """A record with some fields replaced."""

    def replace(record: Any, **fields: Any) -> Any:
        return dataclasses.replace(record, **fields)

    return replace
