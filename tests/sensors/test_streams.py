"""Records: names, units, shapes, and what they refuse."""

import dataclasses

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sensors import ImuReadings, Stream, StreamError, TachometerReadings, columns, quantity
from sensors.streams import WHEELS, FloatArray, unit_suffix


def imu_readings(n: int = 3) -> ImuReadings:
    return ImuReadings(
        t_s=np.arange(n) * 0.01,
        specific_force_mps2=np.arange(3.0 * n).reshape(n, 3),
        angular_rate_radps=np.zeros((n, 3)),
        temperature_degc=np.full(n, 20.0),
    )


def test_columns_keep_the_unit_at_the_end_of_the_name() -> None:
    flat = columns(imu_readings())
    assert [column.name for column in flat] == [
        "t_s",
        "specific_force_x_mps2",
        "specific_force_y_mps2",
        "specific_force_z_mps2",
        "angular_rate_x_radps",
        "angular_rate_y_radps",
        "angular_rate_z_radps",
        "temperature_degc",
    ]
    assert flat[2].unit == "m/s2"
    np.testing.assert_array_equal(flat[2].values, [1.0, 4.0, 7.0])


def test_components_of_a_field_without_unit_come_last() -> None:
    class Slips(Stream):
        t_s: FloatArray = quantity("s")
        slip: FloatArray = quantity("1", WHEELS)

    flat = columns(Slips(t_s=np.zeros(2), slip=np.zeros((2, 8))))
    assert [column.name for column in flat[1:3]] == ["slip_1l", "slip_1r"]


@pytest.mark.parametrize(
    ("unit", "suffix"),
    [("m/s2", "mps2"), ("rad/s", "radps"), ("1", ""), ("N m", "nm"), ("km/h", "kmh"), ("degC", "degc")],
)
def test_unit_decides_the_suffix(unit: str, suffix: str) -> None:
    assert unit_suffix(unit) == suffix


def test_a_name_that_contradicts_its_unit_is_refused_where_it_is_declared() -> None:
    with pytest.raises(StreamError, match=r"Wrong\.speed_kmh.*_mps"):

        class Wrong(Stream):
            speed_kmh: FloatArray = quantity("m/s")


@given(shape=hnp.array_shapes(min_dims=0, max_dims=3, max_side=4))
def test_only_the_declared_shape_is_taken(shape: tuple[int, ...]) -> None:
    good = imu_readings(shape[0] if shape else 1)
    fields = {field.name: getattr(good, field.name) for field in dataclasses.fields(good)}
    fields["angular_rate_radps"] = np.zeros(shape)
    if len(shape) == 2 and shape[1] == 3:
        assert len(ImuReadings(**fields)) == shape[0]
    else:
        with pytest.raises(StreamError, match=r"ImuReadings\.angular_rate_radps: shape"):
            ImuReadings(**fields)


def test_fields_of_different_length_are_refused() -> None:
    with pytest.raises(StreamError, match=r"TachometerReadings\.direction: 1 rows, but t_s has 2"):
        TachometerReadings(t_s=[0.0, 1.0], wheelset=[1, 2], direction=[1])


@given(t_s=hnp.arrays(float, 3, elements=st.floats(allow_nan=True, allow_infinity=True)))
@example(t_s=np.array([-1.7976931348623157e308, 1e292, 1e292]))  # whose difference is beyond all numbers
def test_times_are_finite_and_never_fall(t_s: np.ndarray) -> None:
    wanted = bool(np.all(np.isfinite(t_s)) and t_s[0] <= t_s[1] <= t_s[2])
    if wanted:
        assert len(TachometerReadings(t_s=t_s, wheelset=[1, 2, 3], direction=[1, 1, -1])) == 3
    else:
        with pytest.raises(StreamError, match="t_s"):
            TachometerReadings(t_s=t_s, wheelset=[1, 2, 3], direction=[1, 1, -1])


@pytest.mark.parametrize("wheelset", [[1.5], [300], [np.nan], ["one"]])
def test_values_that_do_not_fit_the_type_are_refused(wheelset: list[object]) -> None:
    with pytest.raises(StreamError, match=r"TachometerReadings\.wheelset"):
        TachometerReadings(t_s=[0.0], wheelset=wheelset, direction=[1])  # type: ignore[arg-type]


def test_a_record_cannot_be_changed_but_the_callers_array_can() -> None:
    t_s = np.zeros(2)
    record = TachometerReadings(t_s=t_s, wheelset=np.array([1, 2]), direction=np.array([1, 1]))
    with pytest.raises(ValueError, match="read-only"):
        record.t_s[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.t_s = t_s  # type: ignore[misc]
    t_s[0] = 0.0


def test_rows_by_slice_and_mask() -> None:
    record = imu_readings(5)
    np.testing.assert_array_equal(record.rows(slice(1, 3)).t_s, record.t_s[1:3])
    np.testing.assert_array_equal(record.rows(record.t_s > 0.025).t_s, record.t_s[3:])
