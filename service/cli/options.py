"""Arguments and options of the commands. A default shown is the service's own."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

ANY = "any"  # the value of --start where any city will do: null in a request


File = Annotated[
    Path,
    Argument(
        help="JSON: a request, or its coordinates. GeoJSON: stops, as points. CSV or XLSX: stops"
        " with columns lon and lat, or four numbers for each city, x and y in the plane of either"
        " objective. Or, with a second file, the first objective. - is standard input."
    ),
]
SecondFile = Annotated[
    Path | None,
    Argument(
        help="The second objective. Either file is a table, x and y for each city or a matrix of"
        " costs, or TSPLIB's."
    ),
]
FleetFile = Annotated[
    Path,
    Argument(
        metavar="FILE",
        help="JSON: a request, as for POST /fleet, or VROOM's. CSV or XLSX: stops with demands or"
        " windows. CVRPLIB, Solomon's, Li and Lim's. - is standard input.",
    ),
]
VehiclesFile = Annotated[
    Path | None,
    Argument(
        metavar="VEHICLES",
        help="CSV or XLSX: vehicles, with their capacities, shifts and places, where FILE is a"
        " table of stops.",
    ),
]
TimeLimit = Annotated[
    float | None, Option(help="Seconds of search; 0 takes the network's tours.", show_default="1.0")
]
Angles = Annotated[
    str | None, Option(help="Angles in degrees for the network to look along, as 10,45,80.")
]
Size = Annotated[int | None, Option(help="The most tours to give.", show_default="100")]
Start = Annotated[int | None, Option(help="The city to report tours from.", show_default="0")]
StartOrId = Annotated[
    str | None,
    Option(
        "--start",
        help="The city to report tours from, by index or id; with --open the start, or `any`.",
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
        show_default="with --time-limit 0 by the number of cities, else 0",
    ),
]
Seed = Annotated[int | None, Option(help="Of all that is random.", show_default="0")]
ActorName = Annotated[str | None, Option("--actor", help="The network, one of `paretour actors`.")]
Unrounded = Annotated[
    bool,
    Option(
        "--unrounded",
        help="Plan in the planes of two EUC_2D files, not with distances rounded as TSPLIB says.",
    ),
]
AsJson = Annotated[bool, Option("--json", help="Print the answer as the service gives it.")]
AsTable = Annotated[
    bool, Option("--table", help="Print all tours on a terminal too, not a chart and three tours.")
]
AsCsv = Annotated[bool, Option("--csv", help="Print a line for each tour.")]
Angle = Annotated[
    float | None,
    Option(min=0, max=90, help="The tour nearest to this: near 0 the second length is small."),
]
Balance = Annotated[
    float | None,
    Option(
        min=0,
        max=1,
        help="The tour nearest to this: 0 at the least first length, 1 at the least second.",
    ),
]
FirstAtMost = Annotated[
    float | None, Option(help="The least second length of which the first is within this.")
]
SecondAtMost = Annotated[
    float | None, Option(help="The least first length of which the second is within this.")
]
Knee = Annotated[
    bool, Option("--knee", help="The least sum of both lengths, each in the front's own box.")
]
Plot = Annotated[Path | None, Option(help="Draw the front into this file.")]
PlotMap = Annotated[
    Path | None,
    Option("--plot", help="Draw the map with three tours or plans, and the front, into a file."),
]
Url = Annotated[
    str | None,
    Option(help="A running service that shall plan, not this process; as localhost:8000."),
]
ApiKey = Annotated[
    str | None, Option(help="For a service that asks for one.", envvar="PARETOUR_API_KEY")
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
    float | None, Option(help="Metres that a pixel is wide, where the map does not say it.")
]
StartPose = Annotated[
    str | None, Option(help="Where the robot is, as -2.0,-0.5: x and y in the frame of the map.")
]
Robots = Annotated[
    list[str] | None,
    Option(
        "--robot",
        metavar="X,Y[,YAW]",
        help="Where one of several robots starts, in the frame of the map; once for each of them."
        " They share the places: total distance against longest route.",
    ),
]
EndPose = Annotated[str | None, Option(help="Where the robot shall end, likewise; with --open.")]
Unknown = Annotated[
    str | None,
    Option(help="free: the robot may go through unknown cells.", show_default="blocked"),
]
RobotRadius = Annotated[float | None, Option(help="In metres.", show_default="0")]
Spacing = Annotated[
    float | None, Option(help="A place is visited in each square of so many metres.")
]
CostLayer = Annotated[Path | None, Option(help="The second objective: CSV, a cost for each pixel.")]
Paths = Annotated[
    bool | None,
    Option("--paths", help="Have the path of each tour, in cells and metres, with --json."),
]
FrontId = Annotated[str, Argument(metavar="FRONT", help="The id of a front of the service.")]
Changes = Annotated[
    Path | None,
    Argument(
        help="JSON: what has changed, as `add`, `costs` or any other member of a request to replan."
        " - is standard input."
    ),
]
Done = Annotated[str | None, Option(help="The stops visited, in order, as depot,order-17.")]
Position = Annotated[
    str | None, Option(help="The stop where the way goes on.", show_default="the last done")
]
Remove = Annotated[str | None, Option(help="Stops not to visit any more, with commas between.")]
MinKept = Annotated[
    float | None,
    Option(min=0, max=1, help="Only tours that keep this share of the driven one's legs."),
]
ServiceUrl = Annotated[
    str, Option("--url", help="The service that has the front; as localhost:8000.")
]
Workers = Annotated[int | None, Option(help="Plans made at a time.", show_default=False)]
