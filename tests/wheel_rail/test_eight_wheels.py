"""All wheels at once: no lane knows of the others, and Polach's law in lanes is that of one wheel."""

from dataclasses import replace

import numpy as np
import pytest

from tests.wheel_rail.rail_kinds import CONTACT, LAW, PATCH, SHEAR_PA
from wheel_rail.compiled import Vector, compiled, inlined
from wheel_rail.contact import (
    AXLE,
    CARRIER_RATE,
    FRAME,
    GROWTH,
    PLACE,
    REPORT,
    SPIN,
    VELOCITY,
    WHEEL,
    wheel_contacts,
)
from wheel_rail.creep_laws import CREEP_LAWS
from wheel_rail.lane_arrays import lanes_at, put_lanes
from wheel_rail.lanes import LANES
from wheel_rail.recovery import CONDITION, ENERGY, TAU, adhesive_force, polach_adhesion

SPEED_MPS = 20.0


def random_wheels(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Wheels pressed in, lifted, against the flange, rolling, sliding and locked; on rail that recovers or does not."""
    wheels = np.zeros((WHEEL, LANES))
    wheels[PLACE + 1] = rng.uniform(-0.008, 0.008, LANES)
    wheels[PLACE + 2] = 0.46 - rng.uniform(-3e-4, 2e-3, LANES)
    axle = np.stack([rng.uniform(-0.01, 0.01, LANES), np.ones(LANES), rng.uniform(-0.005, 0.005, LANES)])
    wheels[AXLE : AXLE + 3] = axle / np.linalg.norm(axle, axis=0)
    wheels[VELOCITY : VELOCITY + 3] = np.array([[SPEED_MPS], [0.0], [0.0]]) + rng.normal(0.0, 0.05, (3, LANES))
    wheels[CARRIER_RATE : CARRIER_RATE + 3] = rng.normal(0.0, 0.02, (3, LANES))
    wheels[SPIN] = SPEED_MPS / 0.46 * rng.choice([0.0, 0.85, 0.99, 1.0, 1.001], LANES)
    wheels[GROWTH] = rng.uniform(-1e-4, 1e-4, LANES)
    wheels[[FRAME + 3, FRAME + 7, FRAME + 11]] = 1.0
    wheels[FRAME + 13] = 1e-3
    of_each = np.array([0.08, 0.4, 0.2, 1.0, 0.4, 0.3, 0.4, 0.6, 1.0, 0.4, 0.0, 0.0, 0.0])
    condition = np.repeat(of_each[:, None], LANES, axis=1)
    assert condition.shape == (CONDITION, LANES)
    condition[TAU] = rng.choice([0.0, 1.9e-4, 2e-3], LANES)
    condition[ENERGY] = rng.choice([0.0, 2e3, 2e4], LANES)
    return wheels, condition


def forces(wheels: np.ndarray, condition: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Normal force, creep force and report, (14 + REPORT, LANES)."""
    normal, creep, report = np.zeros((7, LANES)), np.zeros((7, LANES)), np.zeros((REPORT, LANES))
    wheel_contacts(wheels.copy(), constants[()], condition, normal, creep, report)
    return np.concatenate([normal, creep, report])


@pytest.mark.parametrize("law", ["polach", "fastsim"])
def test_wheels_in_another_order_have_the_same_forces(law: str) -> None:
    """Left wheels change places with left wheels, right with right: to the last bit."""
    rng = np.random.default_rng(3)
    constants = replace(CONTACT, law=CREEP_LAWS[law].in_force()).constants
    for _ in range(50):
        wheels, condition = random_wheels(rng)
        order = np.arange(LANES)
        order[::2], order[1::2] = rng.permutation(order[::2]), rng.permutation(order[1::2])
        plain = forces(wheels, condition, constants)
        moved = forces(wheels[:, order].copy(), condition[:, order].copy(), constants)
        assert np.isfinite(plain).all()
        # one wheel beyond the polynomial of the recovery's equation sends all to the other method, good to 1e-9
        assert moved == pytest.approx(plain[:, order], rel=1e-8, abs=1e-6)


@inlined
def _five(rows: np.ndarray, at: int) -> Vector:
    first, second, third = lanes_at(rows, 8 * at), lanes_at(rows, 8 * at + 8), lanes_at(rows, 8 * at + 16)
    return first, second, third, lanes_at(rows, 8 * at + 24), lanes_at(rows, 8 * at + 32)


@compiled
def _in_lanes(wheels: np.ndarray, patch: tuple[float, ...], condition: np.ndarray, out: np.ndarray) -> None:
    creep_x, creep_y, spin, slip, speed = _five(wheels, 0)
    results = polach_adhesion(
        creep_x, creep_y, spin, slip, speed, lanes_at(wheels, 40), patch, _five(condition, 0), _five(condition, 5),
        lanes_at(condition, 8 * TAU), lanes_at(condition, 8 * ENERGY), SHEAR_PA,
    )  # fmt: skip
    put_lanes(out, 0, results[0])
    put_lanes(out, 8, results[1])
    put_lanes(out, 16, results[2])
    put_lanes(out, 24, results[3])


def test_the_law_in_lanes_is_the_law_of_one_wheel() -> None:
    rng = np.random.default_rng(4)
    out = np.empty((4, LANES))
    for _ in range(300):
        _, condition = random_wheels(rng)
        creep = rng.normal(size=(2, LANES)) * 10.0 ** rng.uniform(-6.0, -0.5, LANES) * rng.choice([0.0, 1.0], LANES)
        slip_mps = np.hypot(*creep) * SPEED_MPS
        spin, load = rng.normal(0.0, 0.3, LANES), rng.uniform(1e3, 2e5, LANES)
        wheels = np.array([*creep, spin, slip_mps, np.full(LANES, SPEED_MPS), load])
        _in_lanes(wheels, tuple(PATCH), condition, out)
        for w in range(LANES):
            alone = adhesive_force(
                LAW.number, LAW.address, LAW.extra, *wheels[:, w], tuple(PATCH), condition[:, w].copy(), SHEAR_PA
            )  # fmt: skip
            # the recovery's equation is solved to 1e-9 where it is solved step by step
            assert out[:, w] == pytest.approx(alone, rel=1e-8, abs=1e-9)
