"""Problems of VROOM, as its API takes them: jobs, shipments and vehicles, times in seconds."""

from typing import Any

from service.files.reading import Reading, Source


def is_vroom(value: dict[str, Any]) -> bool:
    """Return whether a JSON object is a problem of VROOM."""
    return "jobs" in value and "vehicles" in value


def read_vroom(source: Source, value: dict[str, Any]) -> Reading:
    raise source.refusal("not yet")
