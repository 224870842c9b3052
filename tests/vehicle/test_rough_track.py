"""Irregular rails under the coach: against its linearised form, at rest, and over the steps that runs may take."""

import numpy as np
import pytest

from tests.vehicle.conftest import Bench, MakeBench
from vehicle import Coach
from vehicle.forces import CONTACT_NORMAL, CREEP, coach_force
from vehicle.jacobian import coach_jacobian
from vehicle.layout import COORDINATES
from vehicle.linear import Linearisation
from vehicle.start import start_state
from wheel_rail import Irregularities
from wheel_rail.contact import NORMAL

ERRI_LOW = {"spectrum": "erri-b176-low"}


def with_wave(bench: Bench, length_m: float, level_m: float = 0.0, alignment_m: float = 0.0) -> None:
    """Put rails on the bench's track whose level and alignment are sines, fading in from 70 to 170 m."""
    cell_m = 0.25
    place = cell_m * np.arange(round(bench.track.length_m / cell_m) + 1)
    risen = np.clip((place - 70.0) / 100.0, 0.0, 1.0)
    wave = np.sin(2.0 * np.pi * place / length_m) * risen**2 * (3.0 - 2.0 * risen)
    values = np.zeros((len(place), 4))
    values[:, 0], values[:, 1] = level_m * wave, alignment_m * wave
    bench.track.irregularities = Irregularities(0.0, cell_m, values)


def phasor(phase: np.ndarray, values: np.ndarray) -> complex:
    """Complex amplitude z of Im(z exp(i phase)) in the values, by least squares beside a mean: 1 for sin(phase)."""
    waves = np.stack([np.sin(phase), np.cos(phase), np.ones_like(phase)], axis=1)
    (sine, cosine, _), *_ = np.linalg.lstsq(waves, values, rcond=None)
    return complex(sine, cosine)


def without_resistance(bench: Bench) -> Bench:
    resistance = bench.parameters.resistance.model_copy(update={"a_n": 0.0, "b_nspm": 0.0, "c_ns2pm2": 0.0})
    bench.parameters = bench.parameters.model_copy(update={"resistance": resistance})
    bench.coach = Coach(bench.parameters, bench.contact, bench.track, bench.rail)
    return bench


@pytest.mark.parametrize(("length_m", "speed_mps"), [(30.0, 24.0), (12.0, 24.0), (6.0, 30.0)])
def test_response_to_a_vertical_wave_is_the_linear_one(
    make_bench: MakeBench, length_m: float, speed_mps: float
) -> None:
    """Wheel load and carbody acceleration against (K - w^2 M + i w C) q = input at the eight contacts.

    0.8 Hz (bounce of the body), 2 Hz and 5 Hz (bounce of the bogies), amplitude 0.1 mm.
    """
    level_m = 1e-4
    bench = without_resistance(make_bench())
    omega = 2.0 * np.pi * speed_mps / length_m
    linear = Linearisation(bench.parameters, bench.contact).at(speed_mps)
    mass, stiffness = linear.mass, linear.stiffness
    record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, 100.0, speed_mps)
    damping = np.empty((COORDINATES, COORDINATES))
    coach_force(q, v, np.empty(COORDINATES), record, bench.track.table, bench.rail)
    coach_jacobian(q, v, 0.0, 1.0, record, damping)
    height = slice(20, 44, 6)

    def contact_forces(below_m: float, falling_mps: float) -> np.ndarray:
        """All forces of the contacts, and the wheels' normal forces, with the wheelsets so much lower and falling."""
        moved_q, moved_v = q.copy(), v.copy()
        moved_q[height] -= below_m
        moved_v[height] -= falling_mps
        coach_force(moved_q, moved_v, np.empty(COORDINATES), record, bench.track.table, bench.rail)
        total = record[0]["force"][[CONTACT_NORMAL, CREEP], :COORDINATES].sum(axis=0)
        return np.concatenate([total, record[0]["report"][NORMAL, ::2]])

    # raising the rails under the wheelsets does what lowering the wheelsets does
    step = 1e-7
    rise = (contact_forces(step, 0.0) - contact_forces(-step, 0.0)) / (2.0 * step)
    rise = rise + 1j * omega * (contact_forces(0.0, step) - contact_forces(0.0, -step)) / (2.0 * step)
    rails = level_m * np.exp(1j * omega * (q[18:42:6] - q[0]) / speed_mps)
    push = np.zeros(COORDINATES, dtype=complex)
    for i in range(4):
        push[18 + 6 * i : 24 + 6 * i] = rise[18 + 6 * i : 24 + 6 * i] * rails[i]
        push[42 + i] = rise[42 + i] * rails[i]
    # the normal force leans back where the rail climbs
    push[18:42:6] -= 2.0 * bench.parameters.static_wheel_load_n * 2j * np.pi / length_m * rails
    answer = np.linalg.solve(stiffness - omega**2 * mass + 1j * omega * damping, push)
    load = rise[COORDINATES:] * (rails - answer[height])
    body = -(omega**2) * answer[2]

    with_wave(bench, length_m, level_m=level_m)
    rows, _ = bench.run(step_s=0.0005, duration_s=15.0, speed_mps=speed_mps)
    late = rows[rows["t_s"] >= 10.0]
    phase = 2.0 * np.pi * late["position_m"] / length_m
    for i in range(4):
        found = phasor(phase, late["normal_force_n"][:, 2 * i : 2 * i + 2].mean(axis=1))
        print(f"wheelset {i + 1}: {abs(found):.1f} N, linear {abs(load[i]):.1f} N, off {abs(found - load[i]):.2f} N")
        assert abs(found - load[i]) < 0.005 * abs(load).max()
    found = phasor(phase, late["specific_force_mps2"][:, 2])
    print(f"body: {1e3 * abs(found):.3f} mm/s2, linear {1e3 * abs(body):.3f}, off {1e3 * abs(found - body):.4f}")
    assert abs(found - body) < 0.01 * abs(body)


@pytest.mark.parametrize("step_s", [0.005, 0.001, 0.0005])
def test_wheel_loads_on_usual_rails_at_every_step(make_bench: MakeBench, step_s: float) -> None:
    """160 km/h on ERRI B176 low: a few kN of the 69, no wheel lifts, energy balances, alike at every step."""
    bench = make_bench(irregularities=ERRI_LOW, length_m=1000.0)
    rows, _ = bench.run(step_s=step_s, duration_s=10.0, speed_mps=160.0 / 3.6)
    late = rows[rows["t_s"] > 3.0]
    spread = late["normal_force_n"].std(axis=0).mean()
    ride = late["specific_force_mps2"][:, 1:].std(axis=0)
    print(f"step {1e3 * step_s:g} ms: wheel loads +-{spread:.0f} N, least {late['normal_force_n'].min():.0f} N, "
          f"carbody {ride[0]:.3f} across, {ride[1]:.3f} m/s2 up")  # fmt: skip
    assert 1500.0 < spread < 3500.0
    assert late["normal_force_n"].min() > 40e3
    assert 0.02 < ride[0] < 0.3
    assert 0.02 < ride[1] < 0.3
    work = np.trapezoid(rows["power_w"], rows["t_s"], axis=0)
    balance = rows["kinetic_energy_j"][-1] - rows["kinetic_energy_j"][0] - work.sum()
    assert abs(balance) < 0.01 * np.abs(np.trapezoid(np.abs(rows["power_w"]), rows["t_s"], axis=0)).sum()


def test_a_coach_starts_at_rest_on_rough_rails(make_bench: MakeBench) -> None:
    """Raised and rolled as the rails are: nowhere is a wheel pressed in or lifted by what they deviate."""
    smooth, rough = make_bench(), make_bench(irregularities=ERRI_LOW)
    loads = []
    for bench in (smooth, rough):
        record, q, v = start_state(bench.parameters, bench.contact, bench.track, bench.rail, 1000.0, 0.0)
        coach_force(q, v, np.empty(COORDINATES), record, bench.track.table, bench.rail)
        loads.append(record[0]["report"][NORMAL].reshape(4, 2))
    print(loads[1] - loads[0])
    assert loads[1] == pytest.approx(loads[0], rel=0.08)


def test_rails_that_wind_carry_the_coach_with_them(make_bench: MakeBench) -> None:
    """On a long wave of the alignment wheelsets and carbody follow the rails; the carbody feels it as acceleration."""
    amplitude, length_m, speed_mps = 0.005, 80.0, 16.0
    bench = without_resistance(make_bench())
    with_wave(bench, length_m, alignment_m=amplitude)
    rows, _ = bench.run(step_s=0.005, duration_s=30.0, speed_mps=speed_mps)
    late = rows[rows["t_s"] >= 15.0]
    for i in range(4):
        phase = 2.0 * np.pi * late["wheelset_position_m"][:, i] / length_m
        follows = phasor(phase, late["lateral_displacement_m"][:, i])
        print(f"wheelset {i + 1}: {1e3 * abs(follows):.2f} mm of 5, {np.angle(follows):+.3f} rad behind")
        assert abs(follows - amplitude) < 0.25 * amplitude
    phase = 2.0 * np.pi * late["position_m"] / length_m
    felt = phasor(phase, late["specific_force_mps2"][:, 1])
    quasistatic = -amplitude * (2.0 * np.pi * speed_mps / length_m) ** 2
    print(f"carbody {felt:.5f} m/s2, with the rails {quasistatic:.5f}")
    assert 0.6 < abs(felt / quasistatic) < 1.8
    assert (felt / quasistatic).real > 0.0
    # gravity and rails do no work on average: what is lost is creep
    assert rows["kinetic_energy_j"][-1] == pytest.approx(rows["kinetic_energy_j"][0], rel=2e-3)
