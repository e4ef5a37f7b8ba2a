"""Print data on stdout: unchanged into files and pipes, and harmless on a terminal."""

import csv
import io
import sys
from collections.abc import Iterable
from typing import Literal

from service.errors.printable import printable, printable_lines


def print_data(text: str) -> None:
    """Print a text and the end of its line."""
    # Not with typer.echo, which removes everything like an escape sequence when stdout is a file.
    shown = printable_lines(text) if sys.stdout.isatty() else text
    sys.stdout.write(shown + "\n")
    sys.stdout.flush()


def print_csv(rows: Iterable[Iterable[object]], delimiter: str = ",") -> None:
    """Print rows as CSV; on a terminal each row is one line, even if a field has line breaks."""
    if sys.stdout.isatty():
        rows = [
            [printable(each) if isinstance(each, str) else each for each in row] for row in rows
        ]
    print_data(csv_text(rows, delimiter))


def csv_text(rows: Iterable[Iterable[object]], delimiter: str = ",") -> str:
    """Return rows as CSV, without the end of the last line.

    A field is quoted if it has a quotation mark, a delimiter or a line break in it. Python 3.11
    alone would not quote a carriage return, which other programs read as a line break.
    """
    text = io.StringIO()
    for row in rows:
        text.write(delimiter.join(_field(each, delimiter) for each in row) + "\n")
    return text.getvalue().removesuffix("\n")


def _field(value: object, delimiter: str) -> str:
    line = io.StringIO()
    special = isinstance(value, str) and any(each in value for each in (delimiter, "\r", "\n"))
    quoting: Literal[0, 1] = csv.QUOTE_ALL if special else csv.QUOTE_MINIMAL
    csv.writer(line, delimiter=delimiter, lineterminator="", quoting=quoting).writerow([value])
    return line.getvalue()
