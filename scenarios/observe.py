"""From truth to estimates: masks make readings, the on-board computer samples them, estimators answer."""

from dataclasses import dataclass

from estimators.interface import EstimateStream, Sample
from estimators.onboard import samples
from scenarios.known_start import known_start
from scenarios.schema import Scenario
from scenarios.truth import Truth
from sensors import BaliseReadings, Balises, Imu, ImuReadings, Kinematics


@dataclass(frozen=True)
class Observation:
    """What the sensors gave beside the tachometers in the loop, and what each estimator made of it."""

    imu: ImuReadings
    balises: BaliseReadings
    estimates: dict[str, EstimateStream]


def observe(scenario: Scenario, truth: Truth) -> Observation:
    """Readings and estimates of a run. Everything random here hangs on `scenario.onboard_seed` alone."""
    seed = scenario.onboard_seed
    motion = truth.motion
    kinematics = Kinematics(
        t_s=motion.t_s,
        specific_force_mps2=motion.specific_force_mps2,
        angular_rate_radps=motion.angular_rate_radps,
        angular_acceleration_radps2=motion.angular_acceleration_radps2,
    )
    imu = Imu(scenario.imu, scenario.simulation.record_period_s, seed).process(kinematics)
    balises = Balises(scenario.balises, seed).passed(motion.t_s, motion.position_m)
    initial = known_start(scenario, float(motion.t_s[0]), float(motion.position_m[0]), truth.axle_speeds)
    estimates = {}
    sampled: dict[float, list[Sample]] = {}
    for name, estimator in scenario.make_estimators().items():
        period_s = estimator.period_s
        if period_s not in sampled:
            sampled[period_s] = list(samples(imu, truth.axle_speeds, balises, period_s))
        estimator.reset(initial)
        estimates[name] = EstimateStream.of(map(estimator.step, sampled[period_s]))
    return Observation(imu, balises, estimates)
