"""What Exudyn calls before each step: compiled from the call to the forces handed over.

Exudyn knows Python alone. Some lines of it at every step took as long as all springs and dampers of the coach.
"""

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from numba import types

from vehicle.layout import coach_at
from vehicle.python_calls import HANDED, call_python
from vehicle.stepping import FRESH, begin_step
from wheel_rail.compiled import compiled


def pre_step(address: int) -> Callable[[Any, float], bool]:
    """The function for Exudyn, of system and end of the step, that begins each step of the coach at `address`.

    It works off what the coach's record names under `turn_at`, `hand_over_at` and `copes_at`.
    """
    return partial(_compiled(), address)


@cache
def _compiled() -> Any:
    return _pre_step.compile((types.int64, HANDED, types.float64))


@compiled
def _pre_step(address: int, _system: Any, _end_s: float) -> bool:
    """Python's turn, if it is due; then the step begins, and its forces go to Exudyn. False ends the run."""
    coach = coach_at(address)
    # Exudyn names the end of the step, summed up: the start by counting is free of its rounding
    coach.begin_s = coach.steps * coach.step_s
    if coach.steps % coach.steps_per_turn == 0 and not call_python(coach.turn_at[0], coach.turn_at[1]):
        return False
    coach.began = begin_step(address)
    call_python(coach.hand_over_at[0], coach.hand_over_at[1])
    return coach.began == FRESH or call_python(coach.copes_at[0], coach.copes_at[1])
