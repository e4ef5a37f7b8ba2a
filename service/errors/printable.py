"""Make text that came from outside harmless on a terminal and in a line of a log, and short."""

from collections.abc import Sequence


def printable(text: str) -> str:
    """Return a text in one line, with ? for what is not printed: control and formatting characters.

    Escape sequences would move the cursor, change a title, or show other text than is there; marks
    of direction show text in another order.
    """
    return "".join(each if each.isprintable() else _replacement(each) for each in text)


def printable_lines(text: str) -> str:
    """Return the lines of a text, each printable."""
    return "\n".join(printable(line) for line in text.split("\n"))


def _replacement(character: str) -> str:
    return " " if character.isspace() and character not in "\x1c\x1d\x1e\x1f" else "?"


def shortened(names: Sequence[str], most: int) -> str:
    """Return the first of some names for a sentence, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"
