"""Check that every keyword of a file of TSPLIB, CVRPLIB, VRPLIB or LKH is read, or is refused.

The keywords are those of TSPLIB (Reinelt, 1991), of LKH-3 (Helsgaun, 2017) and of the format of
PyVRP. A keyword that says something about tours or routes is never left out without a sentence.
"""

import re
from typing import Any

from service.errors.printable import shortened
from service.files.tables import number_in
from service.files.tsplib import TsplibFile

OF_VEHICLES = (
    "MAX_DISTANCE",
    "MAX_DURATION",
    "MAX_RELOADS",
    "FIXED_COST",
    "UNIT_DISTANCE_COST",
    "DEPOT",
    "RELOAD_DEPOT",
    "ALLOWED_CLIENTS",
)
_COUNTS = ("VEHICLES", "VEHICLE", "SALESMEN")
_OF_COSTS = {
    "NAME",
    "TYPE",
    "DIMENSION",
    "EDGE_WEIGHT_TYPE",
    "EDGE_WEIGHT_FORMAT",
    "SCALE",
    "NODE_COORD_SECTION",
    "EDGE_WEIGHT_SECTION",
}
# What says nothing about tours: their pictures, and where a file comes from.
_ABOUT = {
    "COMMENT",
    "NODE_COORD_TYPE",
    "DISPLAY_DATA_TYPE",
    "DISPLAY_DATA_SECTION",
    "AUTHOR",
    "BEST_KNOWN",
    "BKS",
    "OPTIMAL_VALUE",
    "OPTIMAL_COST",
    "OPTIMUM",
    "GRID_SIZE",  # of TOR_2D alone
}
_OF_FLEETS = {
    *_COUNTS,
    "CAPACITY",
    "CAPACITY_SECTION",
    "DISTANCE",
    "SERVICE_TIME",
    "SERVICE_TIME_SECTION",
    "RELEASE_TIME",
    "RELEASE_TIME_SECTION",
    "TIME_WINDOW_SECTION",
    "DEMAND_SECTION",
    "LINEHAUL_SECTION",
    "BACKHAUL_SECTION",
    "PICKUP_AND_DELIVERY_SECTION",
    "PRIZE_SECTION",
    "DEPOT_SECTION",
    *(f"VEHICLES_{each}" for each in OF_VEHICLES),
    *(f"VEHICLES_{each}_SECTION" for each in OF_VEHICLES),
}
# A file with one of these alone may be a tour: DEPOT_SECTION names its start.
_TELLING = _OF_FLEETS - {"DEPOT_SECTION", "BACKHAUL_SECTION"}
_NO_EFFECT = {"DEMAND_DIMENSION": 1, "EXTERNAL_SALESMEN": 0}  # with these values
_NOTED = {
    "FIXED_EDGES_SECTION": "tours may do without its edges",
    "TOUR_SECTION": "the search needs no tour to start from",
}
_RETURNED = "pick-ups that are taken to the depot"
_NOT_PLANNED = {
    "SOP": "an order of cities",
    "HCP": "no costs",
    "TOUR": "a tour, and no costs",
    "HPP": "a path: write TSP, and plan an open route",
    "CTSP": "cities of several colours",
    "GTSP": "one city of each set",
    "AGTSP": "one city of each set",
    "GVRP": "one stop of each set",
    "1-PDTSP": "goods that are taken from any stop to any other",
    "M-PDTSP": "goods that are taken from any stop to any other",
    "M1-PDTSP": "goods that are taken from any stop to any other",
    "PDTSPF": "first in, first out",
    "PDTSPL": "last in, first out",
    "RCTVRP": "a bound on risk",
    "RCTVRPTW": "a bound on risk",
    "TSPDL": "draft limits",
    "TSPPD": _RETURNED,
    "VRPB": "backhauls, and deliveries before them",
    "VRPBTW": "backhauls, and deliveries before them",
    "VRPMPD": _RETURNED,
    "VRPMPDTW": _RETURNED,
    "VRPSPD": _RETURNED,
    "VRPSPDTW": _RETURNED,
    "STTSP": "nodes that need not be visited",
    "TSTSP": "nodes that need not be visited",
    "OCMTSP": "tours some of which are open",
    "OP": "a bound on the length, and scores",
}
_LATENCY = "it minimises the sum of all arrivals; here the objectives are lengths"
_PLANNED_OTHERWISE = {"CCVRP": _LATENCY, "MLP": _LATENCY, "TRP": _LATENCY}
_SWITCH = re.compile("yes|no|true|false", re.IGNORECASE)
_MOST_NAMED, _LONGEST_SHOWN = 5, 60
_SPLIT = "SDVRP"  # or a site-dependent problem, if vehicles have clients


def is_fleet(file: TsplibFile) -> bool:
    """Return whether a file is about vehicles, or a traveller who has times."""
    rename(file)
    named = [name for name in (*file.header, *file.sections) if name in _TELLING]
    if [number_in(file.word(name)) for name in named if name in _COUNTS] == [1]:
        named = [name for name in named if name not in _COUNTS]  # a tour is of one vehicle
    return bool(named) or "VRP" in file.word("TYPE").upper()


def rename(file: TsplibFile) -> None:
    """Give the keywords of vehicles one name: MAX_DURATION is VEHICLES_MAX_DURATION."""
    parts: tuple[tuple[dict[str, Any], str], ...] = ((file.header, ""), (file.sections, "_SECTION"))
    for found, end in parts:
        for short in (f"{each}{end}" for each in OF_VEHICLES if each != "DEPOT"):
            if short in found and f"VEHICLES_{short}" in found:
                raise file.source.refusal("stands-beside", short, keyword=f"VEHICLES_{short}")
            if short in found:
                found[f"VEHICLES_{short}"] = found.pop(short)


def check_costs(file: TsplibFile) -> None:
    """Check the keywords of a file that is one objective of several.

    Raises:
        UnreadableFile: A keyword says something that is not planned.
    """
    _check_type(file)
    if is_fleet(file):
        of_fleets = (name for name in (*file.header, *file.sections) if name in _TELLING)
        name = next(of_fleets, "TYPE")
        raise file.source.refusal("of-a-fleet", name)
    if file.sections.get("DEPOT_SECTION"):
        file.source.note("left-out", "DEPOT_SECTION was not used: tours are round trips.")
    _check(file, _OF_COSTS | {"DEPOT_SECTION", *_COUNTS})


def check_fleet(file: TsplibFile) -> None:
    """Check the keywords of a file about a fleet.

    Raises:
        UnreadableFile: A keyword says something that is not planned.
    """
    _check_type(file)
    _check(file, _OF_COSTS | _OF_FLEETS)


def count_of(file: TsplibFile) -> str | None:
    """Return the keyword that says how many vehicles there are, if there is one.

    Raises:
        UnreadableFile: There are several.
    """
    found = [name for name in _COUNTS if name in file.header]
    if len(found) > 1:
        raise file.source.refusal("stands-beside", found[0], keyword=found[1])
    return found[0] if found else None


def _check_type(file: TsplibFile) -> None:
    kind = file.word("TYPE").upper()
    if kind in _NOT_PLANNED:
        raise file.source.refusal("other-problem", "TYPE", given=kind, reason=_NOT_PLANNED[kind])
    if kind in _PLANNED_OTHERWISE:
        file.source.note("objectives", f"TYPE is {kind}: {_PLANNED_OTHERWISE[kind]}.")
    if kind == _SPLIT and "VEHICLES_ALLOWED_CLIENTS_SECTION" not in file.sections:
        file.source.note("demand", "TYPE is SDVRP: here no demand is split, one visit brings all.")


def _check(file: TsplibFile, known: set[str]) -> None:
    """Refuse and note keywords that are not known; a file of other words has many."""
    known = known | _ABOUT
    for name in file.sections:
        if name in _NOTED and file.listed(name):
            file.source.note("left-out", f"{name} was not used: {_NOTED[name]}.")
        elif name not in known and name not in _NOTED:
            raise file.source.refusal("unsupported", _shown(name))
    unknown = [
        name
        for name in file.header
        if name not in known and number_in(file.word(name)) != _NO_EFFECT.get(name, "other")
    ]
    for name in unknown:
        word = file.word(name)
        if number_in(word) is not None or _SWITCH.fullmatch(word):
            raise file.source.refusal("unsupported-value", _shown(name), came=word)
    if unknown:
        shown = shortened([*map(_shown, unknown)], _MOST_NAMED)
        file.source.note("left-out", f"{shown} was not used: it is not a known keyword.")


def _shown(name: str) -> str:
    return name[:_LONGEST_SHOWN]
