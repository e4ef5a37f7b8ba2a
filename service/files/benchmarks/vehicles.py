"""Read the depots and vehicles of VRPLIB: keywords and sections with a row for each vehicle."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service.files.benchmarks.keywords import count_of
from service.files.fleets import Vehicle
from service.files.tables import number_in
from service.files.tsplib import TsplibFile

Array = NDArray[np.float64]
_MOST_SKILLS = 50  # of a vehicle
_DISTANCE = "VEHICLES_MAX_DISTANCE"
_UNIT_COST = "VEHICLES_UNIT_DISTANCE_COST"
_LIMITS = ("DISTANCE", "VEHICLES_MAX_DURATION", _DISTANCE)


@dataclass(frozen=True)
class Depots:
    """The depots: their stops by position, and whether routes are open."""

    first_node: int
    stops: tuple[int, ...]
    open_routes: bool = False

    @classmethod
    def of(cls, file: TsplibFile, *, open_routes: bool) -> "Depots":
        """Return the depots of a file: those that it lists, or the first node."""
        first = file.first_node
        words = file.listed("DEPOT_SECTION") or [str(first)]
        stops = tuple(_index(file, "DEPOT_SECTION", number_in(word), word) for word in words)
        return cls(first, tuple(dict.fromkeys(stops)), open_routes)

    def name(self, at: int) -> str:
        """Return the id of a stop: the number of its node."""
        return str(at + self.first_node)


@dataclass(frozen=True)
class Vehicles:
    """The types of vehicles, and the depots that they use.

    `pinned` are the stops that one type alone may visit, with its id; `skills` are those that some
    may, with the skill of these.
    """

    types: list[Vehicle]
    unit_cost: float
    used: frozenset[int]
    limits_distances: bool
    pinned: dict[int, str] = field(default_factory=dict)
    skills: dict[int, str] = field(default_factory=dict)

    def check_distances(self, file: TsplibFile, *, timed: bool) -> None:
        """Raise UnreadableFile if distances are limited where a limit is on times."""
        if timed and self.limits_distances:
            raise file.source.refusal("distance-beside-times", _DISTANCE)


def vehicles_of(
    file: TsplibFile, depots: Depots, clients: Sequence[int], windows: Array | None
) -> Vehicles:
    """Return the vehicles of a file, equal ones as one type.

    Args:
        clients: The other stops.
        windows: The windows of all stops; those of depots are shifts.

    Raises:
        UnreadableFile: A section does not have a row for each vehicle, or cannot be said.
    """
    count = _count(file)
    rows = _Rows(file, count)
    unit = _unit_cost(rows)
    kinds, alike = _alike(rows, depots, windows, unit)
    if count is None:
        text = "The file does not say how many vehicles: as many as needed."
        file.source.note("vehicle", text)
        alike = [max(1, len(clients))]
    used = {each for at, *_ in kinds for each in rows.reloads[at]}
    for (at, vehicle, _), number in zip(kinds, alike, strict=True):
        vehicle["count"] = number
        if len(kinds) > 1:
            vehicle["id"] = f"vehicle {at + 1}"
        used |= {each for each in depots.stops if depots.name(each) == vehicle["start"]}
    types = [vehicle for _, vehicle, _ in kinds]
    fleet = Vehicles(types, unit, frozenset(used), rows.has(_DISTANCE))
    if rows.has("VEHICLES_ALLOWED_CLIENTS"):
        _allow(file, fleet, [each for *_, each in kinds], clients, depots)
    return fleet


def _alike(
    rows: "_Rows", depots: "Depots", windows: Array | None, unit: float
) -> tuple[list[tuple[int, Vehicle, frozenset[int]]], list[int]]:
    """Return the first of each kind of equal vehicles, and how many there are of each kind."""
    kinds: dict[str, tuple[int, Vehicle, frozenset[int]]] = {}
    counts: dict[str, int] = {}
    for at in range(rows.several):
        allowed = rows.clients[at]
        vehicle = _vehicle(rows, depots, windows, unit, at)
        key = repr((vehicle, sorted(allowed)))
        kinds.setdefault(key, (at, vehicle, allowed))
        counts[key] = counts.get(key, 0) + 1
    alike = list(counts.values()) if rows.differ else [rows.count or 1]
    return list(kinds.values()), alike


def _count(file: TsplibFile) -> int | None:
    """Return the number of vehicles: as a keyword says, or as sections have rows."""
    name = count_of(file)
    if name is None:
        lengths = [len(file.sections[section]) for section in _sections(file)]
        one = 1 if "TSP" in file.word("TYPE").upper() else None  # a tour is of one vehicle
        return lengths[0] if lengths else one
    value = number_in(file.word(name))
    if value is None or not value.is_integer() or value < 1:
        raise file.source.refusal("no-count", name, came=file.word(name))
    return int(value)


def _sections(file: TsplibFile) -> list[str]:
    """Return the sections with a row for each vehicle."""
    return [
        section
        for section in file.sections
        if section == "CAPACITY_SECTION" or section.startswith("VEHICLES_")
    ]


class _Rows:
    """What keywords and sections say of each vehicle.

    Attributes:
        differ: Whether vehicles may differ.
        several: How many vehicles there are that may differ; 1 if all are equal.

    Raises:
        UnreadableFile: There are more vehicles than rows of their sections.
    """

    def __init__(self, file: TsplibFile, count: int | None) -> None:
        self.file, self.count = file, count
        self._rows = {section: self._by_vehicle(section) for section in _sections(file)}
        self.differ = bool(self._rows)
        self.several = (count or 1) if self.differ else 1

    @cached_property
    def clients(self) -> list[frozenset[int]]:
        """The stops, by position, that each vehicle may visit."""
        return self._stops_in("VEHICLES_ALLOWED_CLIENTS_SECTION")

    @cached_property
    def reloads(self) -> list[frozenset[int]]:
        """The stops, by position, at which each vehicle may load again."""
        return self._stops_in("VEHICLES_RELOAD_DEPOT_SECTION")

    @cached_property
    def unit_costs(self) -> frozenset[float]:
        """What a unit of distance costs different vehicles."""
        if not self.has(_UNIT_COST):
            return frozenset((1.0,))
        return frozenset(self.number(_UNIT_COST, at) or 0.0 for at in range(self.several))

    def has(self, name: str) -> bool:
        """Return whether a keyword or its section stands in the file."""
        return name in self.file.header or f"{name}_SECTION" in self.file.sections

    def number(self, name: str, at: int) -> float | None:
        """Return the number of a vehicle; None if nothing is said."""
        found = self.numbers(name, at)
        if found and len(found) > 1:
            raise self.file.source.refusal("number-each-vehicle", name, came=len(found))
        return found[0] if found else None

    def numbers(self, name: str, at: int) -> list[float]:
        """Return the numbers of a vehicle in its row, or the one of the keyword."""
        section = f"{name}_SECTION"
        if name in self.file.header:
            if section in self.file.sections:
                raise self.file.source.refusal("stands-beside", name, keyword=section)
            value = number_in(self.file.word(name))
            if value is None:
                raise self.file.source.refusal("no-number", name, came=self.file.word(name))
            return [value]
        return self._rows[section][at] if section in self._rows else []

    def _stops_in(self, section: str) -> list[frozenset[int]]:
        """Return the positions of the stops in the row of each vehicle."""
        return [
            frozenset(_index(self.file, section, each) for each in row if each != -1)
            for row in self._rows.get(section, [[]] * self.several)
        ]

    def _by_vehicle(self, section: str) -> list[list[float]]:
        """Return the rows of a section by the numbers of their vehicles, which come first."""
        file = self.file
        rows = [file.parsed(section, words).tolist() for words in file.sections[section]]
        if rows and rows[-1] == [-1]:
            rows.pop()
        numbers = sorted(row[0] if row else 0.0 for row in rows)
        if not rows or len(rows) != self.count or numbers != list(range(1, len(rows) + 1)):
            last = self.count or "the last"
            raise file.source.refusal("row-each-vehicle", section, last=last, came=len(rows))
        return [row[1:] for row in sorted(rows)]


def _vehicle(rows: _Rows, depots: Depots, windows: Array | None, unit: float, at: int) -> Vehicle:
    """Return one vehicle."""
    file = rows.file
    start = _start(rows, depots, at)
    home = depots.name(start)
    made: Vehicle = {"id": "vehicle", "count": 1, "start": home}
    if not depots.open_routes:
        made["end"] = home
    if capacity := rows.numbers("CAPACITY", at):
        made["capacity"] = [_load(file, each) for each in capacity]
    elif "DEMAND_SECTION" in file.sections:
        raise file.source.refusal("no-capacity", "CAPACITY")
    if windows is not None:
        made["shift"] = windows[start].tolist()
    if (longest := _longest(rows, at)) is not None:
        made["longest"] = longest
    if fixed := rows.number("VEHICLES_FIXED_COST", at):
        made["fixed"] = _plain(fixed / unit)
    if len(rows.unit_costs) > 1:
        made["per_distance"] = _plain(rows.number(_UNIT_COST, at) or 0.0)
    _add_reloads(rows, depots, at, made)
    return made


def _longest(rows: _Rows, at: int) -> float | None:
    """Return the limit on the routes of a vehicle, the least if there are several."""
    limits = [limit for name in _LIMITS if (limit := rows.number(name, at)) is not None]
    if limits and min(limits) <= 0:
        raise rows.file.source.refusal("not-over-0", "limits on routes", came=min(limits))
    return _plain(min(limits)) if limits else None


def _add_reloads(rows: _Rows, depots: Depots, at: int, vehicle: Vehicle) -> None:
    """Add where a vehicle may load again, and how often."""
    file, section, most = rows.file, "VEHICLES_RELOAD_DEPOT_SECTION", "VEHICLES_MAX_RELOADS"
    found = sorted(rows.reloads[at])
    reloads = rows.number(most, at)
    if not found:
        if reloads and section not in file.sections:
            raise file.source.refusal("needs-section", most, section=section)
        return
    if wrong := [depots.name(each) for each in found if each not in depots.stops]:
        raise file.source.refusal("no-such-depots", section, came=wrong[0])
    vehicle["reload"] = [depots.name(each) for each in found]
    if reloads is not None:
        vehicle["max_trips"] = _load(file, reloads) + 1


def _start(rows: _Rows, depots: Depots, at: int) -> int:
    """Return the depot of a vehicle."""
    found = rows.number("VEHICLES_DEPOT", at)
    source = rows.file.source
    if found is not None:
        start = _index(rows.file, "VEHICLES_DEPOT_SECTION", found)
        if start not in depots.stops:
            raise source.refusal("no-such-depot", "VEHICLES_DEPOT_SECTION", came=f"{found:g}")
        return start
    first, *others = depots.stops
    if others and at == 0:
        reloads = {each for row in rows.reloads for each in row}
        if not {*others} <= reloads:
            came = " ".join(map(depots.name, depots.stops))
            raise source.refusal("several-depots", "DEPOT_SECTION", came=came)
        source.note("vehicle", f"All vehicles start at the first depot, {depots.name(first)}.")
    return first


def _unit_cost(rows: _Rows) -> float:
    """Return the cost of a unit of distance if it is the same for all vehicles, else 1."""
    units = rows.unit_costs
    if min(units) < 0 or max(units) <= 0:
        raise rows.file.source.refusal("not-over-0", _UNIT_COST, came=min(units))
    unit = min(units) if len(units) == 1 else 1.0
    if unit != 1:
        text = f"Fixed costs and prizes were divided by {unit:g}, the cost of a unit of distance."
        rows.file.source.note("fixed", text)
    return unit


def _allow(
    file: TsplibFile,
    fleet: Vehicles,
    clients_of: list[frozenset[int]],
    clients: Sequence[int],
    depots: Depots,
) -> None:
    """Tell stops which vehicles may visit them, by the clients of each type.

    A stop of one type names it, and a stop of some of them has a skill that these alone have.
    """
    section = "VEHICLES_ALLOWED_CLIENTS_SECTION"
    skills: dict[tuple[int, ...], str] = {}
    for stop in clients:
        able = tuple(at for at, allowed in enumerate(clients_of) if stop in allowed)
        if not able:
            raise file.source.refusal("client-of-none", section, came=depots.name(stop))
        if len(able) == len(fleet.types):
            continue
        if len(able) == 1:
            fleet.pinned[stop] = fleet.types[able[0]]["id"]
        else:
            fleet.skills[stop] = skills.setdefault(able, f"allowed {len(skills) + 1}")
    for at, vehicle in enumerate(fleet.types):
        if having := [skill for able, skill in skills.items() if at in able]:
            vehicle["skills"] = having
        if len(having) > _MOST_SKILLS:
            raise file.source.refusal("too-many-sets", section, most=_MOST_SKILLS)


def _index(file: TsplibFile, section: str, number: float | None, word: str = "") -> int:
    """Return the position of the stop that a number of a section names."""
    at = -1 if number is None or number % 1 else int(number) - file.first_node
    if not 0 <= at < file.dimension:
        nodes = {"first": file.first_node, "last": file.first_node + file.dimension - 1}
        raise file.source.refusal("no-such-node", section, **nodes, came=word or f"{number:g}")
    return at


def _load(file: TsplibFile, number: float) -> int:
    if not number.is_integer() or number < 0:
        raise file.source.refusal("not-loads", "capacities and trips", came=f"{number:g}")
    return int(number)


def _plain(number: float) -> float:
    return int(number) if float(number).is_integer() else number
