"""Typed, frozen records of arrays, with the unit of every field in one place.

A record is a subclass of `Stream`; it becomes a frozen dataclass by itself (put no `@dataclass` on it):

    class ImuReadings(Stream):
        t_s: FloatArray = quantity("s", about="time from the start of the run")
        specific_force_mps2: FloatArray = quantity("m/s2", XYZ, about="...")

The first axis of every array is time, or the event; each further axis is named by its components. The unit decides the
suffix of the name (`unit_suffix`), so that name and unit cannot contradict each other. Tables, files and plots take
names and units from `columns`.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any, Self, dataclass_transform

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

FloatArray = NDArray[np.float64]
Int8Array = NDArray[np.int8]
BoolArray = NDArray[np.bool_]

XYZ = ("x", "y", "z")
WHEELSETS = ("1", "2", "3", "4")
WHEELS = ("1l", "1r", "2l", "2r", "3l", "3r", "4l", "4r")

_QUANTITY = "quantity"
_IRREGULAR_SUFFIXES = {"1": "", "km/h": "kmh"}


class StreamError(ValueError):
    """A record whose declaration or arrays are not as its fields say; the message names record and field."""


@dataclasses.dataclass(frozen=True)
class Quantity:
    """What a field holds: its unit ("1" for none), the component names of each further axis, its type, its meaning."""

    unit: str
    axes: tuple[tuple[str, ...], ...]
    dtype: np.dtype[Any]
    about: str


@dataclasses.dataclass(frozen=True)
class Column:
    """One column of a table: name with the unit suffix last, unit, description, values (n,)."""

    name: str
    unit: str
    description: str
    values: NDArray[Any]


def quantity(unit: str, *axes: Sequence[str], about: str = "", dtype: DTypeLike = np.float64) -> Any:
    """Field of a `Stream`: unit, component names of each axis after the first, meaning and type of the values."""
    return dataclasses.field(
        metadata={_QUANTITY: Quantity(unit, tuple(tuple(axis) for axis in axes), np.dtype(dtype), about)}
    )


def unit_suffix(unit: str) -> str:
    """Suffix that a name with this unit ends in: "m/s2" gives "mps2", "N m" gives "nm", "1" gives none."""
    if unit in _IRREGULAR_SUFFIXES:
        return _IRREGULAR_SUFFIXES[unit]
    return unit.lower().replace("/", "p").replace(" ", "")


@dataclass_transform(frozen_default=True, field_specifiers=(quantity,))
class Stream:
    """Base of all records: arrays of one length, converted to their type, checked in shape, read-only.

    `t_s` must be finite and never fall. Raises StreamError.
    """

    def __init_subclass__(cls) -> None:
        dataclasses.dataclass(frozen=True, eq=False, repr=False)(cls)
        for field in dataclasses.fields(cls):  # type: ignore[arg-type]
            _check_declaration(cls.__name__, field)

    def __post_init__(self) -> None:
        rows: int | None = None
        first = ""
        for name, what in quantities(type(self)).items():
            values = _typed(f"{type(self).__name__}.{name}", getattr(self, name), what)
            if rows is None:
                rows, first = len(values), name
            elif len(values) != rows:
                raise StreamError(f"{type(self).__name__}.{name}: {len(values)} rows, but {first} has {rows}")
            if name == "t_s" and not (np.all(np.isfinite(values)) and np.all(values[1:] >= values[:-1])):
                raise StreamError(f"{type(self).__name__}.t_s: times must be finite and must never fall")
            object.__setattr__(self, name, values)

    def __len__(self) -> int:
        return len(getattr(self, next(iter(quantities(type(self))))))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self)} rows: {', '.join(quantities(type(self)))})"

    def rows(self, chosen: slice | NDArray[Any]) -> Self:
        """The record of some of the rows: a slice, a mask (n,) or indices."""
        return type(self)(**{name: getattr(self, name)[chosen] for name in quantities(type(self))})


def quantities(record: type[Stream]) -> dict[str, Quantity]:
    """Fields of a record type in their order: name -> Quantity."""
    return {field.name: field.metadata[_QUANTITY] for field in dataclasses.fields(record)}  # type: ignore[arg-type]


def columns(record: Stream) -> list[Column]:
    """A record as flat columns: `specific_force_mps2` with components x, y, z gives `specific_force_x_mps2`, ...

    Component names stand before the unit suffix, so that the unit stays last; without unit they come at the end.
    """
    flat = []
    for name, what in quantities(type(record)).items():
        values = getattr(record, name)
        suffix = unit_suffix(what.unit)
        stem, tail = (name.removesuffix("_" + suffix), "_" + suffix) if suffix else (name, "")
        for index in np.ndindex(values.shape[1:]):
            parts = [stem, *(axis[i] for axis, i in zip(what.axes, index, strict=True))]
            flat.append(Column("_".join(parts) + tail, what.unit, what.about, values[(slice(None), *index)]))
    return flat


def _check_declaration(record: str, field: "dataclasses.Field[Any]") -> None:
    what = field.metadata.get(_QUANTITY)
    if what is None:
        raise StreamError(f"{record}.{field.name}: declare it as `{field.name}: ... = quantity(unit, ...)`")
    suffix = unit_suffix(what.unit)
    if suffix and not field.name.endswith("_" + suffix):
        raise StreamError(f"{record}.{field.name}: unit {what.unit!r} asks for a name that ends in _{suffix}")


def _typed(where: str, values: ArrayLike, what: Quantity) -> NDArray[Any]:
    """The values as a read-only array of the field's type and shape; the caller's own array stays writeable."""
    try:
        given = np.asarray(values)
        with np.errstate(invalid="ignore"):  # a nan that goes into an integer field is refused below
            typed = np.ascontiguousarray(given, dtype=what.dtype)
    except (TypeError, ValueError) as error:
        raise StreamError(f"{where}: cannot be read as an array of {what.dtype}: {error}") from error
    shape = tuple(len(axis) for axis in what.axes)
    if given.ndim != 1 + len(shape) or given.shape[1:] != shape:
        wanted = ", ".join(["n", *(str(length) for length in shape)])
        raise StreamError(f"{where}: shape {given.shape}, wanted ({wanted}{',' if not shape else ''})")
    if what.dtype.kind in "ib" and not np.array_equal(typed, given):
        raise StreamError(f"{where}: values do not fit into {what.dtype}")
    view = typed.view()
    view.flags.writeable = False
    return view
