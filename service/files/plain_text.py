"""Tables as people paste them: with names of several words between spaces, or drawn with lines."""

import re
from collections.abc import Callable, Iterable, Sequence

_RULE = re.compile(r"(?=.*(--|\|[ \t:]*-))[ \t|+:=-]+")
_EDGES = re.compile(r"^[ \t]*\||\|[ \t]*$", re.MULTILINE)
_FOOT = re.compile(r"\(\d+ rows?\)")  # of psql
_LEAST_NUMBERS = 2  # beside a name: a place has two

IsNumber = Callable[[str], bool]


def without_lines(text: str) -> str:
    """Return a table without the lines that are drawn in it, as Markdown, psql and MySQL do.

    A row between others becomes an empty one. Any other text stays as it is.
    """
    lines = text.split("\n")
    if not any(map(_RULE.fullmatch, lines)) or not any("|" in line for line in lines):
        return text
    drawn = (_RULE.fullmatch(line) or _FOOT.fullmatch(line.strip()) for line in lines)
    rows = "\n".join("" if found else line for found, line in zip(drawn, lines, strict=True))
    return _EDGES.sub("", rows)


def with_whole_names(rows: Iterable[list[str]], is_number: IsNumber) -> list[list[str]]:
    """Return rows of words, where a name of several words beside the numbers of a row is one field.

    The name is first in all rows, or last. Below a heading each row has as many fields as that.
    Rows without a heading stay as they are where they have the same number of words, and so do
    rows that are numbered, as R writes them.
    """
    rows = list(rows)
    filled = [row for row in rows if row]
    headed = bool(filled) and not any(map(is_number, filled[0]))
    below = filled[1:] if headed else filled
    numbered = [row[0].strip('"') for row in below] == [str(1 + at) for at in range(len(below))]
    if numbered or len({*map(len, below), *([len(filled[0])] if headed else [])}) < 2:
        return rows
    for is_first in (True, False):
        counts = [_numbers_beside(row, is_first, is_number) for row in below]
        numbers = len(filled[0]) - 1 if headed else min(counts)
        if _LEAST_NUMBERS <= numbers <= min(counts):
            first = filled[0] if headed else None
            return [row if row is first else _joined(row, numbers, is_first) for row in rows]
    return rows


def _numbers_beside(row: Sequence[str], is_first: bool, is_number: IsNumber) -> int:
    """Return how many fields after the name are numbers, or before it."""
    fields = row[:0:-1] if is_first else row[:-1]
    return next((at for at, each in enumerate(fields) if not is_number(each)), len(fields))


def _joined(row: list[str], numbers: int, is_first: bool) -> list[str]:
    if not row:
        return row
    if is_first:
        return [" ".join(row[:-numbers]), *row[-numbers:]]
    return [*row[:numbers], " ".join(row[numbers:])]
