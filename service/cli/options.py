"""The arguments and options of the commands. The defaults shown are those of the service.

The options that several commands have are groups: dataclasses with a field for each option. A
parameter of a command whose type is a group stands for all its options; see `with_groups`.
"""

import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields, is_dataclass
from importlib.util import find_spec
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast

from typer import Argument, Option

ANY = "any"  # --start at any city; in a request this is null
Members = TypeVar("Members")
_KINDS = {"number": float, "integer": int, "boolean": bool}  # others are text, which plans.py reads
# Of each form, from the service's fields: `python -m tests.guide` writes them. To import the client
# or the forms would take longer than all else that --help needs.
_CLIENT = Path(cast(Any, find_spec("paretour")).origin).parent
_OPTIONS = json.loads((_CLIENT / "members.json").read_bytes())["options"]

File = Annotated[
    Path,
    Argument(
        help="JSON: a request, or its coordinates. GeoJSON, GPX or KML: stops, as points. CSV or"
        " XLSX: stops with columns lon and lat, or four to eight numbers for each city: x and y in"
        " the plane of each objective. With more files: the first objective. - is standard input."
    ),
]
MoreFiles = Annotated[
    list[Path] | None,
    Argument(
        help="The second objective, and maybe the third and fourth. Each file is a table (x and y"
        " for each city, or a matrix of costs) or a file of TSPLIB."
    ),
]
FileOrMap = Annotated[
    Path,
    Argument(
        metavar="FILE",
        help="As of `paretour front`, or a map as of `paretour coverage`. - is standard input.",
    ),
]
FleetFile = Annotated[
    Path,
    Argument(
        metavar="FILE",
        help="JSON: a request for POST /fleet, or a problem of VROOM. CSV or XLSX: stops with"
        " demands or windows. CVRPLIB, Solomon, Li and Lim. - is standard input.",
    ),
]
VehiclesFile = Annotated[
    Path | None,
    Argument(
        metavar="VEHICLES",
        help="CSV or XLSX: vehicles, with their capacities, shifts and places, if FILE is a"
        " table of stops.",
    ),
]
Angles = Annotated[
    str | None,
    Option(help="Angles in degrees for which the network builds tours, such as 10,45,80."),
]
Unrounded = Annotated[
    bool,
    Option(
        "--unrounded",
        help="Plan in the planes of two EUC_2D files, without rounding distances as TSPLIB does.",
    ),
]
MapFile = Annotated[
    Path,
    Argument(
        metavar="MAP",
        help="A map.yaml of ROS; PNG or PGM, dark where there are obstacles; or JSON, a whole"
        " request or a message nav_msgs/OccupancyGrid. - is standard input.",
    ),
]
Robots = Annotated[
    list[str] | None,
    Option(
        "--robot",
        metavar="X,Y[,YAW]",
        help="Where one of several robots starts, in the frame of the map; once for each robot."
        " They share the places: total distance against longest route.",
    ),
]
CostLayers = Annotated[
    list[Path] | None,
    Option(
        "--cost-layer",
        metavar="FILE",
        help="The second objective: CSV, a cost for each pixel. Given two or three times, each is"
        " an objective, which is named after its file.",
    ),
]
PathFile = Annotated[
    Path | None,
    Option(
        "--path",
        metavar="FILE",
        help="Also write its path over the map, in metres: .json as nav_msgs/Path, .csv as x, y,"
        " yaw and place.",
    ),
]
PathFolder = Annotated[
    Path | None,
    Option(
        metavar="FOLDER",
        help="Also write the path of each tour, or of each robot of each plan, into this folder, in"
        " both formats of `paretour tour --path`. It is made if it does not exist.",
    ),
]
FrontId = Annotated[str, Argument(metavar="FRONT", help="The id of a front of the service.")]
Changes = Annotated[
    Path | None,
    Argument(
        help="JSON: what has changed: `add`, `costs` or any other member of a request to replan."
        " - is standard input."
    ),
]
AskedOffers = Annotated[
    Path,
    Argument(
        metavar="ASKED",
        help="JSON: `order`, `slots` or `every`, and what has changed, as `now`: the members of a"
        " request for POST /front/{id}/offers. - is standard input.",
    ),
]
AskedFront = Annotated[
    str,
    Argument(
        metavar="FRONT",
        help="A file with a front of any kind, as --json prints it; - is standard input. With"
        " --url: the id of a front of the service.",
    ),
]
ServiceUrl = Annotated[
    str, Option("--url", help="The URL of the service that has the front, such as localhost:8000.")
]
AsJson = Annotated[bool, Option("--json", help="Print the answer as the service gives it.")]
ApiKey = Annotated[
    str | None, Option(help="The key for a service that requires one.", envvar="PARETOUR_API_KEY")
]
Workers = Annotated[
    int | None, Option(help="How many tasks are planned at a time.", show_default=False)
]


def _contrary(given: bool | None) -> bool | None:
    """Return the member of a request that a flag stands for: false where it was given."""
    return None if given is None else not given


def _option(made: Mapping[str, Any]) -> Any:
    """Return the annotation of an option, which is None where it was not given."""
    name = made["name"]
    kind: Any = list[str] if "each" in made else _KINDS.get(made["type"], str)
    flag = made.get("flag", name).replace("_", "-")
    hidden, is_flag = made.get("hidden", False), kind is bool
    option = Option(
        f"--{flag}",
        help=made["help"],
        metavar=made.get("each"),
        callback=_contrary if "flag" in made else None,
        hidden=hidden,
        min=made.get("min"),
        max=made.get("max"),
        show_default=str(made["default"]) if "default" in made and not is_flag else True,
    )
    return Annotated[kind | None, option]


def _of_forms(
    *forms: str, without: Collection[str] = ()
) -> Callable[[type[Members]], type[Members]]:
    """Return a decorator that makes a group of the options of these forms, given by name."""
    made = {option["name"]: option for form in forms for option in _OPTIONS[form]}

    def decorate(group: type[Members]) -> type[Members]:
        names = [name for name in made if name not in without]
        group.__annotations__ = {name: _option(made[name]) for name in names}
        for name in names:
            setattr(group, name, None)
        return dataclass(frozen=True, kw_only=True)(group)

    return decorate


@_of_forms("FrontRequest")
class OfFront:
    """The members of a request for a front; those that are not given are None."""


@_of_forms("FrontRequest", "CoverageRequest", without=("size", "paths"))
class OfTour:
    """The members of a request for one tour, through cities or on a map."""


@_of_forms("CoverageRequest")
class OfMap:
    """The members of a request about a map."""


@_of_forms("FleetRequest")
class OfFleet:
    """The members of a request for a fleet."""


@_of_forms("ReplanRequest", without=("actor",))
class OfRest:
    """The members of a request to replan."""


@dataclass(frozen=True, kw_only=True)
class OutputFormat:
    """The format to print a front in, and the file to draw it into.

    By default it is a chart with three tours, or all plans, on a terminal, and a table of all
    elsewhere.
    """

    as_json: AsJson = False
    as_csv: Annotated[
        bool, Option("--csv", help="Print a line for each tour, or each route of a plan.")
    ] = False
    as_table: Annotated[
        bool,
        Option(
            "--table",
            help="On a terminal, print all tours or plans instead of a chart and three tours.",
        ),
    ] = False
    plot: Annotated[
        Path | None,
        Option(help="Draw the front into this file; also its map, with three tours or plans."),
    ] = None


@_of_forms("TourQuery")
class Ways:
    """The ways to choose a tour. Exactly one must be given."""


@dataclass(frozen=True, kw_only=True)
class Asking:
    """The picks so far, and how many questions and options there are."""

    picks: Annotated[
        str | None,
        Option(help="For each question the number of an option, such as 0,2; the rest is asked."),
    ] = None
    questions: Annotated[
        int, Option(help="How many questions there are, at most.", min=1, max=10)
    ] = 3
    options: Annotated[
        int, Option(help="How many options each question has, at most.", min=2, max=6)
    ] = 3


@dataclass(frozen=True, kw_only=True)
class Service:
    """The service that plans; without a URL this process does."""

    url: Annotated[
        str | None,
        Option(help="The URL of a service that plans in place of this process: localhost:8000."),
    ] = None
    api_key: ApiKey = None


def with_groups(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command for Typer, with a parameter for each option in place of each group."""
    given = signature(command).parameters.values()
    groups: dict[str, Any] = {
        each.name: each.annotation for each in given if is_dataclass(each.annotation)
    }
    parameters = [each for each in given if each.name not in groups]
    parameters += [
        Parameter(
            option.name, Parameter.KEYWORD_ONLY, default=option.default, annotation=option.type
        )
        for group in groups.values()
        for option in fields(group)
    ]

    def run(**options: Any) -> None:
        made = {
            name: group(**{each.name: options.pop(each.name) for each in fields(group)})
            for name, group in groups.items()
        }
        command(**options, **made)

    run.__name__, run.__doc__ = command.__name__, command.__doc__
    run.__annotations__ = {each.name: each.annotation for each in parameters}
    run.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    return run
