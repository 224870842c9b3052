"""What a controller supposes its valves to do, against the flow equations; and its records."""

from typing import Any

import numpy as np
import pytest
from numba import njit

from wsp.controllers.cylinder_model import (
    CylinderParameters,
    commit,
    committed_before,
    cylinder_constants,
    cylinder_state,
    follow_demand,
)
from wsp.controllers.records import record_of, ticks
from wsp.pneumatics import ATMOSPHERE_BAR, pressure_emptied_bar, pressure_filled_bar
from wsp.valves import FILL, HOLD, VENT


@njit
def _run(state: Any, constants: Any, demand: Any, codes: Any) -> Any:
    """Committed pressure of the first axle, and that of five ticks ago, after each tick."""
    s, c = state[0], constants[0]
    out = np.empty((len(codes), 2))
    for k in range(len(codes)):
        follow_demand(s, c, demand[k])
        commit(s, c, codes[k])
        out[k, 0] = committed_before(s, 0, 0)
        out[k, 1] = committed_before(s, 0, 5)
    return out


def run(demand: float, code_runs: list[tuple[int, int]]) -> np.ndarray:
    """Pressures after runs of (valve code, ticks), all axles alike."""
    codes = np.repeat([code for code, _ in code_runs], [n for _, n in code_runs]).astype(np.int8)
    state, constants = record_of(cylinder_state()), record_of(cylinder_constants(CylinderParameters(), 0.01))
    found: np.ndarray = _run(state, constants, np.full(len(codes), demand), np.tile(codes[:, None], (1, 4)))
    return found


def test_filled_from_the_distributor() -> None:
    """Half the demand: 1.7 bar after 2 s, a cylinder that follows it lags by little."""
    pressure = run(0.5, [(FILL, 400)])[:, 0]
    assert pressure[-1] == pytest.approx(1.7, abs=1e-6)
    assert pressure[199] == pytest.approx(1.7, abs=0.12)
    assert (np.diff(pressure) >= 0.0).all()


def test_vented_as_the_flow_equations_say() -> None:
    """20 ticks of venting at 3.2 exchanges a second; a valve opens and shuts within half a tick of its command."""
    after = run(1.0, [(FILL, 700), (HOLD, 5), (VENT, 20), (HOLD, 20)])[:, 0]
    vented = pressure_emptied_bar(3.4 + ATMOSPHERE_BAR, ATMOSPHERE_BAR, 20 * 0.032, 0.3) - ATMOSPHERE_BAR
    assert after[-1] == pytest.approx(vented, rel=1e-6)
    assert np.ptp(after[-19:]) == 0.0


def test_refilled_as_the_flow_equations_say() -> None:
    after = run(1.0, [(FILL, 700), (VENT, 100), (HOLD, 5), (FILL, 10), (HOLD, 5)])[:, 0]
    filled = pressure_filled_bar(ATMOSPHERE_BAR, 3.4 + ATMOSPHERE_BAR, 10 * 0.02, 0.3) - ATMOSPHERE_BAR
    assert after[-1] == pytest.approx(filled, rel=1e-6)


def test_the_past_is_remembered_by_ticks() -> None:
    found = run(1.0, [(FILL, 300), (VENT, 30), (HOLD, 7)])
    np.testing.assert_array_equal(found[5:, 1], found[:-5, 0])


def test_records_keep_names_shapes_and_kinds() -> None:
    record = record_of({"count": 3, "rate_ps": 2.0, "on": True, "each_mps": np.arange(4.0)})
    assert record.shape == (1,)
    assert (record["count"][0], record["rate_ps"][0], record["on"][0]) == (3, 2.0, True)
    assert record["count"].dtype == np.int64
    np.testing.assert_array_equal(record["each_mps"][0], np.arange(4.0))
    assert [ticks(time, 0.01) for time in (0.001, 0.02, 0.026)] == [1, 2, 3]
    with pytest.raises(ValueError, match="at least one"):
        record_of({})
