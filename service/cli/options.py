"""Arguments and options of the commands. The defaults shown are those of the service."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

ANY = "any"  # --start at any city; in a request this is null


File = Annotated[
    Path,
    Argument(
        help="JSON: a request, or its coordinates. GeoJSON: stops, as points. CSV or XLSX: stops"
        " with columns lon and lat, or four numbers for each city: x and y in the plane of each"
        " objective. With a second file: the first objective. - is standard input."
    ),
]
SecondFile = Annotated[
    Path | None,
    Argument(
        help="The second objective. Each file is a table (x and y for each city, or a matrix of"
        " costs) or a file of TSPLIB."
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
TimeLimit = Annotated[
    float | None,
    Option(help="Seconds of search; 0 takes the tours of the network.", show_default="1.0"),
]
Angles = Annotated[
    str | None,
    Option(help="Angles in degrees for which the network builds tours, such as 10,45,80."),
]
Size = Annotated[int | None, Option(help="The most tours to return.", show_default="100")]
Start = Annotated[
    int | None, Option(help="The city at which reported tours begin.", show_default="0")
]
StartOrId = Annotated[
    str | None,
    Option(
        "--start",
        help="The city at which reported tours begin, by index or id; with --open also `any`.",
        show_default="0",
    ),
]
Open = Annotated[
    bool | None, Option("--open", help="Plan open routes, which do not return to their start.")
]
End = Annotated[int | None, Option(help="The city at which open routes end.", show_default="any")]
EndOrId = Annotated[
    str | None,
    Option("--end", help="The city at which open routes end, by index or id.", show_default="any"),
]
Augment = Annotated[int | None, Option(help="Deprecated: without effect.", hidden=True)]
Repairs = Annotated[
    int | None,
    Option(
        help="How often the network repairs each of its tours.",
        show_default="depends on the number of cities with --time-limit 0, else 0",
    ),
]
Seed = Annotated[int | None, Option(help="The seed of all random choices.", show_default="0")]
ActorName = Annotated[str | None, Option("--actor", help="The network, one of `paretour actors`.")]
Unrounded = Annotated[
    bool,
    Option(
        "--unrounded",
        help="Plan in the planes of two EUC_2D files, without rounding distances as TSPLIB does.",
    ),
]
FleetSize = Annotated[int | None, Option(help="The most plans to return.", show_default="100")]
AsJson = Annotated[bool, Option("--json", help="Print the answer as the service gives it.")]
AsTable = Annotated[
    bool,
    Option("--table", help="On a terminal, print all tours instead of a chart and three tours."),
]
AsCsv = Annotated[bool, Option("--csv", help="Print a line for each tour.")]
RoutesAsCsv = Annotated[bool, Option("--csv", help="Print a line for each route.")]
PlansAsTable = Annotated[
    bool, Option("--table", help="On a terminal, print all plans without a chart.")
]
Angle = Annotated[
    float | None,
    Option(
        min=0, max=90, help="The tour nearest to this angle: near 0 the second length is small."
    ),
]
Balance = Annotated[
    float | None,
    Option(
        min=0,
        max=1,
        help="The tour nearest to this balance: 0 at the least first length, 1 at the second.",
    ),
]
FirstAtMost = Annotated[
    float | None, Option(help="The least second length, with at most this first length.")
]
SecondAtMost = Annotated[
    float | None, Option(help="The least first length, with at most this second length.")
]
Knee = Annotated[
    bool,
    Option("--knee", help="The least sum of both lengths, each scaled to 0 to 1 over the front."),
]
Plot = Annotated[Path | None, Option(help="Draw the front into this file.")]
PlotMap = Annotated[
    Path | None,
    Option("--plot", help="Draw the map with three tours or plans, and the front, into a file."),
]
Url = Annotated[
    str | None,
    Option(help="The URL of a service that plans in place of this process: localhost:8000."),
]
ApiKey = Annotated[
    str | None, Option(help="The key for a service that requires one.", envvar="PARETOUR_API_KEY")
]

MapFile = Annotated[
    Path,
    Argument(
        metavar="MAP",
        help="A map.yaml of ROS; PNG or PGM, dark where there are obstacles; or JSON, a whole"
        " request or a message nav_msgs/OccupancyGrid. - is standard input.",
    ),
]
CellSize = Annotated[
    float | None, Option(help="The width of a pixel in metres, if the map does not say it.")
]
StartPose = Annotated[
    str | None,
    Option(help="Where the robot is: x and y in the frame of the map, such as -2.0,-0.5."),
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
EndPose = Annotated[
    str | None, Option(help="Where the robot must end, in the same form; with --open.")
]
Unknown = Annotated[
    str | None,
    Option(help="free: the robot may go through unknown cells.", show_default="blocked"),
]
RobotRadius = Annotated[float | None, Option(help="In metres.", show_default="0")]
Spacing = Annotated[
    float | None,
    Option(help="The distance of places in metres: one is visited in each square of this width."),
]
CostLayer = Annotated[Path | None, Option(help="The second objective: CSV, a cost for each pixel.")]
Paths = Annotated[
    bool | None,
    Option("--paths", help="With --json, add the path of each tour, in cells and metres."),
]
FrontId = Annotated[str, Argument(metavar="FRONT", help="The id of a front of the service.")]
Changes = Annotated[
    Path | None,
    Argument(
        help="JSON: what has changed: `add`, `costs` or any other member of a request to replan."
        " - is standard input."
    ),
]
Done = Annotated[str | None, Option(help="The stops visited, in order, such as depot,order-17.")]
Position = Annotated[
    str | None,
    Option(help="The stop from which the rest is planned.", show_default="the last stop done"),
]
Remove = Annotated[
    str | None, Option(help="Stops that need no visit any more, with commas between.")
]
MinKept = Annotated[
    float | None,
    Option(min=0, max=1, help="Only return tours that keep this share of the driven tour's legs."),
]
ServiceUrl = Annotated[
    str, Option("--url", help="The URL of the service that has the front, such as localhost:8000.")
]
Workers = Annotated[
    int | None, Option(help="How many tasks are planned at a time.", show_default=False)
]
