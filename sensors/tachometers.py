"""Tachometers on the four wheelsets: pulse edges from the wheels' angles, and speeds from the edges."""

import math
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from sensors import pulse_edges
from sensors.readings import AxleSpeedReadings, TachometerReadings
from sensors.streams import BoolArray, FloatArray, Int8Array

_BLOCK = 1 << 17
ROOM_OF_A_TICK = 1 << 13

Radius = Annotated[float, Field(gt=0.2, le=1.0)]


class TachometerParameters(BaseModel):
    """Hall-effect tachometers with a toothed wheel on each axle end, and their front end."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    pulses_per_revolution: int = Field(default=100, ge=4, le=4096)
    # What the on-board computer believes of the wheels of wheelsets 1..4; the true rolling radius is the vehicle's.
    wheel_radius_m: tuple[Radius, Radius, Radius, Radius] = (0.46, 0.46, 0.46, 0.46)
    pitch_error_share: float = Field(
        default=0.002, ge=0.0, le=0.05, description="standard deviation of a tooth's place, as a share of the pitch"
    )
    eccentricity_share: float = Field(
        default=0.0005, ge=0.0, le=0.05, description="eccentricity of the toothed wheel over its radius"
    )
    hysteresis_share: float = Field(
        default=0.02, ge=0.0, lt=0.5, description="how much later a tooth switches backward, as a share of the pitch"
    )
    clock_resolution_s: float = Field(default=1e-6, gt=0.0, le=1e-3)
    timeout_s: float = Field(default=0.5, gt=0.0, le=10.0, description="silence after which a wheel counts as standing")


def _silent_state(parameters: TachometerParameters) -> FloatArray:
    """Carried state of the compiled core before the first edge, with its constants."""
    pitch_rad = 2.0 * math.pi / parameters.pulses_per_revolution
    state = np.zeros((pulse_edges.TEETH + parameters.pulses_per_revolution, 4))
    state[pulse_edges.TICK_TIME] = math.nan
    state[pulse_edges.LAST_TIME] = -math.inf
    state[pulse_edges.REFERENCE_TIME] = -math.inf
    state[pulse_edges.PITCH] = pitch_rad * np.array(parameters.wheel_radius_m)
    state[pulse_edges.CONSTANTS, :3] = (
        parameters.hysteresis_share * pitch_rad,
        parameters.clock_resolution_s,
        parameters.timeout_s,
    )
    return state


class Tachometers:
    """Four tachometers in the loop: `advance` once per tick, then `axle_speed_mps` (4,) and `valid` (4,).

    Both are the same arrays at every tick, written anew. At the first tick each wheel is taken to have turned evenly
    before; edges put in for that carry times before the first tick. Tooth and eccentricity errors are drawn from `rng`
    once, here. Compiled code may call `pulse_edges.advance` itself, with `state`, `edges` and `count`, after
    `make_room`.
    """

    def __init__(self, parameters: TachometerParameters, rng: np.random.Generator) -> None:
        self.parameters = parameters
        n = parameters.pulses_per_revolution
        phase = rng.uniform(0.0, 2.0 * math.pi, 4)
        wave = np.sin(2.0 * math.pi * np.arange(n)[:, None] / n + phase) * n / (2.0 * math.pi)
        self.state = _silent_state(parameters)
        self.state[pulse_edges.TEETH :] = (
            parameters.pitch_error_share * rng.standard_normal((n, 4)) + parameters.eccentricity_share * wave
        )
        self.edges = np.empty((_BLOCK, 2))
        self.count = 0
        """The first `count` rows of `edges` are the latest: time, wheelset 1..4 with the sign of the direction."""
        self.before = 0
        """How many edges came before those."""
        self._past: list[tuple[FloatArray, Int8Array]] = []
        self._now_s = -math.inf
        self.axle_speed_mps: FloatArray = self.state[pulse_edges.SPEED]

    @property
    def valid(self) -> BoolArray:
        """(4,) whether the speeds are."""
        valid: BoolArray = self.state[pulse_edges.VALID] > 0.0
        return valid

    def make_room(self, ticks: int = 1) -> None:
        """Let `edges` have room for so many ticks, up to ten: a full block is put away, in a smaller form, and begun
        anew."""
        if self.count + ticks * ROOM_OF_A_TICK > len(self.edges):
            self._past.append(self._latest())
            self.before += self.count
            self.count = 0

    def _latest(self) -> tuple[FloatArray, Int8Array]:
        """Times, and wheelsets with the sign of the direction, of the block."""
        edges = self.edges[: self.count]
        return edges[:, 0].copy(), edges[:, 1].astype(np.int8)

    def advance(self, t_s: float, angle_rad: FloatArray, angular_speed_radps: FloatArray) -> None:
        """Go on to time t_s with the wheels' angles (4,) and angular speeds (4,), positive rolling forward.

        Raises ValueError for a time that does not rise, or an angle that jumps by thousands of pulses.
        """
        if not t_s > self._now_s:
            raise ValueError(f"Tachometers.advance: t_s = {t_s} is not after the last tick at {self._now_s}")
        self.make_room()
        count = pulse_edges.advance(t_s, angle_rad, angular_speed_radps, self.state, self.edges, self.count)
        if count < 0:
            raise ValueError(f"Tachometers.advance: more than {ROOM_OF_A_TICK} edges up to t_s = {t_s}: angles jump")
        self.count = count
        self._now_s = t_s

    def lose(self, axle: int) -> None:
        """Axle 0..3 gives no more pulses, and its speed is not valid."""
        self.state[pulse_edges.FAULT, axle] = pulse_edges.LOST

    def freeze(self, axle: int) -> None:
        """The front end of axle 0..3 repeats its last speed as a valid one."""
        self.state[pulse_edges.FAULT, axle] = pulse_edges.FROZEN

    def restore(self, axle: int) -> None:
        """Axle 0..3 counts again, from its next edge on; valid from the one after, or after the time-out."""
        p, state = pulse_edges, self.state
        state[p.FAULT, axle] = p.SOUND
        state[[p.DIRECTION, p.COUNT, p.SPEED, p.VALID], axle] = 0.0
        state[[p.LAST_TIME, p.REFERENCE_TIME], axle] = state[p.TICK_TIME, axle]

    def believe(self, axle: int, *, teeth: int | None = None, radius_m: float | None = None) -> None:
        """The front end of axle 0..3 counts on so many teeth and this wheel radius; None for what it was given."""
        teeth = self.parameters.pulses_per_revolution if teeth is None else teeth
        radius_m = self.parameters.wheel_radius_m[axle] if radius_m is None else radius_m
        self.state[pulse_edges.PITCH, axle] = 2.0 * math.pi / teeth * radius_m

    def readings(self) -> TachometerReadings:
        """All edges so far, in the order of time."""
        count = self.before + self.count
        t_s, signed = np.empty(count), np.empty(count, np.int8)
        blocks = [self._latest(), *reversed(self._past)]
        self._past = [(t_s[: self.before], signed[: self.before])]
        begin = 0
        while blocks:  # of millions of edges there is one copy: each block goes as it is taken
            times, marks = blocks.pop()
            order = np.argsort(times, kind="stable")  # a block holds whole ticks, and no edge leaves its tick
            end = begin + len(times)
            t_s[begin:end], signed[begin:end] = times[order], marks[order]
            begin = end
        return TachometerReadings(t_s=t_s, wheelset=np.abs(signed), direction=np.sign(signed))


def axle_speeds(
    readings: TachometerReadings, parameters: TachometerParameters, tick_s: FloatArray
) -> AxleSpeedReadings:
    """Speeds from recorded edges at the given ticks: at the ticks of a run without faults of tachometers, the same
    numbers as in the loop."""
    speed, valid = pulse_edges.speeds_of_edges(
        np.array(tick_s, dtype=float),
        readings.t_s,
        readings.wheelset,
        readings.direction,
        _silent_state(parameters),
    )
    return AxleSpeedReadings(t_s=tick_s, axle_speed_mps=speed, valid=valid)
