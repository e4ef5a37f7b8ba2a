"""The bar on stderr, and Ctrl-C as a flag."""

import io
import signal

import pytest
from paretour import Progress
from rich.console import Console

from service.cli.progress import interrupt_flag, progress_bar


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_is_shown_on_a_terminal_only(terminal: bool) -> None:
    text = io.StringIO()
    console = Console(file=text, force_terminal=terminal, width=100)
    with progress_bar(console, seconds=2) as show:
        show(Progress(seconds=1.0, hypervolume=0.5, points=7))
    assert ("hypervolume 50.00%, 7 found" in text.getvalue()) == terminal


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
