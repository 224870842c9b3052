"""Compiled code calls Python objects, and is called with objects that it does not look at."""

import sys

import pytest
from numba import types

from vehicle.python_calls import HANDED, call_python
from wheel_rail.compiled import compiled


@compiled
def _ask(function: int, arguments: int) -> bool:
    return bool(call_python(function, arguments))


@compiled
def _second(_handed: object, value: float) -> float:
    return 2.0 * value


@pytest.mark.parametrize(("answer", "true"), [(True, True), (False, False), (None, False), ("no", True), (0.0, False)])
def test_what_is_called_answers_something_true_or_not(answer: object, true: bool) -> None:
    heard: list[object] = []

    def called(*arguments: object) -> object:
        heard.extend(arguments)
        return answer

    arguments = ("forceVector", 3)
    assert _ask(id(called), id(arguments)) is true
    assert heard == ["forceVector", 3]


def test_nothing_is_kept_of_what_is_handed_to_and_fro() -> None:
    answer, arguments = object(), (object(),)

    def called(_argument: object) -> object:
        return answer

    before = sys.getrefcount(answer), sys.getrefcount(arguments), sys.getrefcount(arguments[0])
    for _ in range(50):
        _ask(id(called), id(arguments))
    assert (sys.getrefcount(answer), sys.getrefcount(arguments), sys.getrefcount(arguments[0])) == before


def test_what_python_raises_leaves_the_compiled_function() -> None:
    def called() -> None:
        raise ZeroDivisionError("in Python")

    nothing: tuple[()] = ()
    with pytest.raises(ZeroDivisionError, match="in Python"):
        _ask(id(called), id(nothing))


def test_any_object_can_be_handed_over() -> None:
    function = _second.compile((HANDED, types.float64))  # type: ignore[attr-defined]
    for handed in (None, object(), [1, 2], "text"):
        assert function(handed, 4.0) == 8.0
