"""What is said on stderr while a front is planned, and how Ctrl-C ends its search."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event
from types import FrameType
from typing import Any, Protocol

from paretour import Plan
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


class Heard(Protocol):
    """How far a search has come."""

    @property
    def seconds(self) -> float:
        """Since it began."""

    @property
    def hypervolume(self) -> float:
        """Of all points found."""

    @property
    def points(self) -> int:
        """How many were found."""


@contextmanager
def watching(stderr: Console, plan: Plan) -> Iterator[Callable[[Heard], None]]:
    """A bar over the time that a plan takes, where somebody looks, and whom to tell of progress."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[found]}"),
        TimeElapsedColumn(),
    )
    hidden = not stderr.is_terminal
    with Progress(*columns, console=stderr, transient=True, disable=hidden) as bar:
        task = bar.add_task("planning", total=plan.seconds, found="")

        def tell(heard: Heard) -> None:
            found = f"hypervolume {heard.hypervolume:.2%}, {heard.points} tours"
            bar.update(task, completed=heard.seconds, found=found)

        yield tell


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Whether Ctrl-C was pressed, instead of an exception; the second time it is one again."""
    pressed = Event()

    def press(_signal: int, _frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    before: Any = signal.signal(signal.SIGINT, press)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)
