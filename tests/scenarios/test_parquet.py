"""Tables on disk: exact values, units with every column, the same bytes each time."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from scenarios.parquet import write_stream
from scenarios.truth import Truth
from sensors.streams import columns


def test_values_units_and_descriptions_come_back(tmp_path: Path, truth: Truth) -> None:
    for name, stream in (("w", truth.wheelsets), ("b", truth.brake), ("m", truth.motion), ("t", truth.tachometer)):
        write_stream(tmp_path / name, stream)
        table = pq.read_table(tmp_path / name)
        written = columns(stream)
        assert table.column_names == [column.name for column in written]
        for column in written:
            field = table.schema.field(column.name)
            assert field.metadata[b"unit"].decode() == column.unit
            assert field.metadata[b"description"].decode() == column.description
            read = table[column.name].to_numpy()
            assert read.dtype == column.values.dtype
            assert np.array_equal(read, column.values)


def test_the_same_stream_gives_the_same_bytes(tmp_path: Path, truth: Truth) -> None:
    write_stream(tmp_path / "one", truth.wheelsets)
    write_stream(tmp_path / "two", truth.wheelsets.rows(slice(None)))
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_another_value_gives_other_bytes(tmp_path: Path, truth: Truth) -> None:
    write_stream(tmp_path / "one", truth.wheelsets)
    write_stream(tmp_path / "two", truth.wheelsets.rows(slice(1, None)))
    assert (tmp_path / "one").read_bytes() != (tmp_path / "two").read_bytes()


def test_an_empty_stream_keeps_its_columns(tmp_path: Path, truth: Truth) -> None:
    write_stream(tmp_path / "none", truth.tachometer.rows(slice(0, 0)))
    table = pq.read_table(tmp_path / "none")
    assert table.num_rows == 0
    assert table.column_names == ["t_s", "wheelset", "direction"]
