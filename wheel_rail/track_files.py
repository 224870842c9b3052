"""Curves and gradient changes of a line from CSV files.

The first line names the columns, which are the keys of the entries in a scenario file, units included, in any order:

    start_m,end_m,radius_m,transition_in_m,transition_out_m,transition_kind,cant_mm
    250,900,1200,100,80,bloss,100

    start_m,joins_previous,transition_in_m,length_m,transition_out_m,radius_m
    1500,,100,450,,1200
    2050,true,80,300,80,700

    from_m,gradient_permille,rounding_m
    1200,-5,100

An empty cell is a key that is not given; lines that begin with # and empty lines are skipped.
"""

import csv
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

Entry = TypeVar("Entry", bound=BaseModel)


class TrackFileError(ValueError):
    """A file of the line that cannot be used; the message names key, file, place and reason."""


def read_entries(name: str, key: str, model: type[Entry]) -> tuple[Entry, ...]:
    """The rows of the CSV file `name` as `model`; `key` is the one that names the file, for messages.

    Raises TrackFileError if the file cannot be read, a column is unknown or a row is refused by the model.
    """
    try:
        text = Path(name).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a null character in the path
        raise TrackFileError(f"{key} = {name}: cannot be read: {error}") from error
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    if not lines:
        raise TrackFileError(f"{key} = {name}: empty; its first line must name the columns")
    columns = _cells(lines[0][1])
    known = list(model.model_fields)
    for column in columns:
        if column not in known:
            raise TrackFileError(f"{key} = {name}: unknown column {column!r}; known here: {', '.join(known)}")
    if len(set(columns)) < len(columns):
        raise TrackFileError(f"{key} = {name}: a column stands there twice: {', '.join(columns)}")
    return tuple(_entry(_cells(line), columns, f"{key} = {name}, line {number}", model) for number, line in lines[1:])


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line]))]


def _entry(cells: list[str], columns: list[str], place: str, model: type[Entry]) -> Entry:
    if len(cells) != len(columns):
        raise TrackFileError(f"{place}: {len(cells)} cells, {len(columns)} columns")
    values: dict[str, Any] = {column: cell for column, cell in zip(columns, cells, strict=True) if cell}
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        column = ".".join(map(str, first["loc"]))
        found = f"{column} = {values[column]!r}: " if column in values else f"{column}: " if column else ""
        raise TrackFileError(f"{place}: {found}{first['msg'].removeprefix('Value error, ')}") from error
