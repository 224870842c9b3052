"""The record of numbers that the compiled anti-skid works on: state, answer and constants."""

import math

import numpy as np

from wsp.anti_skid_parameters import AntiSkidParameters

AXLES = 4

ANTI_SKID = np.dtype(
    [
        ("speed_mps", "f8", (AXLES,)),
        ("acceleration_mps2", "f8", (AXLES,)),
        ("torque_nm", "f8", (AXLES,)),  # the answer of the last tick, not yet in force
        ("in_force_nm", "f8", (AXLES,)),
        ("felt_nm", "f8", (AXLES,)),  # in force, behind the filter of the speeds
        ("rail_nm", "f8", (AXLES,)),
        ("limit_nm", "f8", (AXLES,)),
        ("largest_rail_nm", "f8", (AXLES,)),
        ("mode", "i8", (AXLES,)),
        ("since_slip_s", "f8", (AXLES,)),  # while it slips: since its torque is at the least
        ("relieved_s", "f8"),
        ("unsure_s", "f8"),
        ("reference_mps", "f8"),
        ("train_mps2", "f8"),  # by what the rails take
        ("unknown_mps2", "f8"),  # and by what the anti-skid does not see
        ("started", "i8"),
        # of the demand answered last, and the answer with its sign
        ("direction", "f8"),
        ("answer_nm", "f8", (AXLES,)),
        # constants
        *((name, "f8") for name in ("period_s", "memory", "train_memory", *AntiSkidParameters.model_fields)),
    ],
    align=True,
)


def anti_skid_record(parameters: AntiSkidParameters, period_s: float) -> np.ndarray:
    """(1,) of ANTI_SKID, its state to be set by a reset."""
    record = np.zeros(1, ANTI_SKID)
    c = record[0]
    for name, value in parameters.model_dump().items():
        c[name] = value
    c["period_s"] = period_s
    c["memory"] = math.exp(-period_s / parameters.filter_time_s)
    c["train_memory"] = math.exp(-period_s / parameters.train_filter_time_s)
    c["direction"] = 1.0
    return record
