"""Stroke, return spring and linkage: the play operator, the work that friction takes, the air that the stroke takes."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from wsp import BRAKE_PRESETS, FILL, HOLD, VENT, Brake, BrakeParameters
from wsp.brake_record import brake_record
from wsp.cylinder import cylinder_volume_dm3, exchange_air, pad_pressure_bar

STILL = np.zeros(4)


def record(parameters: BrakeParameters) -> np.void:
    return brake_record(parameters, 0.001)[0]


@given(st.lists(st.floats(0.0, 6.0), min_size=1, max_size=30))
def test_pad_pressure_is_a_play_that_stays_in_its_band(
    presets: dict[str, BrakeParameters], pressures: list[float]
) -> None:
    """The band holds; nothing moves inside it; a cycle that is gone through again ends where it did before."""
    parameters = presets["tread-cast-iron-56t"]
    b = record(parameters)
    factor = 1.0 + parameters.linkage_hysteresis
    pad = 0.0
    for pressure in pressures:
        before, pad = pad, pad_pressure_bar(pressure, pad, b)
        rising = max(0.0, pressure - parameters.return_spring_pressure_bar)
        assert rising - 1e-12 <= pad <= factor * rising + 1e-12
        if rising < before < factor * rising:
            assert pad == before
        ends, loop = [], pad
        for _ in range(2):
            for visited in (0.9 * pressure, pressure):
                loop = pad_pressure_bar(visited, loop, b)
            ends.append(loop)
        assert ends[0] == ends[1]


def test_force_follows_the_pressure_with_a_lag_that_the_hysteresis_gives(coach_brake: BrakeParameters) -> None:
    """Rising: torque as p - spring. Falling: nothing until p - spring has lost its share, then (1 + h) times that."""
    h = coach_brake.linkage_hysteresis
    per_bar = 2 * 2.17 * 0.0507e5 * 0.247 * 0.35 * 1.024  # wheels still: the pads do not slide
    brake = Brake(coach_brake, 0.005)
    seen = []
    for step in range(5000):
        torque = brake.step(1.0 if step < 1000 else 0.0, np.full(4, FILL, np.int8), STILL, 0.0)
        seen.append((brake.cylinder_pressure_bar[0], torque[0] / per_bar))
    pressure, pads = np.array(seen).T
    rising = np.clip(pressure - 0.1, 0.0, None)
    np.testing.assert_allclose(pads[:1000], rising[:1000], atol=1e-9)
    falling = np.minimum(rising[999], (1.0 + h) * rising)
    np.testing.assert_allclose(pads[1000:], falling[1000:], atol=1e-9)
    assert np.any((pads == pads[999]) & (pressure < pressure[999] - 0.05))


def test_friction_of_the_linkage_takes_work_from_a_cycle(presets: dict[str, BrakeParameters]) -> None:
    """The loop in the plane of volume and pressure has the area k h F^2/2 (1 + h) of a proportional play, F its top."""
    parameters = presets["tread-cast-iron-56t"]
    b, h = record(parameters), parameters.linkage_hysteresis
    spring, k, top = parameters.return_spring_pressure_bar, parameters.elastic_volume_dm3pbar, 3.0
    pressure = spring + np.concatenate([np.linspace(0.0, top, 4001), np.linspace(top, 0.0, 4001)])
    volume, pad = [], 0.0
    for p in pressure:
        pad = pad_pressure_bar(p, pad, b)
        volume.append(cylinder_volume_dm3(p, pad, b))
    work = np.trapezoid(pressure, volume)
    # up: integral of q k dq to F; down: of q/(1 + h) k dq from F
    assert work == pytest.approx(0.5 * k * top**2 * (1.0 - 1.0 / (1.0 + h)), rel=1e-4)
    assert work > 0.0


def test_volume_grows_by_clearance_stroke_and_force(coach_brake: BrakeParameters) -> None:
    b = record(coach_brake)
    for pressure, pad, expected in ((0.0, 0.0, 2.05), (0.04, 0.0, 2.05), (0.07, 0.0, 2.15), (0.1, 0.0, 2.25),
                                    (3.1, 3.0, 2.37), (3.1, 3.12, 2.3748)):  # fmt: skip
        assert cylinder_volume_dm3(pressure, pad, b) == pytest.approx(expected, rel=1e-12)


def flow(ratio: float, critical: float) -> float:
    return 1.0 if ratio <= critical else float(np.sqrt(max(0.0, 1.0 - ((ratio - critical) / (1.0 - critical)) ** 2)))


PRESSURES = st.one_of(st.floats(0.0, 4.0), st.sampled_from([0.0, 0.04, 0.1, 0.3, 1.0]))
ALMOST_EQUAL = PRESSURES.flatmap(lambda p: st.tuples(st.just(p), st.floats(max(0.0, p - 1e-14), p + 1e-14)))


@settings(max_examples=300)
@given(
    st.sampled_from(sorted(BRAKE_PRESETS)),
    st.one_of(st.tuples(PRESSURES, PRESSURES), ALMOST_EQUAL),
    st.floats(0.0, 1.0),
    st.one_of(st.floats(0.0, 10.0), st.floats(0.0, 1e-6)),
)
@example("dynamic-magnetic-56t", (0.1, 0.0), 0.0, 1e-40)
def test_air_flows_towards_the_lower_pressure_to_the_last_bit(
    presets: dict[str, BrakeParameters], preset: str, pressures_bar: tuple[float, float], play: float, passage: float
) -> None:
    b = record(presets[preset])
    before_bar, other_bar = pressures_bar
    rising = max(0.0, before_bar - b["lay_on_bar"])
    b["cylinder_bar"][0] = before_bar
    b["pad_bar"][0] = pad_pressure_bar(before_bar, (1.0 + play * presets[preset].linkage_hysteresis) * rising, b)
    came_in = exchange_air(0, other_bar, passage, b)
    assert min(pressures_bar) <= b["cylinder_bar"][0] <= max(pressures_bar)
    assert came_in * (other_bar - before_bar) >= 0.0


@pytest.mark.parametrize(("step_s", "tolerance_bar"), [(0.001, 0.008), (0.00025, 0.002)])
@pytest.mark.parametrize("preset", ["lhb-discs-56t", "tread-cast-iron-56t"])
def test_filling_a_growing_volume_agrees_with_an_independent_integration(
    preset: str, step_s: float, tolerance_bar: float, presets: dict[str, BrakeParameters]
) -> None:
    """d(pV)/dt = C ps psi(p/ps) from empty, all stretches of the stroke in it."""
    parameters = presets[preset].model_copy(
        update={"application_time_s": 1e-6, "leakage_dm3psbar": 0.0, "valve_dead_time_s": 0.0}
    )
    p0, p1 = parameters.return_spring_preload_bar, parameters.return_spring_pressure_bar
    source = parameters.full_service_pressure_bar + 1.013

    def slope(_: float, pressure: np.ndarray) -> list[float]:
        gauge = pressure[0] - 1.013
        pads = max(0.0, gauge - p1)
        volume = parameters.cylinder_volume_dm3 + parameters.elastic_volume_dm3pbar * pads
        growth = parameters.elastic_volume_dm3pbar if gauge > p1 else 0.0
        if gauge > p0:
            volume += parameters.clearance_volume_dm3 * min(1.0, (gauge - p0) / (p1 - p0))
            growth += parameters.clearance_volume_dm3 / (p1 - p0) if gauge < p1 else 0.0
        return [5.0 * source * flow(pressure[0] / source, 0.3) / (volume + pressure[0] * growth)]

    brake = Brake(parameters, step_s)
    times = np.arange(1, round(0.4 / step_s) + 1) * step_s
    found = []
    for _ in times:
        brake.step(1.0, np.full(4, FILL, np.int8), STILL, 0.0)
        found.append(brake.cylinder_pressure_bar[0])
    exact = solve_ivp(slope, (0.0, 0.4 + 1e-9), [1.013], t_eval=times, rtol=1e-9, atol=1e-10, max_step=2e-4).y[0]
    error = np.abs(np.array(found) + 1.013 - exact).max()
    print(f"largest error {error:.4f} bar")
    assert error < tolerance_bar


def test_pads_lie_off_below_the_return_springs_pressure(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake, 0.005)
    demand = 0.9 * coach_brake.return_spring_pressure_bar / coach_brake.full_service_pressure_bar
    for _ in range(400):
        torque = brake.step(demand, np.full(4, FILL, np.int8), STILL, 0.0)
    assert brake.cylinder_pressure_bar.min() > 0.0
    assert torque.max() == 0.0


def test_a_held_axle_keeps_its_force(coach_brake: BrakeParameters) -> None:
    brake = Brake(coach_brake.model_copy(update={"leakage_dm3psbar": 0.0}), 0.005)
    for _ in range(1000):
        brake.step(1.0, np.full(4, FILL, np.int8), STILL, 0.0)
    for code, steps in ((VENT, 20), (HOLD, 20)):
        for _ in range(steps):
            brake.step(1.0, np.full(4, code, np.int8), STILL, 0.0)
    held, pads = brake.cylinder_pressure_bar.copy(), brake.record["pad_bar"][0].copy()
    for _ in range(200):
        brake.step(1.0, np.full(4, HOLD, np.int8), STILL, 0.0)
    np.testing.assert_array_equal(brake.cylinder_pressure_bar, held)
    np.testing.assert_array_equal(brake.record["pad_bar"][0], pads)
