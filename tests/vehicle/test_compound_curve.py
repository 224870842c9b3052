"""The coach over a compound curve: cant deficiency in its first part, cant excess in its second."""

import numpy as np
import pytest

from tests.vehicle.conftest import MakeBench
from vehicle.curving import deficiency_speed_mps
from vehicle.parameters import GRAVITY_MPS2


def test_each_part_of_a_compound_curve_is_felt_with_its_own_radius_and_cant(make_bench: MakeBench) -> None:
    """No straight between them: 600 m, cant 100 mm, then 1000 m, cant 120 mm, taken with 60 mm too little there."""
    curves = [
        {"start_m": 60.0, "transition_in_m": 60.0, "length_m": 120.0, "radius_m": 600.0, "cant_mm": 100.0},
        {"start_m": 240.0, "joins_previous": True, "transition_m": 60.0, "length_m": 100.0, "radius_m": 1000.0,
         "cant_mm": 120.0},
    ]  # fmt: skip
    # cones, whose contacts stay where they are
    bench = make_bench(geometry="conical", length_m=560.0, curves=curves)
    speed = deficiency_speed_mps(600.0, 100.0, 60.0)
    rows, _ = bench.run(duration_s=14.0, speed_mps=speed, position_m=45.0)
    leant = []
    for begin, end, radius, cant in ((170.0, 235.0, 600.0, 100.0), (335.0, 395.0, 1000.0, 120.0)):
        part = rows[(rows["position_m"] > begin) & (rows["position_m"] < end)]
        assert len(part) > 100
        outwards, angle = np.mean(part["speed_mps"] ** 2) / radius, np.arcsin(cant / 1500.0)
        unbalanced = outwards * np.cos(angle) - GRAVITY_MPS2 * np.sin(angle)
        load = part["normal_force_n"].reshape(-1, 4, 2).sum(axis=1).mean(axis=0)
        roll, felt = part["roll_rad"].mean(), part["specific_force_mps2"][:, 1].mean()
        turning = np.mean(part["angular_rate_radps"][:, 2] * part["speed_mps"])
        print(f"{radius:g} m: unbalanced {unbalanced:+.3f}, felt {felt:+.3f} m/s2")
        # what turns the coach is of this radius, and what is felt is that less the weight along the leaning floor
        assert turning == pytest.approx(outwards * np.cos(roll), rel=0.01)
        assert felt == pytest.approx(outwards * np.cos(roll) + GRAVITY_MPS2 * np.sin(roll), abs=0.01)
        # the body leans a little further than the track, to the side that deficiency or excess throws it
        assert 1.15 < felt / unbalanced < 1.45
        leant.append(float(np.diff(load)[0] / load.sum()) / unbalanced)
    # the outer rail bears more in the first part, less in the second, by the same share of what is unbalanced: that of
    # a rigid coach, and up to as much again because the weight sways and leans over on its soft springs
    p = bench.parameters
    moment = p.body.mass_kg * p.body.height_m + 2.0 * p.bogie.mass_kg * p.bogie.height_m
    moment += 2.0 * p.wheelset.mass_kg * p.wheelset.wheel_diameter_m
    rigid = 2.0 * moment / p.mass_kg / 1.5 / GRAVITY_MPS2
    print(f"share of the load per m/s2: {leant}, of a rigid coach {rigid:.3f}")
    assert leant[0] == pytest.approx(leant[1], rel=0.06)
    assert rigid < min(leant)
    assert max(leant) < 2.0 * rigid
