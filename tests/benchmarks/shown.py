"""Print the results of a benchmark as they are stored, in tables, with commits and machines.

Single figures are printed as they are, and what was found of several instances as their mean and
deviation. Points and tours are counted.
"""

from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np

from tests.benchmarks.markdown import table

_MOST_COLUMNS = 8  # of a table
_ORIGIN = ("commit", "cpu", "python", "threads", "date")
_KEPT_APART = (*_ORIGIN, "digest", "busy")


def rows(results: dict[str, Any]) -> str:
    """Return tables of what is stored, and below them where each row comes from.

    Rows with the same figures are in one table. A row of a list of rounds is a row for each round.
    """
    entries = {"": results} if "commit" in results else results
    tables: dict[tuple[str, ...], dict[str, dict[str, str]]] = {}
    for key, entry in entries.items():
        for name, figures in _rows_of(key, entry).items():
            tables.setdefault(tuple(figures), {})[name] = figures
    parts = [_table(found) for found in tables.values()]
    origins = (f"{key}{': ' if key else ''}{_origin(each)}" for key, each in entries.items())
    return "\n".join([*parts, *origins] if entries else [])


def _rows_of(key: str, entry: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Return the figures of an entry by the name of their row: its key, and the round if any.

    Of very many figures those of each part of the entry are a row.
    """
    leaves = [*_leaves({k: v for k, v in entry.items() if k not in _KEPT_APART})]
    found: dict[str, dict[str, str]] = {}
    for place, value in leaves:
        parts = place.removeprefix("instances / ").split(" / ")
        kept = [part for part in parts if not part.isdecimal()]
        rounds = [part for part in parts[:-1] if part.isdecimal()]
        if len(leaves) > _MOST_COLUMNS and not rounds:
            rounds, kept = kept[:-1], kept[-1:]
        name = ", ".join(filter(None, (key, *rounds)))
        found.setdefault(name, {})[" / ".join(kept) or "value"] = value
    return found


def _table(found: dict[str, dict[str, str]]) -> str:
    """Return a table whose columns are the figures, or else the rows if these are fewer."""
    columns = list(next(iter(found.values())))
    if len(columns) <= max(_MOST_COLUMNS, len(found)):
        return table(["row", *columns], [[name, *each.values()] for name, each in found.items()])
    pairs = ((column, [each[column] for each in found.values()]) for column in columns)
    return table(["figure", *found], [[column, *values] for column, values in pairs])


def _origin(entry: dict[str, Any]) -> str:
    known = {name: entry[name] for name in _ORIGIN if name in entry}
    labels = {"python": "Python {}", "threads": "threads {}"}
    cells = [labels.get(name, "{}").format(value) for name, value in known.items()]
    busy = entry.get("busy", 0)
    return ", ".join([*cells, *([f"programs a core {busy}"] if busy > 1 else [])])


def _leaves(value: Any, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield each figure with its place."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _leaves(inner, f"{place} / {name}" if place else name)
    elif isinstance(value, list):
        yield from _summary(value, place)
    else:
        yield place, _written(value)


def _summary(values: list[Any], place: str) -> Iterator[tuple[str, str]]:
    """Yield what the entries of a list have in common: names, or numbers."""
    if values and all(isinstance(each, dict) for each in values):
        for name in dict.fromkeys(chain.from_iterable(values)):
            found = [each[name] for each in values if name in each]
            yield from _summary(found, f"{place} / {name}")
    elif values and all(_is_number(each) for each in values):
        deviation = f" ± {np.std(values):.2g}" if len({*values}) > 1 else ""
        yield place, f"{np.mean(values):.6g}{deviation} (of {len(values)})"
    elif values and all(_is_of_rounds(each) for each in values):
        for i, each in enumerate(zip(*values, strict=True)):
            yield from _summary(list(each), f"{place} / {i}")
    else:
        yield place, f"{len(values)} entries"


def _is_of_rounds(value: Any) -> bool:
    """Return whether an instance was measured several times; points and tours are of numbers."""
    return isinstance(value, list) and all(isinstance(each, dict) for each in value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _written(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
