"""Ctrl-C: a flag while the solver runs, an exception at any other time."""

import os
import signal
import time

import pytest

from scenarios import interruption
from scenarios.interruption import Interruption


def press(number: int = signal.SIGINT) -> None:
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_outside_the_solve_it_raises_at_once(number: int) -> None:
    with Interruption() as caught:
        with pytest.raises(KeyboardInterrupt):
            press(number)
        assert caught.number == number


def test_inside_the_solve_it_sets_a_flag() -> None:
    with Interruption() as caught:
        with caught.deferred():
            assert not caught.requested()
            press()
            assert caught.requested()
        assert caught.requested()


def test_a_second_press_does_not_wait() -> None:
    with Interruption() as caught, caught.deferred():
        press()
        with pytest.raises(KeyboardInterrupt):
            press()


def test_a_flag_that_nobody_looks_at_raises_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interruption, "PATIENCE_S", 0.05)

    def wait() -> None:
        with Interruption() as caught, caught.deferred():
            press()
            time.sleep(5.0)

    with pytest.raises(KeyboardInterrupt):
        wait()


def test_afterwards_everything_is_as_before() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)]
    with Interruption() as caught, caught.deferred():
        press()
    time.sleep(0.01)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)] == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
