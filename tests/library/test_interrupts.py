"""Ctrl-C as a flag."""

import signal
from threading import Thread

import pytest

from service.library.interrupts import interrupt_flag


def test_ctrl_c_sets_a_flag_and_the_second_one_interrupts() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with interrupt_flag() as interrupted:
            assert not interrupted()
            signal.raise_signal(signal.SIGINT)
            assert interrupted()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) == signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_in_another_thread_ctrl_c_is_left_to_the_main_thread() -> None:
    before = signal.getsignal(signal.SIGINT)
    seen = []

    def plan() -> None:
        with interrupt_flag() as interrupted:
            seen.append((interrupted(), signal.getsignal(signal.SIGINT)))

    thread = Thread(target=plan)
    thread.start()
    thread.join()
    assert seen == [(False, before)]
