"""Keywords and sections of CVRPLIB, VRPLIB and LKH: each is read, or a sentence names it."""

from typing import Any

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.files.test_examples import ACTORS
from tests.helpers.serving import LIMITS

HEAD = """NAME : four
COMMENT : (invented, no of trucks: 2)
TYPE : CVRP
DIMENSION : 4
CAPACITY : 10
EDGE_WEIGHT_TYPE : EUC_2D
"""
PLACES = """NODE_COORD_SECTION
1 0 0
2 3 4
3 6 8
4 9 12
"""
DEMANDS = """DEMAND_SECTION
1 0
2 1
3 2
4 3
"""
END = """DEPOT_SECTION
1
-1
EOF
"""
WINDOWS = "TIME_WINDOW_SECTION\n1 0 100\n2 0 60\n3 5 70\n4 0 90\n"
PAIRS = """PICKUP_AND_DELIVERY_SECTION
1 0 0 100 0 0 0
2 4 0 50 5 0 3
3 -4 0 90 6 2 0
4 2 0 80 7 0 0
"""


def text(head: str = "", sections: str = "", demands: str = DEMANDS, end: str = END) -> str:
    return HEAD + head + PLACES + demands + sections + end


def read(content: str) -> Reading:
    file = NamedFile("four.vrp", content.encode())
    return read_files([file], Bounds(), wanted=None)


def of(reading: Reading, items: str, member: str) -> list[Any]:
    return [each.get(member) for each in reading.request[items]]


# The text; then stops or vehicles, a member, and what it is of each of them.
READ = {
    "SERVICE_TIME in the head is of all but the depot": (
        text("SERVICE_TIME : 10\n"),
        ("stops", "service", [None, 10, 10, 10]),
    ),
    "a keyword may have = or a space behind it, as LKH reads it": (
        text("SERVICE_TIME = 2.5\nVEHICLES 2\n"),
        ("stops", "service", [None, 2.5, 2.5, 2.5]),
        ("vehicles", "count", [2]),
    ),
    "SERVICE_TIME_SECTION": (
        text(sections="SERVICE_TIME_SECTION\n1 0\n2 4\n3 0\n4 5\n"),
        ("stops", "service", [None, 4, None, 5]),
    ),
    "rows of another order have the numbers of their nodes": (
        text(sections="SERVICE_TIME_SECTION\n4 5\n3 0\n2 4\n1 0\n"),
        ("stops", "service", [None, 4, None, 5]),
    ),
    "windows, of the depot the shift": (
        text(sections=WINDOWS),
        ("stops", "window", [None, [0, 60], [5, 70], [0, 90]]),
        ("vehicles", "shift", [[0, 100]]),
    ),
    "RELEASE_TIME_SECTION": (
        text(sections="RELEASE_TIME_SECTION\n1 0\n2 50\n3 0\n4 7\n"),
        ("stops", "release", [None, 50, None, 7]),
    ),
    "RELEASE_TIME in the head": (
        text("RELEASE_TIME : 8\n"),
        ("stops", "release", [None, 8, 8, 8]),
    ),
    "a prize of 0 means that the visit is a must": (
        text(sections="PRIZE_SECTION\n1 0\n2 100\n3 0\n4 5.5\n"),
        ("stops", "prize", [None, 100, None, 5.5]),
    ),
    "DISTANCE": (text("DISTANCE : 200\n"), ("vehicles", "longest", [200])),
    "MAX_DURATION": (text("MAX_DURATION : 60\n"), ("vehicles", "longest", [60])),
    "the least of two limits": (
        text("DISTANCE : 200\nVEHICLES_MAX_DISTANCE : 90\n"),
        ("vehicles", "longest", [90]),
    ),
    "a limit for each vehicle": (
        text("VEHICLES : 2\n", "VEHICLES_MAX_DURATION_SECTION\n1 50\n2 60\n"),
        ("vehicles", "longest", [50, 60]),
        ("vehicles", "id", ["vehicle 1", "vehicle 2"]),
    ),
    "equal vehicles are one type, and rows say how many": (
        text(sections="CAPACITY_SECTION\n1 10\n2 8\n3 10\n").replace("CAPACITY : 10\n", ""),
        ("vehicles", "capacity", [[10], [8]]),
        ("vehicles", "count", [2, 1]),
    ),
    "loads of two dimensions": (
        text(
            sections="CAPACITY_SECTION\n1 10 4\n",
            demands="DEMAND_SECTION\n1 0 0\n2 1 2\n3 2 0\n4 3 1\n",
        ).replace("CAPACITY : 10\n", ""),
        ("stops", "demand", [None, [1, 2], [2, 0], [3, 1]]),
        ("vehicles", "capacity", [[10, 4]]),
    ),
    "VEHICLES, SALESMEN and VEHICLE": (text("SALESMEN : 3\n"), ("vehicles", "count", [3])),
    "LINEHAUL_SECTION is demand": (
        text(demands=DEMANDS.replace("DEMAND", "LINEHAUL")),
        ("stops", "demand", [None, [1], [2], [3]]),
    ),
    "backhauls of nothing": (
        text(sections="BACKHAUL_SECTION\n1 0\n2 0\n3 0\n4 0\n"),
        ("stops", "demand", [None, [1], [2], [3]]),
    ),
    "clients of one vehicle name it": (
        text("VEHICLES : 2\n", "VEHICLES_ALLOWED_CLIENTS_SECTION\n1 2\n2 3 4\n"),
        ("stops", "vehicle", [None, "vehicle 1", "vehicle 2", "vehicle 2"]),
    ),
    "clients of two vehicles of three have a skill": (
        text("VEHICLES : 3\n", "ALLOWED_CLIENTS_SECTION\n1 2 3\n2 3 4\n3 4\n"),
        ("stops", "vehicle", [None, "vehicle 1", None, None]),
        ("stops", "skills", [None, None, ["allowed 1"], ["allowed 2"]]),
        ("vehicles", "skills", [["allowed 1"], ["allowed 1", "allowed 2"], ["allowed 2"]]),
    ),
    "clients of all vehicles": (
        text("VEHICLES : 2\n", "VEHICLES_ALLOWED_CLIENTS_SECTION\n1 2 3 4\n2 2 3 4\n"),
        ("stops", "vehicle", [None, None, None, None]),
        ("vehicles", "count", [2]),
    ),
    "depots of vehicles": (
        text(
            "VEHICLES : 2\n", "VEHICLES_DEPOT_SECTION\n1 1\n2 2\n", end="DEPOT_SECTION\n1\n2\n-1\n"
        ),
        ("vehicles", "start", ["1", "2"]),
        ("stops", "demand", [None, None, [2], [3]]),
    ),
    "a depot of no vehicle is no stop": (
        text("VEHICLES : 1\n", "VEHICLES_DEPOT_SECTION\n1 1\n", end="DEPOT_SECTION\n1\n2\n-1\n"),
        ("stops", "id", ["1", "3", "4"]),
    ),
    "depots for loading again": (
        text(
            "VEHICLES : 2\nVEHICLES_MAX_RELOADS : 2\n",
            "VEHICLES_RELOAD_DEPOT_SECTION\n1 1 2\n2 1 2\n",
            end="DEPOT_SECTION\n1\n2\n-1\n",
        ),
        ("vehicles", "reload", [["1", "2"]]),
        ("vehicles", "max_trips", [3]),
    ),
    "fixed costs": (
        text("VEHICLES : 2\n", "VEHICLES_FIXED_COST_SECTION\n1 5\n2 7.5\n"),
        ("vehicles", "fixed", [5, 7.5]),
    ),
    "costs of a unit of distance that differ": (
        text("VEHICLES : 2\n", "VEHICLES_UNIT_DISTANCE_COST_SECTION\n1 1\n2 3\n"),
        ("vehicles", "per_distance", [1, 3]),
    ),
    "fixed costs and prizes in units of distance": (
        text(
            "VEHICLES : 999999\nVEHICLES_FIXED_COST : 6\nVEHICLES_UNIT_DISTANCE_COST : 2\n",
            "PRIZE_SECTION\n1 0\n2 8\n3 0\n4 4\n",
        ),
        ("vehicles", "fixed", [3]),
        ("vehicles", "count", [999_999]),
        ("stops", "prize", [None, 4, None, 2]),
    ),
    "pick-ups and deliveries": (
        text(sections=PAIRS, demands=""),
        ("stops", "demand", [None, [4], None, [2]]),
        ("stops", "service", [None, 5, 6, 7]),
        ("stops", "window", [None, [0, 50], [0, 90], [0, 80]]),
        ("shipments", "pickup", ["2"]),
        ("shipments", "delivery", ["3"]),
    ),
    "an open route": (
        text().replace(": CVRP", ": OVRP"),
        ("vehicles", "start", ["1"]),
        ("vehicles", "end", [None]),
    ),
    "a traveller with windows": (
        text(sections=WINDOWS, demands="")
        .replace(": CVRP", ": TSPTW")
        .replace("CAPACITY : 10\n", ""),
        ("stops", "window", [None, [0, 60], [5, 70], [0, 90]]),
        ("vehicles", "capacity", [None]),
        ("vehicles", "count", [1]),
    ),
    "nodes that count from 0": (
        HEAD
        + "NODE_COORD_SECTION\n0 0 0\n1 3 4\n2 6 8\n3 9 12\n"
        + "DEMAND_SECTION\n0 0\n1 1\n2 2\n3 3\nDEPOT_SECTION\n0\n-1\n",
        ("stops", "id", ["0", "1", "2", "3"]),
        ("vehicles", "start", ["0"]),
    ),
    "keywords in small letters": (
        text("SERVICE_TIME : 3\n").lower().replace("euc_2d", "EUC_2D"),
        ("stops", "service", [None, 3, 3, 3]),
    ),
    "comments behind a number sign": (
        text("SERVICE_TIME : 4  # minutes\n# to be checked\n").replace("2 1\n", "2 1 # bakery\n"),
        ("stops", "service", [None, 4, 4, 4]),
        ("stops", "demand", [None, [1], [2], [3]]),
    ),
    "nodes of other numbers, which are the same in all sections": (
        HEAD
        + PLACES.replace("1 0 0", "0 0 0")
        + DEMANDS.replace("1 0", "0 0")
        + "DEPOT_SECTION\n1\n-1\n",
        ("stops", "id", ["1", "2", "3", "4"]),
        ("stops", "demand", [None, [1], [2], [3]]),
    ),
    "windows of pairs, said twice": (
        text(sections=PAIRS + "TIME_WINDOW_SECTION\n1 0 100\n2 0 50\n3 0 90\n4 0 80\n", demands=""),
        ("stops", "window", [None, [0, 50], [0, 90], [0, 80]]),
    ),
    "no demands, and a capacity": (
        text("SERVICE_TIME : 4\n", demands="").replace("TYPE : CVRP\n", ""),
        ("stops", "service", [None, 4, 4, 4]),
        ("vehicles", "capacity", [None]),
    ),
    "an explicit matrix without places": (
        HEAD.replace("EUC_2D", "EXPLICIT\nEDGE_WEIGHT_FORMAT : LOWER_ROW")
        + "EDGE_WEIGHT_SECTION\n1\n2 3\n4 5 6\n"
        + DEMANDS
        + END,
        ("stops", "id", ["1", "2", "3", "4"]),
        ("stops", "demand", [None, [1], [2], [3]]),
    ),
    "a keyword that has no effect": (text("DEMAND_DIMENSION : 1\nOPTIMAL_VALUE: 30\n"),),
}


@pytest.mark.parametrize("name", READ)
def test_every_keyword_is_read(name: str) -> None:
    content, *expected = READ[name]
    reading = read(content)
    for items, member, each in expected:
        assert of(reading, items, member) == each, (items, member)
    assert reading.kind == "fleet"
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


REFUSED = {
    "GVRP_SET_SECTION": (text(sections="GVRP_SET_SECTION\n1 2 3 -1\n2 4 -1\n"), "GVRP_SET_SECTION"),
    "MUTUALLY_EXCLUSIVE_GROUP_SECTION": (
        text(sections="MUTUALLY_EXCLUSIVE_GROUP_SECTION\n1 2 3\n"),
        "MUTUALLY_EXCLUSIVE_GROUP_SECTION is not supported",
    ),
    "BACKHAUL_SECTION of PyVRP": (
        text(sections="BACKHAUL_SECTION\n1 0\n2 0\n3 4\n4 0\n"),
        "BACKHAUL_SECTION is not supported",
    ),
    "BACKHAUL_SECTION of LKH": (
        text(sections="BACKHAUL_SECTION\n3 4 -1\n"),
        "BACKHAUL_SECTION is not supported",
    ),
    "VRPSPD": (text().replace(": CVRP", ": VRPSPD"), "got VRPSPD: pick-ups"),
    "VRPB": (text().replace(": CVRP", ": VRPB"), "got VRPB: backhauls"),
    "RCTVRP": (text("RISK_THRESHOLD : 9\n").replace(": CVRP", ": RCTVRP"), "got RCTVRP: a bound"),
    "CTSP": (
        "TYPE : CTSP\nDIMENSION : 4\n" + PLACES + "CTSP_SET_SECTION\n1 2 -1\n",
        "TYPE must be TSP, ATSP or CVRP, got CTSP: cities of several colours",
    ),
    "unit costs below 0": (
        text("VEHICLES : 2\n", "VEHICLES_UNIT_DISTANCE_COST_SECTION\n1 1\n2 -3\n"),
        "VEHICLES_UNIT_DISTANCE_COST must be over 0, got -3",
    ),
    "distances beside times": (
        text("VEHICLES_MAX_DISTANCE : 90\n", WINDOWS),
        "VEHICLES_MAX_DISTANCE is not supported beside times",
    ),
    "a keyword in the head that is a number": (
        text("ENERGY_CAPACITY : 94\n"),
        "ENERGY_CAPACITY is not supported: remove it to plan without it, got '94'",
    ),
    "a keyword that is yes or no": (
        text("SPLIT : YES\n"),
        "it to plan without it, got 'YES'",
    ),
    "SCALE": (text("SCALE : -100\n"), "SCALE must be a number from 1"),
    "SCALE of ATT": (text("SCALE : 10\n").replace("EUC_2D", "ATT"), "and 1 for ATT, got '10'"),
    "a keyword in the head and its section": (
        text("SERVICE_TIME : 4\n", "SERVICE_TIME_SECTION\n1 0\n2 4\n3 0\n4 5\n"),
        "SERVICE_TIME must not stand beside SERVICE_TIME_SECTION",
    ),
    "a keyword twice": (text("CAPACITY : 12\n"), "CAPACITY must stand once, got it twice"),
    "a row that is missing": (
        text(sections="PRIZE_SECTION\n2 8\n3 0\n4 4\n"),
        "PRIZE_SECTION must have 4 rows of 2 numbers",
    ),
    "a node twice": (
        text(sections="PRIZE_SECTION\n1 0\n2 8\n2 0\n4 4\n"),
        "PRIZE_SECTION must have one row for each node 1 to 4",
    ),
    "a vehicle that is missing": (
        text("VEHICLES : 3\n", "VEHICLES_MAX_DURATION_SECTION\n1 50\n2 60\n"),
        "VEHICLES_MAX_DURATION_SECTION must have one row for each vehicle 1 to 3, got 2",
    ),
    "vehicles that are far too many": (
        text("VEHICLES : 999999999\n", "CAPACITY_SECTION\n1 50\n2 60\n"),
        "one row for each vehicle 1 to 999999999, got 2",
    ),
    "no vehicles": (
        text(sections="CAPACITY_SECTION\n").replace("CAPACITY : 10\n", ""),
        "CAPACITY_SECTION must have one row for each vehicle",
    ),
    "a client of no vehicle": (
        text("VEHICLES : 2\n", "VEHICLES_ALLOWED_CLIENTS_SECTION\n1 2\n2 3\n"),
        "must allow each client to a vehicle, and allows to none, got '4'",
    ),
    "two depots": (text(end="DEPOT_SECTION\n1\n2\n-1\n"), "DEPOT_SECTION must have one depot"),
    "a depot that is no node": (
        text(end="DEPOT_SECTION\n40.5\n"),
        "DEPOT_SECTION must have numbers of nodes, 1 to 4, got '40.5'",
    ),
    "reloads without a depot": (text("MAX_RELOADS : 3\n"), "needs VEHICLES_RELOAD_DEPOT_SECTION"),
    "a pair that is none": (
        text(sections=PAIRS.replace("6 2 0", "6 4 0"), demands=""),
        "PICKUP_AND_DELIVERY_SECTION must name the pick-up of each delivery",
    ),
    "windows beside other ones of pairs": (
        text(sections=PAIRS + WINDOWS, demands=""),
        "TIME_WINDOW_SECTION must be as PICKUP_AND_DELIVERY_SECTION, or left out",
    ),
    "demands that are missing": (text(demands=""), "DEMAND_SECTION must have 4 rows"),
    "demands beside pairs": (
        text(sections=PAIRS),
        "DEMAND_SECTION must not stand beside PICKUP_AND_DELIVERY_SECTION",
    ),
    "a negative demand": (
        text(demands=DEMANDS.replace("3 2", "3 -2")),
        "DEMAND_SECTION, stop 3 must be a whole number from 0, got -2",
    ),
    "no capacity": (text().replace("CAPACITY : 10\n", ""), "CAPACITY must be a number"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_said_is_refused_by_its_keyword(name: str) -> None:
    content, sentence = REFUSED[name]
    with pytest.raises(UnreadableFile) as refused:
        read(content)
    assert sentence in str(refused.value)


NOTED = [
    ("FIXED_EDGES_SECTION\n1 2\n-1\n", "FIXED_EDGES_SECTION was not used"),
    ("TOUR_SECTION\n1 2 3 4 -1\n", "TOUR_SECTION was not used"),
    ("WRITTEN_BY : a program\n", "WRITTEN_BY was not used: it is not a known keyword"),
    ("DISTANCE : 90\nSERVICE_TIME : 4\n", "DISTANCE limits the time of a route"),
    ("", "Distances are whole numbers, as TSPLIB defines EUC_2D."),
]


@pytest.mark.parametrize(("lines", "sentence"), NOTED)
def test_what_has_no_effect_is_noted(lines: str, sentence: str) -> None:
    reading = read(text(lines))
    assert sentence in " ".join(note.text for note in reading.notes)


@pytest.mark.parametrize(
    ("kind", "sentence"), [("CCVRP", "the sum of all arrivals"), ("SDVRP", "no demand is split")]
)
def test_a_type_that_is_planned_otherwise_is_noted(kind: str, sentence: str) -> None:
    reading = read(text().replace(": CVRP", f": {kind}"))
    assert sentence in " ".join(note.text for note in reading.notes)


def test_a_fleet_is_not_one_objective_of_two() -> None:
    files = [NamedFile(name, text().encode()) for name in ("a.vrp", "b.vrp")]
    with pytest.raises(UnreadableFile, match="CAPACITY is of a fleet: bring this file alone"):
        read_files(files, Bounds())


def test_a_tour_of_one_vehicle_is_one_objective_of_two() -> None:
    content = "VEHICLES : 1\nDIMENSION : 4\nEDGE_WEIGHT_TYPE : EUC_2D\n" + PLACES
    files = [NamedFile(name, content.encode()) for name in ("a.tsp", "b.tsp")]
    assert len(read_files(files, Bounds()).request["matrices"]) == 2
    with pytest.raises(UnreadableFile, match="one objective: name another"):
        read_files(files[:1], Bounds())


def test_cities_of_another_order_have_the_costs_of_their_numbers() -> None:
    sorted_cities = (
        "DIMENSION: 3\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 5 0\n3 9 0\n"
    )
    mixed = sorted_cities.replace("1 0 0\n2 5 0\n", "2 5 0\n1 0 0\n")
    files = [NamedFile("a.tsp", sorted_cities.encode()), NamedFile("b.tsp", mixed.encode())]
    first, second = read_files(files, Bounds()).request["matrices"]
    assert first == second == [[0, 5, 9], [5, 0, 4], [9, 4, 0]]


@pytest.mark.parametrize(
    ("scale", "kind", "distance"),
    [(10, "EUC_2D", 1.4), (10, "FLOOR_2D", 1.4), (100, "CEIL_2D", 1.42)],
)
def test_distances_are_rounded_after_they_are_scaled(
    scale: int, kind: str, distance: float
) -> None:
    content = text(f"SCALE : {scale}\n").replace("EUC_2D", kind).replace("2 3 4", "2 1 1")
    reading = read(content)
    assert reading.request["objectives"][0]["matrix"][0][1] == pytest.approx(distance)
    assert f"rounded to 1/{scale}" in " ".join(note.text for note in reading.notes)


def test_routes_under_a_limit_count_the_service() -> None:
    request = read(text("DISTANCE : 200\nSERVICE_TIME : 10\n")).request
    assert request["clock"] == "longest route"
    assert [vehicle["longest"] for vehicle in request["vehicles"]] == [200]
