"""Loads: mass, centre of gravity and inertias against closed forms."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench, coach_of
from vehicle.modes import bounce_frequencies_hz


def test_a_payload_moves_mass_centre_and_inertia_as_steiner_says() -> None:
    """The payload as a cloud of points that fills its box, put together with the body."""
    empty, full = coach_of(), coach_of(load="crush")
    body, payload, laden = empty.body, full.loads["crush"], full.laden_body
    assert full.mass_kg - empty.mass_kg == pytest.approx(16_000.0)
    assert full.static_wheel_load_n - empty.static_wheel_load_n == pytest.approx(2_000.0 * 9.81)
    centre = np.average([body.height_m, payload.height_m], weights=[body.mass_kg, payload.mass_kg])
    assert laden.height_m == pytest.approx(centre)
    # the payload as a cloud of points that fills the saloon from the floor to 2 x 2.05 - 1.25 = 2.85 m
    n = 24
    x, y, z = (((np.arange(n) + 0.5) / n - 0.5) * size for size in (24.0, 2.6, 1.6))
    point_kg = payload.mass_kg / n**3
    xx, yy, zz = np.meshgrid(x, y, z + payload.height_m - centre, indexing="ij")
    points = point_kg * np.array([(yy**2 + zz**2).sum(), (xx**2 + zz**2).sum(), (xx**2 + yy**2).sum()])
    fall = body.mass_kg * (body.height_m - centre) ** 2
    own = np.array([body.roll_inertia_kgm2 + fall, body.pitch_inertia_kgm2 + fall, body.yaw_inertia_kgm2])
    assert [laden.roll_inertia_kgm2, laden.pitch_inertia_kgm2, laden.yaw_inertia_kgm2] == pytest.approx(
        points + own, rel=2e-3
    )


def test_given_inertias_are_taken() -> None:
    coach = coach_of(load="crush", loads__crush__inertia_kgm2=[20e3, 600e3, 610e3], loads__crush__height_m=1.8)
    assert coach.laden_body.yaw_inertia_kgm2 == coach.body.yaw_inertia_kgm2 + 610e3
    assert coach.laden_body.roll_inertia_kgm2 == coach.body.roll_inertia_kgm2 + 20e3  # centres coincide


def test_bounce_slows_down_with_the_root_of_the_body_s_mass() -> None:
    empty, full = coach_of(), coach_of(load="crush")
    ratio = bounce_frequencies_hz(full)[0] / bounce_frequencies_hz(empty)[0]
    assert ratio == pytest.approx((empty.body.mass_kg / full.laden_body.mass_kg) ** 0.5, rel=0.01)


@pytest.mark.parametrize("load", ["seated", "crush"])
def test_a_laden_coach_stands_on_its_wheels_at_once(make_bench: MakeBench, load: str) -> None:
    coach = coach_of(load=load)
    bench = make_bench(given=coach)
    rows, _ = bench.run(duration_s=1.0, speed_mps=0.0, brake=lambda t: 1e4)
    assert rows["normal_force_n"].sum(axis=1) == pytest.approx(coach.mass_kg * 9.81, rel=2e-3)
    assert rows["normal_force_n"][-1] == pytest.approx(np.full(8, coach.static_wheel_load_n), rel=5e-3)
