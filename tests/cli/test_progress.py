"""The bar on stderr."""

import io

import pytest
from paretour import Progress
from rich.console import Console

from service.cli.progress import progress_bar


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_is_shown_on_a_terminal_only(terminal: bool) -> None:
    text = io.StringIO()
    console = Console(file=text, force_terminal=terminal, width=100)
    with progress_bar(console, seconds=2) as show:
        show(Progress(seconds=1.0, hypervolume=0.5, points=7))
    assert ("hypervolume 50.00%, 7 found" in text.getvalue()) == terminal
