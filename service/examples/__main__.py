"""Write the examples into this folder, or into the directory given as argument."""

import json
import sys
from pathlib import Path
from typing import Any

from service.examples.deliveries import deliveries
from service.examples.inspection import inspection
from service.examples.warehouse import cleaning


def write(directory: Path) -> None:
    """Write all example requests into a directory, one JSON file each."""
    requests = {
        "city-deliveries": deliveries(),
        "drone-inspection": inspection(),
        "warehouse-cleaning": cleaning(),
    }
    for name, request in requests.items():
        (directory / f"{name}.json").write_text(_formatted(request))


def _formatted(request: dict[str, Any]) -> str:
    """Return JSON with a line for each member, and for each row of a list of lists."""
    members = [f"  {json.dumps(name)}: {_rows(value)}" for name, value in request.items()]
    return "{\n" + ",\n".join(members) + "\n}\n"


def _rows(value: Any) -> str:
    if isinstance(value, list) and isinstance(value[0], list):
        return "[\n" + ",\n".join(f"    {json.dumps(row)}" for row in value) + "\n  ]"
    return json.dumps(value)


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
