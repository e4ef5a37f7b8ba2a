"""Ids of stops: names that come twice are numbered, and cities are not ids of orders."""

from collections.abc import Sequence

from service.files.column_names import NAMES, plain_name
from service.files.reading import Source, quoted
from service.files.tables import number_in


def are_names(heading: str) -> bool:
    """Return whether a heading is that of names, which may come twice, and not of ids."""
    return plain_name(heading) in NAMES


def is_list_of_cities(cities: Sequence[str], others: Sequence[Sequence[str]]) -> bool:
    """Return whether cities name the rows of a table: all differ, and no other text does."""
    are_texts = [any(text and number_in(text) is None for text in each) for each in others]
    return all(cities) and len(set(cities)) == len(cities) and not any(are_texts)


def numbered(source: Source, heading: str, names: Sequence[str]) -> list[str]:
    """Return names, each of them once and none missing, with a note on those that are new."""
    ids = each_once(names, "{} {}")
    new = [each for each, name in zip(ids, names, strict=True) if each != name]
    if new:
        what = f"{quoted(heading)} has names that come twice, or none"
        source.note("ids", f"{what}: they are numbered, as {quoted(new[0])}.")
    return ids


def each_once(names: Sequence[str], form: str = "{} ({})") -> list[str]:
    """Return names, each of them once: those that come again have a number, those missing theirs.

    `form` is how a name is written with its number.
    """
    taken = {name for name in names if name}
    seen: dict[str, None] = {}  # in their order
    latest: dict[str, int] = {}
    for row, name in enumerate(names, 1):
        found = name or f"{row}"
        if found in seen or (not name and found in taken):
            number = latest.get(found, 1) + 1
            while form.format(found, number) in taken:
                number += 1
            latest[found] = number
            found = form.format(found, number)
        seen[found] = None
        taken.add(found)
    return [*seen]
