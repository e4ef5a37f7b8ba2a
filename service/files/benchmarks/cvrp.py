"""Read fleets in the keywords and sections of TSPLIB, CVRPLIB, VRPLIB and LKH."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.files.benchmarks.keywords import check_fleet
from service.files.benchmarks.vehicles import Depots, vehicles_of
from service.files.fleets import Shipment, Stop, Vehicle, fleet_request, planar
from service.files.reading import Reading
from service.files.tables import number_in
from service.files.tsplib import TsplibFile, costs, note_rounded, plain

Array = NDArray[np.float64]
_Member = Literal["service", "release", "prize"]
_PAIRS = "PICKUP_AND_DELIVERY_SECTION"
_OPEN = ("OVRP", "COVRP", "OVRPTW")
_BESIDE_PAIRS = ("DEMAND_SECTION", "LINEHAUL_SECTION", "SERVICE_TIME", "SERVICE_TIME_SECTION")


def read_cvrp(file: TsplibFile) -> Reading:
    """Return the request of a file about a fleet: total against longest route.

    Raises:
        UnreadableFile: A keyword or a section is missing, does not fit DIMENSION, or says what is
            not supported.
    """
    check_fleet(file)
    depots = Depots.of(file, open_routes=file.word("TYPE").upper() in _OPEN)
    clients = [at for at in range(file.dimension) if at not in depots.stops]
    stops: list[Stop] = [{"id": depots.name(at)} for at in range(file.dimension)]
    windows, shipments = _add_visits(file, stops, clients)
    fleet = vehicles_of(file, depots, clients, windows)
    _add_prizes(file, stops, clients, fleet.unit_cost)
    for at, vehicle in fleet.pinned.items():
        stops[at]["vehicle"] = vehicle
    for at, skill in fleet.skills.items():
        stops[at]["skills"] = [skill]
    if not any("demand" in stop for stop in stops):
        _remove_capacities(file, fleet.types)
    kept = [at for at in range(file.dimension) if at not in depots.stops or at in fleet.used]
    matrix = plain(costs(file)[np.ix_(kept, kept)])
    note_rounded(file)
    objectives = planar({"name": "total length", "matrix": matrix})
    request = fleet_request([stops[at] for at in kept], fleet.types, objectives, shipments or None)
    fleet.check_distances(file, timed="clock" in request)
    if "clock" in request and "DISTANCE" in file.header:
        text = "DISTANCE limits the time of a route, which service and waiting are part of."
        file.source.note("times", text)
    return file.source.reading("fleet", request)


def _add_visits(
    file: TsplibFile, stops: list[Stop], clients: list[int]
) -> tuple[Array | None, list[Shipment]]:
    """Add demands, windows, services and releases to stops; return all windows, and shipments."""
    _check_backhauls(file)
    if _PAIRS in file.sections:
        windows, shipments = _add_pairs(file, stops, clients)
    else:
        _add_demands(file, stops, clients)
        windows = None
        if "TIME_WINDOW_SECTION" in file.sections:
            windows = file.of_nodes("TIME_WINDOW_SECTION", 2)
        _add(stops, clients, "service", _each_or_one(file, "SERVICE_TIME"))
        shipments = []
    if windows is not None:
        for at in clients:
            stops[at]["window"] = windows[at].tolist()
    _add(stops, clients, "release", _each_or_one(file, "RELEASE_TIME"))
    return windows, shipments


def _add_demands(file: TsplibFile, stops: list[Stop], clients: list[int]) -> None:
    found = [name for name in ("DEMAND_SECTION", "LINEHAUL_SECTION") if name in file.sections]
    if len(found) > 1:
        raise file.source.refusal("stands-beside", found[0], keyword=found[1])
    if not found and "CVRP" not in file.word("TYPE").upper():
        return
    name = found[0] if found else "DEMAND_SECTION"
    columns = max(1, len(file.words(name)) // file.dimension - 1)
    demands = file.of_nodes(name, columns)
    for at in clients:
        stops[at]["demand"] = [_load(file, each, name, stops[at]) for each in demands[at].tolist()]


def _load(file: TsplibFile, number: float, section: str, stop: Stop) -> int:
    if not number.is_integer() or number < 0:
        raise file.source.refusal("whole-from-0", f"{section}, stop {stop['id']}", came=number)
    return int(number)


def _check_backhauls(file: TsplibFile) -> None:
    """Raise UnreadableFile if something is picked up and taken to the depot."""
    name = "BACKHAUL_SECTION"
    numbers = file.parsed(name, file.listed(name))
    if len(numbers) == 2 * file.dimension:  # of each node, as PyVRP writes it
        numbers = file.of_nodes(name, 1)
    if numbers.any():
        raise file.source.refusal("no-backhauls", name)


def _add_pairs(
    file: TsplibFile, stops: list[Stop], clients: list[int]
) -> tuple[Array | None, list[Shipment]]:
    """Add demands and services of pick-ups and deliveries; return all windows, and shipments."""
    if both := [each for each in _BESIDE_PAIRS if {each} & {*file.header, *file.sections}]:
        raise file.source.refusal("stands-beside", both[0], keyword=_PAIRS)
    rows = file.of_nodes(_PAIRS, 6)
    windows = _windows_beside(file, rows[:, 1:3])
    shipments: list[Shipment] = []
    for at in clients:
        demand, _, _, service, pickup, delivery = rows[at].tolist()
        if service:
            stops[at]["service"] = service
        if delivery:
            _check_pair(file, rows, at, int(delivery) - file.first_node)
            stops[at]["demand"] = [_load(file, demand, _PAIRS, stops[at])]
            other = stops[int(delivery) - file.first_node]["id"]
            shipments.append({"pickup": stops[at]["id"], "delivery": other})
        elif pickup:
            _check_pair(file, rows, int(pickup) - file.first_node, at)
        elif demand:
            stops[at]["demand"] = [_load(file, demand, _PAIRS, stops[at])]
    return windows, shipments


def _windows_beside(file: TsplibFile, of_pairs: Array) -> Array | None:
    """Return the windows of pick-ups and deliveries, or of a section that says the same."""
    windows = of_pairs if of_pairs.any() else None
    if "TIME_WINDOW_SECTION" not in file.sections:
        return windows
    again = file.of_nodes("TIME_WINDOW_SECTION", 2)
    if windows is not None and not np.array_equal(windows, again):
        raise file.source.refusal("windows-differ", "TIME_WINDOW_SECTION", section=_PAIRS)
    return again


def _check_pair(file: TsplibFile, rows: Array, pickup: int, delivery: int) -> None:
    """Raise UnreadableFile unless two stops name each other."""
    first = file.first_node
    inside = 0 <= pickup < len(rows) and 0 <= delivery < len(rows)
    if not inside or rows[pickup, 5] != delivery + first or rows[delivery, 4] != pickup + first:
        came = f"{pickup + first} and {delivery + first}"
        raise file.source.refusal("pairs-differ", _PAIRS, came=came)


def _each_or_one(file: TsplibFile, name: str) -> Callable[[int], float]:
    """Return the number of each stop: of its section, or the one of a keyword; or 0."""
    section = f"{name}_SECTION"
    if section in file.sections:
        if name in file.header:
            raise file.source.refusal("stands-beside", name, keyword=section)
        numbers = file.of_nodes(section, 1)[:, 0].tolist()
        return lambda at: numbers[at]
    one = number_in(file.word(name)) if name in file.header else 0
    if one is None:
        raise file.source.refusal("no-number", name, came=file.word(name))
    return lambda _: one


def _add(
    stops: list[Stop], clients: list[int], member: _Member, number: Callable[[int], float]
) -> None:
    for at in clients:
        if value := number(at):
            stops[at][member] = int(value) if float(value).is_integer() else value


def _add_prizes(file: TsplibFile, stops: list[Stop], clients: list[int], unit: float) -> None:
    """Add prizes, in the unit of distances. As PyVRP reads them, 0 means that a visit is a must."""
    if "PRIZE_SECTION" not in file.sections:
        return
    prizes = file.of_nodes("PRIZE_SECTION", 1)[:, 0] / unit
    _add(stops, clients, "prize", lambda at: float(prizes[at]))


def _remove_capacities(file: TsplibFile, types: Sequence[Vehicle]) -> None:
    if any("capacity" in each for each in types):
        file.source.note("demand", "Capacities were not used, as no stop has a demand.")
    for each in types:
        each.pop("capacity", None)
