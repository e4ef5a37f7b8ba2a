"""Show progress on stderr while a front is planned."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass

from paretour import Progress
from rich import progress as bars
from rich.console import Console

LOADING = "loading the search"


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


@dataclass(frozen=True)
class ConsoleDisplay:
    """Shows on a console how far a plan in this process is."""

    console: Console

    @contextmanager
    def loading(self) -> Iterator[Callable[[str], None]]:
        """Say that the search is loaded; yields a function that says how far that is."""
        with self.console.status(LOADING) as shown:
            yield shown.update

    def planning(self, seconds: float) -> AbstractContextManager[Callable[[Progress], None]]:
        """Show a bar, as `progress_bar` does."""
        return progress_bar(self.console, seconds)
