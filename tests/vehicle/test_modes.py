"""Modes of the coach and their names. Frequencies, damping and waves of closed form are cases of the verification."""

import numpy as np
import pytest

from vehicle import CoachParameters
from vehicle.layout import SPIN
from vehicle.linear import LinearCoach, Linearisation
from vehicle.mode_names import BOUNCE, LATERAL, PITCH, ROLL, YAW, mode_name, motions, shares, unique_names
from vehicle.modes import damped_modes, undamped_modes


@pytest.fixture(scope="module")
def linear(parameters: CoachParameters) -> LinearCoach:
    return Linearisation(parameters).at(30.0)


@pytest.mark.parametrize("coordinates", [46, 94])
def test_motions_are_an_orthonormal_basis(coordinates: int) -> None:
    basis = np.array([motion.vector for motion in motions(coordinates)])
    assert basis.shape == (coordinates, coordinates)
    assert basis @ basis.T == pytest.approx(np.eye(coordinates), abs=1e-12)


def test_shares_of_a_mode_sum_to_one(linear: LinearCoach) -> None:
    mass = np.diag(linear.mass)
    for mode in damped_modes(linear):
        assert sum(shares(mode.shape, mass).values()) == pytest.approx(1.0)
        assert np.vdot(mode.shape, mass * mode.shape).real == pytest.approx(1.0)


SHAPES = [
    ({BOUNCE: 1.0}, "body bounce"),
    ({PITCH: 1.0}, "body pitch"),
    ({YAW: -1.0}, "body yaw"),
    ({LATERAL: 1.0, ROLL: 0.9}, "body upper sway"),  # it turns about a point 1.1 m above its centre
    ({LATERAL: 1.0, ROLL: -0.5}, "body lower sway"),
    ({6 + BOUNCE: 1.0, 12 + BOUNCE: 1.0}, "bogie bounce, in phase"),
    ({6 + BOUNCE: 1.0, 12 + BOUNCE: -1.0}, "bogie bounce, out of phase"),
    ({6 + PITCH: 1.0, 12 + PITCH: 1.0, BOUNCE: 1e-3}, "bogie pitch, in phase"),
    ({6 + YAW: 1.0, 12 + YAW: -0.8}, "bogie yaw, out of phase"),
    ({18 + ROLL: 1.0, 24 + ROLL: 1.0, 30 + ROLL: 1.0, 36 + ROLL: 1.0}, "wheelset roll, in phase"),
    ({18 + LATERAL: 1.0, 24 + LATERAL: -1.0, 30 + LATERAL: 1.0, 36 + LATERAL: -1.0},
     "wheelset lateral, in each bogie opposed"),
    ({SPIN: 1.0, SPIN + 1: 1.0, SPIN + 2: 1.0, SPIN + 3: 1.0}, "wheels spin, in phase"),
]  # fmt: skip


@pytest.mark.parametrize(("moving", "name"), SHAPES)
def test_names_follow_from_shapes(moving: dict[int, float], name: str, linear: LinearCoach) -> None:
    """At any phase and size of the shape."""
    shape = np.zeros(46, complex)
    for coordinate, size in moving.items():
        shape[coordinate] = size
    for factor in (1.0, -3.0, np.exp(1.1j)):
        assert mode_name(factor * shape, np.diag(linear.mass), 10j, 0.0) == name


def test_wheelsets_that_roll_along_their_wave_are_klingels(linear: LinearCoach) -> None:
    """y' = v psi; the same motion with the other sign of yaw slides."""
    speed_mps, rate = 20.0, 3j
    shape = np.zeros(46, complex)
    for body in range(1, 7):
        shape[6 * body + LATERAL], shape[6 * body + YAW] = 1.0, rate / speed_mps
    mass = np.diag(linear.mass)
    assert mode_name(shape, mass, rate, speed_mps) == "klingel, in phase"
    assert mode_name(shape.conj(), mass, rate, speed_mps) == "bogie lateral, in phase"


def test_repeated_names_are_numbered() -> None:
    assert unique_names(["a", "b", "a"]) == ["a (1)", "b", "a (2)"]


def test_modes_of_the_coach(linear: LinearCoach) -> None:
    """All motions on the two stages are there, under names of their own; swings decay at a moderate speed."""
    modes = damped_modes(linear)
    names = [mode.name for mode in modes]
    assert len(set(names)) == len(names)
    wanted = ["body bounce", "body pitch", "body lower sway", "body upper sway", "body yaw"]
    wanted += [f"bogie {way}, {phase}" for way in ("bounce", "pitch", "roll") for phase in ("in phase", "out of phase")]
    assert set(wanted) <= set(names)
    assert any(name.startswith("klingel") for name in names)
    assert all(0.0 < mode.damping_ratio < 1.0 for mode in modes)
    assert [mode.frequency_hz for mode in modes] == sorted(mode.frequency_hz for mode in modes)


def test_without_dampers_and_creep_there_is_no_damping(linear: LinearCoach) -> None:
    """The vertical modes of the damped analysis, its damping taken out, are the undamped ones."""
    stiffness = 0.5 * (linear.stiffness + linear.stiffness.T)
    still = LinearCoach(0.0, linear.mass, np.zeros_like(linear.damping), stiffness)
    modes = {mode.name: mode for mode in damped_modes(still)}
    for name in ("body bounce", "body pitch", "bogie bounce, in phase"):
        assert abs(modes[name].damping_ratio) < 1e-6


def test_undamped_modes_name_the_published_ones(parameters: CoachParameters) -> None:
    named = {mode.name: mode.frequency_hz for mode in undamped_modes(parameters)}
    assert named["body bounce"] == pytest.approx(0.8, rel=0.05)
    assert named["bogie bounce, in phase"] == pytest.approx(4.5, rel=0.05)
    assert named["body lower sway"] < named["body upper sway"]


def test_stiffness_of_the_sprung_bodies_is_symmetric_and_holds_them(linear: LinearCoach) -> None:
    sprung = linear.stiffness[:18, :18]
    assert np.abs(sprung - sprung.T).max() < 1e-5 * np.abs(sprung).max()
    assert np.linalg.eigvalsh(0.5 * (sprung + sprung.T)).min() > 0.0
