"""Print notes on files and on requests to stderr, and no sentence about one file twice."""

from collections.abc import Iterable

from paretour import RequestNote
from typer import echo

from service.errors.printable import printable
from service.files.reading import NoteItem

_printed: set[str] = set()  # of the files that this command has read


def print_file_notes(notes: Iterable[NoteItem]) -> None:
    """Print what was assumed when files were read."""
    _printed.clear()
    for note in notes:
        _printed.add(note.text)
        echo(f"{note.file}: {note.text}", err=True)


def print_request_notes(notes: Iterable[RequestNote]) -> None:
    """Print what is likely to be a mistake in a request, unless it was said of its file."""
    for note in notes:
        if note.text not in _printed:
            echo(f"note: {printable(note.text)}", err=True)
