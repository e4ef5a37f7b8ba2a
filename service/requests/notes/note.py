"""A note on a request, as answers have it."""

from dataclasses import dataclass

from service.errors.printable import shortened

_MOST_NAMED = 3
_LONGEST_NAME = 80  # characters


@dataclass(frozen=True)
class Note:
    """A note on a request.

    Args:
        code: Tells notes apart: `place`, `swapped`, `far`, `outlier`, `large-costs` or `prizes`.
        text: A sentence.
        pointer: The JSON pointer of the part of the request; None where it has no such part.
    """

    code: str
    text: str
    pointer: str | None = None


def listed(names: list[str]) -> str:
    """Return the first of some names, quoted, and how many more there are."""
    return shortened([repr(name[:_LONGEST_NAME]) for name in names], _MOST_NAMED)
