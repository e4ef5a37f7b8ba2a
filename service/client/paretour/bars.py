"""Show progress in a bar of tqdm, in a notebook or a terminal."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, Protocol

from paretour.values import Progress


class Display(Protocol):
    """Shows how far a plan in this process is."""

    def loading(self) -> AbstractContextManager[Callable[[str], None]]:
        """Say that the search is loaded; yields a function that says how far that is."""

    def planning(self, seconds: float) -> AbstractContextManager[Callable[[Progress], None]]:
        """Say that a front is planned; yields a function that shows progress."""


class Silent:
    """Shows nothing."""

    def loading(self) -> AbstractContextManager[Callable[[str], None]]:
        """Return a function that does nothing."""
        return nullcontext(lambda _: None)

    def planning(self, seconds: float) -> AbstractContextManager[Callable[[Progress], None]]:  # noqa: ARG002  # as of Display
        """Return a function that does nothing."""
        return nullcontext(lambda _: None)


class Bars:
    """Shows bars of tqdm.

    Raises:
        ModuleNotFoundError: tqdm is not installed.
    """

    def __init__(self) -> None:
        self._bar = bar_class()

    @contextmanager
    def loading(self) -> Iterator[Callable[[str], None]]:
        """Say that the search is loaded; yields a function that says how far that is."""
        with self._bar(desc="loading the search", bar_format="{desc}", leave=False) as bar:
            yield bar.set_description_str

    @contextmanager
    def planning(self, seconds: float) -> Iterator[Callable[[Progress], None]]:
        """Show a bar over the seconds that a plan may take."""
        form = "{desc}: |{bar}| {n:.1f} of {total:g} s{postfix}"
        with self._bar(total=seconds, desc="planning", bar_format=form) as bar:

            def show(found: Progress) -> None:
                bar.set_postfix_str(
                    f"hypervolume {found.hypervolume:.2%}, {found.points} found", refresh=False
                )
                bar.update(min(found.seconds, seconds) - bar.n)

            yield show


def bar_class() -> Any:
    """Return the class of bars.

    Raises:
        ModuleNotFoundError: tqdm is not installed.
    """
    try:
        from tqdm.auto import tqdm
    except ModuleNotFoundError as error:
        if error.name != "tqdm":
            raise
        raise ModuleNotFoundError("progress needs tqdm: pip install tqdm", name="tqdm") from None
    return tqdm
