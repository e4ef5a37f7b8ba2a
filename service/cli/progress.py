"""Show progress on stderr while a front is planned, and end its search at Ctrl-C."""

import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from threading import Event, Thread
from types import FrameType
from typing import Any, TypeVar

from paretour import Progress
from rich import progress as bars
from rich.console import Console

T = TypeVar("T")
_POLL_SECONDS = 0.02


@contextmanager
def progress_bar(console: Console, seconds: float) -> Iterator[Callable[[Progress], None]]:
    """Show a bar over the seconds that a plan may take, if the console is a terminal.

    Yields:
        A function that shows progress in it.
    """
    columns = (
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.TextColumn("{task.fields[found]}"),
        bars.TimeElapsedColumn(),
    )
    hidden = not console.is_terminal
    with bars.Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("planning", total=seconds, found="")

        def show(progress: Progress) -> None:
            found = f"hypervolume {progress.hypervolume:.2%}, {progress.points} found"
            bar.update(task, completed=progress.seconds, found=found)

        yield show


def until_done(
    run: Callable[[], T], interrupted: Callable[[], bool], terminate: Callable[[], None]
) -> T:
    """Run a function in a thread, and return its result; this thread waits for Ctrl-C meanwhile.

    Args:
        run: The function.
        interrupted: As `interrupt_flag` yields it.
        terminate: Called repeatedly after Ctrl-C: it ends a running call of the network.
    """
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

    A second Ctrl-C does what Ctrl-C did before the block.

    Yields:
        A function that returns whether the flag is set.
    """
    pressed = Event()

    def press(_signal: int, _frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    before: Any = signal.signal(signal.SIGINT, press)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)
