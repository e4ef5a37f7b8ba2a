"""Write records of JSON as the rows of a table, and check the lists in a request."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

from service.files.reading import Source

_OBJECTS = {"stops", "vehicles", "robots", "shipments", "objectives", "cost_layers"}
_ROWS = {"coordinates", "grid", "cost_layer"}
_WINDOWS = ("window", "windows", "time_window", "time_windows")


def rows_of(records: Sequence[dict[str, Any]]) -> Iterator[list[str]]:
    """Yield a heading, the names of all members of records; then the members of each record."""
    flat = [dict(members_of(record)) for record in records]
    names = list(dict.fromkeys(name for record in flat for name in record))
    yield names
    for record in flat:
        yield [record.get(name, "") for name in names]


def members_of(record: dict[str, Any], depth: int = 0) -> Iterator[tuple[str, str]]:
    """Yield the members of a record as text, also those of inner objects and coordinates."""
    for name, value in record.items():
        if isinstance(value, dict) and depth < 2:
            yield from members_of(value, depth + 1)
        elif name in ("location", "coordinates") and is_place(value):
            yield "longitude", str(value[0])
            yield "latitude", str(value[1])
        elif name in _WINDOWS and is_place(value):
            yield name, f"{value[0]}-{value[1]}"
        elif name in _WINDOWS and isinstance(value, list) and all(map(is_place, value)):
            yield name, "; ".join(f"{each[0]}-{each[1]}" for each in value)
        elif isinstance(value, list) and all(isinstance(each, str) for each in value):
            yield name, "; ".join(value)
        elif isinstance(value, list) and len(value) == 1:
            yield name, text_of(value[0])
        else:
            yield name, text_of(value)


def is_place(value: Any) -> bool:
    """Return whether a value is a list of two numbers or more."""
    return isinstance(value, list) and len(value) >= 2 and all(map(is_number, value[:2]))


def is_number(value: Any) -> bool:
    """Return whether a value is a number, and not true or false."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def text_of(value: Any) -> str:
    """Return a value as the text of a field."""
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value)


def check_lists(source: Source, request: dict[str, Any]) -> None:
    """Raise UnreadableFile if a member that the page draws is not a list of objects or of rows."""
    for names, kind, what in ((_OBJECTS, dict, "objects"), (_ROWS, list, "rows")):
        for name in names & request.keys():
            items = request[name]
            if not isinstance(items, list) or not all(isinstance(each, kind) for each in items):
                raise source.refusal("not-a-list-of", name, items=what, came=items)
    layers = dict(_layers(source, request))
    for name, rows in layers.items():
        if not rows or not rows[0]:
            raise source.refusal("no-cell", name)
    for name, rows in layers.items():
        if "grid" in layers and len(rows) != len(layers["grid"]):
            raise source.refusal("not-as-many-rows", f"{name} and grid")


def _layers(source: Source, request: dict[str, Any]) -> Iterator[tuple[str, list[Any]]]:
    """Yield the rows of the grid and of each layer of costs, with its name."""
    for name in ("grid", "cost_layer"):
        if name in request:
            yield name, request[name]
    for index, item in enumerate(request.get("cost_layers", ())):
        rows, name = item.get("layer"), f"cost_layers/{index}/layer"
        if not isinstance(rows, list) or not all(isinstance(row, list) for row in rows):
            raise source.refusal("not-a-list-of", name, items="rows", came=rows)
        yield name, rows
