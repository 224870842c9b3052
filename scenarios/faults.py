"""From pydantic's findings to messages that name the file, the key, the value and what is allowed."""

import datetime
import json
import math
import re
import types
import typing
from collections.abc import Iterator, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from scenarios.errors import Fault
from scenarios.layers import Merged
from scenarios.names import nearest

SHOWN_LENGTH = 60

Model = TypeVar("Model", bound=BaseModel)


def validate_section(
    model: type[Model], value: Any, key: tuple[str, ...], merged: Merged, faults: list[Fault]
) -> Model | None:
    """Build `model` from the table `value` that stands at `key`; what is wrong is added to `faults`.

    Validation is pydantic's strict JSON mode: a number in quotes is not a number, a whole number may stand for a float.
    """
    if not isinstance(value, dict):
        faults.append(_fault(merged, key, value, f"must be a table: [{_dotted(key)}]"))
        return None
    unusable = list(_unusable_values(value, key))
    faults.extend(_fault(merged, path, found, message) for path, found, message in unusable)
    if any(not isinstance(found, float) for _, found, _ in unusable):
        return None
    try:
        built = model.model_validate_json(json.dumps(value), strict=True)
    except ValidationError as error:
        told = {path for path, _, _ in unusable}
        details = error.errors(include_url=False)
        for detail in details:
            path = (*key, *map(str, detail["loc"]))
            if path not in told and not _follows(detail, details):
                faults.append(_translate(model, detail, path, merged))
        return None
    return None if unusable else built


def unknown_key(merged: Merged, path: Sequence[str], known: Sequence[str]) -> Fault:
    """The refusal of a key that is not there, with the nearest that are."""
    best = nearest(path[-1], known)
    hint = f"did you mean {' or '.join(map(repr, best))}? " if best else ""
    return Fault(merged.origin(path), _dotted(path), f"unknown key; {hint}known here: {', '.join(known) or 'none'}")


def table_fault(merged: Merged, path: Sequence[str], message: str) -> Fault:
    """A fault of a table, whose message may begin with the key in it that is to blame: `from_m = 3: must be ...`."""
    blamed = re.match(r"[a-z][\w.]*(?= = |: )", message)
    if blamed is None:
        return Fault(merged.origin(path), _dotted(path), message)
    path = (*path, *blamed.group().split("."))
    return Fault(merged.origin(path), _dotted(path) + message[blamed.end() :], "")


def _follows(detail: Any, details: Sequence[Any]) -> bool:
    """Whether pydantic calls an array too short only because its entries were refused."""
    depth = len(detail["loc"])
    return detail["type"] == "too_short" and any(
        len(other["loc"]) > depth and other["loc"][:depth] == detail["loc"] for other in details
    )


def _translate(model: type[BaseModel], detail: Any, path: tuple[str, ...], merged: Merged) -> Fault:
    if detail["type"] == "extra_forbidden":
        return unknown_key(merged, path, _keys_at(model, detail["loc"][:-1]))
    if detail["type"] == "missing":
        return Fault(merged.origin(path), _dotted(path), "is missing" + _description(model, detail["loc"]))
    message = detail["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    message = message.replace("Input should", "must")
    if isinstance(detail["input"], dict | list):
        return table_fault(merged, path, message)
    return _fault(merged, path, detail["input"], message + _description(model, detail["loc"]))


def _fault(merged: Merged, path: Sequence[str], value: Any, message: str) -> Fault:
    shown = json.dumps(value, default=str, ensure_ascii=False)
    if len(shown) > SHOWN_LENGTH:
        shown = shown[: SHOWN_LENGTH - 3] + "..."
    return Fault(merged.origin(path), f"{_dotted(path)} = {shown}", message)


def _dotted(path: Sequence[str]) -> str:
    return ".".join(path)


def _unusable_values(value: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any, str]]:
    """What no parameter takes, whatever its model says: not-a-number, infinity, dates."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _unusable_values(inner, (*path, name))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _unusable_values(inner, (*path, str(index)))
    elif isinstance(value, float) and not math.isfinite(value):
        yield path, value, "must be a finite number"
    elif isinstance(value, datetime.date | datetime.time):
        yield path, value, "must not be a date or a time"


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models that a type annotation allows: itself, members of a union, entries of a sequence."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated, tuple, list, dict):
        for inner in typing.get_args(annotation):
            yield from _models_in(inner)


def _models_at(model: type[BaseModel], loc: Sequence[str | int]) -> list[type[BaseModel]]:
    models = [model]
    for step in loc:
        if isinstance(step, str):
            fields = [candidate.model_fields[step] for candidate in models if step in candidate.model_fields]
            if fields:  # otherwise the tag of a union, which pydantic puts into the path
                models = [inner for field in fields for inner in _models_in(field.annotation)]
    return models


def _keys_at(model: type[BaseModel], loc: Sequence[str | int]) -> list[str]:
    return sorted({name for candidate in _models_at(model, loc) for name in candidate.model_fields})


def _description(model: type[BaseModel], loc: Sequence[str | int]) -> str:
    """What the parameter is, where its model says so."""
    for candidate in _models_at(model, loc[:-1]):
        field = candidate.model_fields.get(str(loc[-1])) if loc else None
        if field is not None and field.description:
            return f" ({field.description})"
    return ""
