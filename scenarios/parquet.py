"""Streams as Parquet files: the same bytes for the same values, unit and description in the metadata of each field."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from sensors.streams import Stream, columns


def write_stream(path: Path, stream: Stream) -> None:
    """Write the flat columns of a stream; nothing of when or where it was written goes into the file."""
    flat = columns(stream)
    schema = pa.schema(
        [
            pa.field(
                column.name,
                pa.from_numpy_dtype(column.values.dtype),
                nullable=False,
                metadata={"unit": column.unit, "description": column.description},
            )
            for column in flat
        ]
    )
    table = pa.Table.from_arrays([pa.array(column.values) for column in flat], schema=schema)
    pq.write_table(table, path, compression="zstd", compression_level=1, use_dictionary=False, version="2.6")


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """The columns of a Parquet file by name. Raises ValueError if it cannot be read."""
    if path.is_dir():
        raise ValueError("is a folder, a Parquet file is wanted")
    if not path.exists():
        raise ValueError("there is no such file")
    try:
        table = pq.read_table(path)
    except (OSError, pa.ArrowException) as error:
        raise ValueError(f"cannot be read as Parquet: {error}") from None
    return {name: table.column(name).to_numpy() for name in table.column_names}
