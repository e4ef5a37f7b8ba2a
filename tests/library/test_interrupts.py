"""Ctrl-C as a flag."""

import signal
from threading import Thread, current_thread

import pytest

from service.library.interrupts import interrupt_flag, until_done


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


def test_where_ctrl_c_is_ignored_it_stays_so_and_no_other_thread_is_begun() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupt_flag() as interrupted:
            signal.raise_signal(signal.SIGINT)
            ran_in = until_done(current_thread, interrupted, lambda: None)
            assert not interrupted()
        assert ran_in is current_thread()
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
