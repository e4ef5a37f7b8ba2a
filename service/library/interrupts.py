"""Let Ctrl-C end a search early, with the best that was found until then."""

import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from threading import Event, Thread, current_thread, main_thread
from types import FrameType
from typing import Any, TypeVar

T = TypeVar("T")
_POLL_SECONDS = 0.02


def until_done(
    run: Callable[[], T], interrupted: Callable[[], bool], terminate: Callable[[], None]
) -> T:
    """Run a function in a thread, and return its result; this thread waits for Ctrl-C meanwhile.

    Where it is not told of Ctrl-C, it runs the function itself.

    Args:
        interrupted: The function that `interrupt_flag` yields.
        terminate: Called repeatedly after Ctrl-C: it ends a running call of the network.
    """
    if not _is_told():
        return run()
    future: Future[T] = Future()

    def compute() -> None:
        try:
            future.set_result(run())
        except BaseException as error:
            future.set_exception(error)

    Thread(target=compute, daemon=True).start()  # a second Ctrl-C does not wait for it
    while not wait((future,), _POLL_SECONDS).done:
        if interrupted():
            terminate()
    return future.result()


@contextmanager
def interrupt_flag() -> Iterator[Callable[[], bool]]:
    """Set a flag at the first Ctrl-C instead of raising KeyboardInterrupt.

    A second Ctrl-C does what Ctrl-C did before the block. Python tells the main thread alone of
    Ctrl-C: in another one the flag is never set, nor in a process that ignores it.

    Yields:
        A function that returns whether the flag is set.
    """
    pressed = Event()
    if not _is_told():
        yield pressed.is_set
        return

    def press(_signal: int, _frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    before: Any = signal.signal(signal.SIGINT, press)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)


def _is_told() -> bool:
    """Return whether Python tells this thread of Ctrl-C."""
    ignored = signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    return current_thread() is main_thread() and not ignored
