"""Print the results of a benchmark as they are stored: each row with its commit and machine.

Single figures are printed as they are, and what was found of several instances as their mean and
deviation. Points and tours are counted.
"""

from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np

_ORIGIN = ("commit", "cpu", "python", "threads", "date")
_KEPT_APART = (*_ORIGIN, "digest", "busy")


def rows(results: dict[str, Any]) -> str:
    """Return a paragraph for each row: its name, where it comes from, and its figures."""
    if "commit" in results:
        return "\n".join(_paragraph("", results))
    return "\n\n".join("\n".join(_paragraph(key, entry)) for key, entry in results.items())


def _paragraph(key: str, entry: dict[str, Any]) -> Iterator[str]:
    yield f"{key}{': ' if key else ''}{_origin(entry)}"
    figures = {name: value for name, value in entry.items() if name not in _KEPT_APART}
    for place, value in _leaves(figures):
        yield f"  {place}: {value}"


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
        deviation = f" ± {np.std(values):.4g}" if len(values) > 1 else ""
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
