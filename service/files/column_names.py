"""Recognise the columns of tables by their names, which are in `fields.toml`."""

import re
import tomllib
import unicodedata
from collections.abc import Mapping, Sequence
from pathlib import Path

from service.objectives import NTH

_FIELDS = tomllib.loads(Path(__file__).with_name("fields.toml").read_text(encoding="utf-8"))
NUMBERS = frozenset(_FIELDS["numbers"].split())
DURATIONS = tuple(_FIELDS["durations"].split())
GROUPS = tuple(_FIELDS["groups"].split())
NAMES = frozenset(_FIELDS["names"].split())
CUSTOMERS = frozenset(_FIELDS["customers"].split())
_SEVERAL = _FIELDS["several"].split()
_NAMES: Mapping[str, str] = _FIELDS["stops"]
_AMOUNTS = _NAMES["demand"].split()
_AMOUNT = f"({'|'.join(sorted(_AMOUNTS, key=len, reverse=True))})"
# Amounts with words around them, as `Order Weight`, `Load #1` or `Max load 1`; not of money.
_OF_ORDERS = re.compile(
    "(?!total|order)(?:net|gross|delivery|shipment|lineitem|parcel|cargo)?"
    rf"{_AMOUNT}(?:load)?(\d?)|(?:order|total)(?!amount){_AMOUNT}(\d?)"
)
_OF_PICKUPS = re.compile(rf"(?:pickup|return|takesback|givesback|backhaul){_AMOUNT}s?(\d?)")
_OF_CAPACITY = re.compile(rf"(?:max|maximum|capacity|initial|vehicle)?{_AMOUNT}(?:capacity)?(\d?)")
# Windows and visits that are said in full, as `Delivery time slot start`, `Appointment end` and
# `Transaction duration`.
_VISIT = "(?:delivery|appointment|visit|arrival|customer|receiving|unloading|dropoff|recipient)"
_SPAN = rf"(?:{_VISIT}?(?:time)?(?:window|slot|interval|range|frame)|{_VISIT})(?:time)?"
_IN_FULL = {
    "window_from": re.compile(rf"{_SPAN}(?:from|start|starts|starttime|begin|begins|opens?)"),
    "window_to": re.compile(rf"{_SPAN}(?:to|till|until|end|ends|endtime|stop|closes?)|till"),
    "window": re.compile(rf"{_VISIT}(?:time)?(?:window|slot|interval|range|frame)s?"),
    "service": re.compile(
        rf"(?:average|avg|estimated|est|expected|planned)?(?:{_VISIT}|transaction|handling|loading"
        "|offloading|onsite|parking|service|stop|task|job|order)(?:duration|minutes|mins)"
    ),
}
_LAST = 1000  # the rank of names that are not listed
# The coordinates of each plane, as fields that columns may be chosen for.
PLANES = ("x", "y", *(f"{nth} {axis}" for nth in NTH[1:] for axis in "xy"))
_OF_WINDOWS = ("window_from", "window_to", "window")
WINDOWS = ("window", "window_2", "window_3")  # the windows that a table may have
# The names of fields that only vehicles have, and those of all their fields.
_OF_VEHICLES_ONLY: Mapping[str, str] = {
    **_FIELDS["vehicles"],
    "capacity": " ".join(
        [
            _FIELDS["vehicles"]["capacity"],
            *(f"max{each} capacity{each} {each}capacity" for each in _AMOUNTS),
        ]
    ),
    "initial_load": " ".join(
        [
            _FIELDS["vehicles"]["initial_load"],
            *(f"initial{each}" for each in _AMOUNTS if each != "load"),
        ]
    ),
}
NAMES_OF_VEHICLES: Mapping[str, str] = {
    **_FIELDS["ends"],
    **_OF_VEHICLES_ONLY,
    **_FIELDS["also"],
    "id": f"{_OF_VEHICLES_ONLY['id']} {_FIELDS['also']['id']}",
    "capacity": f"{_OF_VEHICLES_ONLY['capacity']} {_NAMES['demand']}",
    "shift_from": f"{_OF_VEHICLES_ONLY['shift_from']} {_NAMES['window_from']}",
    "shift_to": f"{_OF_VEHICLES_ONLY['shift_to']} {_NAMES['window_to']}",
    "shift": f"{_OF_VEHICLES_ONLY['shift']} {_NAMES['window']}",
}
_PLACES = ("longitude", "latitude", "x", "y")
_BEFORE = re.compile(r"^(stop|geo|gps|location|customer|address|position|pos|point)(?=l)")
# Of the place of an order, unless the table has two places of each.
_TO = re.compile(r"^(destination|delivery|dropoff|recipient|client|order|job|task)(?=l(at|on|ng))")
_FROM = re.compile(r"(pickup|origin|start|source|from|collection)l(at|on|ng)")
_AFTER = re.compile(r"(deg|degree|degrees|wgs84|dd|decimal)$")
_UNIT = re.compile(r"[\[(]([^\[\]()]*)[\])]")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")  # between the words of serviceTimeSeconds
# Whose hours are times of day.
_HOURS_OF = (["working"], ["work"], ["business"], ["delivery"], ["receiving"])
_MINUTES = ("min", "mins", "minute", "minutes", "minuten", "minuti", "minutos", "minuuttia")
SECONDS: Mapping[str, float] = {  # by the names of units
    **dict.fromkeys(("ms", "msec", "msecs", "millis", "millisecond", "milliseconds"), 0.001),
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1),
    **dict.fromkeys(("sek", "sekunden", "secondes", "secondi", "segundos", "seconden"), 1),
    **dict.fromkeys(_MINUTES, 60),
    **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), 3600),
    **dict.fromkeys(("std", "stunden", "heures", "ore", "horas", "uren", "tuntia"), 3600),
}
_DAYS = ("d", "day", "days")  # in brackets; else they are not units, as in `working days`
# Headings of visits that route planners write. What they hold is in minutes.
_USUALLY_MINUTES = frozenset(_NAMES["service"].split()) - {"service"}
_NAMED_WINDOW = re.compile(r"^(timewindow|deliverywindow|window|tw)(?!s?$)")


def _numbered(words: str, number: int) -> str:
    """Return names of columns with a number at the end, or after `window`."""
    known = words.split()
    within = {_NAMED_WINDOW.sub(rf"\g<1>{number}", word) for word in known}
    return " ".join([*(f"{word}{number}" for word in known), *sorted(within - {*known})])


def _names_of_stops() -> dict[str, str]:
    """Return the names of all fields of stops, with those of second and third windows."""
    several = {
        field.replace("window", window, 1): _numbered(_NAMES[field], number)
        for number, window in enumerate(WINDOWS, 1)
        for field in _OF_WINDOWS
    }
    first = {field: f"{_NAMES[field]} {several.pop(field)}" for field in _OF_WINDOWS}
    return {**_NAMES, **first, **several}


NAMES_OF_STOPS = _names_of_stops()
FLEET = (
    *(field for field in NAMES_OF_STOPS if field.startswith("window")),
    *_FIELDS["of_fleets"].split(),
)


def is_about_vehicles(heading: Sequence[str]) -> bool:
    """Return whether a heading has columns of vehicles alone, and none of stops alone."""
    stops, found = fields_of(heading), set(best_fields(heading, _OF_VEHICLES_ONLY))
    located = {"latitude", "x", "place"} & set(stops)
    either = {"id", "plate", None} if located else {None}  # stops may have them as well
    return bool(found - either) and "demand" not in stops


def amount_of(name: str) -> str:
    """Return the amount that a column of loads or capacities is about, as `weight`, or ""."""
    plain = plain_name(name)
    patterns = (_OF_PICKUPS, _OF_ORDERS, _OF_CAPACITY)
    found = next(filter(None, (each.fullmatch(plain) for each in patterns)), None)
    return "".join(filter(None, found.groups())) if found else ""


def fields_of(heading: Sequence[str], chosen: Sequence[str | None] = ()) -> list[str | None]:
    """Return the field of stops that each column may be, or None; only some come several times.

    A column `due` beside the begin of a window is its end, if no other column is. `Opening hours`
    without closing ones are windows.

    Args:
        chosen: The field that was chosen for each column, or None.
    """
    taken = best_fields(heading, NAMES_OF_STOPS, chosen)
    if "window_from" in taken and "window_to" not in taken and "due" not in chosen:
        pairs = zip(heading, taken, strict=True)
        if "due" in map(plain_name, heading):
            return ["window_to" if plain_name(name) == "due" else each for name, each in pairs]
        if not any(chosen):
            return ["window" if _are_hours(name, each) else each for name, each in pairs]
    return taken


def _are_hours(name: str, field: str | None) -> bool:
    return field == "window_from" and name.casefold().strip().endswith("hours")


def field_of_each(names: Sequence[str]) -> list[str | None]:
    """Return the field of stops that each name may be by itself, or None."""
    known = _by_name(NAMES_OF_STOPS)
    return [_rank(plain_name(name), known, NAMES_OF_STOPS)[0] for name in names]


def best_fields(
    heading: Sequence[str], names: Mapping[str, str], chosen: Sequence[str | None] = ()
) -> list[str | None]:
    """Return the field that was chosen for each column, or else that it may be, or None.

    Of two columns for a field that comes once, the one whose name comes first in `names` gets it,
    and the other one gets None.
    """
    known = _by_name(names)
    ranks = [_rank(name, known, names) for name in _plain_names(heading)]
    taken = [*chosen] or [None] * len(heading)
    given = {*taken}
    for at in sorted(range(len(heading)), key=lambda at: (ranks[at][1], at)):
        field = ranks[at][0]
        if taken[at] is None and field and (field in _SEVERAL or field not in given):
            taken[at] = field
            given.add(field)
    return taken


def seconds_of(name: str) -> float | None:
    """Return the seconds of the unit in a heading, as in `service [min]`; None without a unit."""
    for unit in _UNIT.findall(name):
        words = re.split(r"[\s_.]+", unit.strip(" .").casefold())
        known = {**SECONDS, **dict.fromkeys(_DAYS, 86400)}
        if found := next((known[word] for word in reversed(words) if word in known), None):
            return found
    words = re.split(r"[\s_.,]+", _CAMEL.sub(" ", _UNIT.sub("", name)).casefold().strip(" ._"))
    return SECONDS.get(words[-1], 60 if words[0] in _MINUTES else None)


def are_usually_minutes(name: str) -> bool:
    """Return whether a heading is one of route planners for how long visits take, in minutes."""
    plain = plain_name(name)
    return plain in _USUALLY_MINUTES or bool(_IN_FULL["service"].fullmatch(plain))


def unit_of_times(name: str, field: str | None) -> float | None:
    """Return the seconds of the unit of times of day; None for `working hours` or without one."""
    is_of_day = not _UNIT.search(name) and str(field).startswith(("window", "shift"))
    unit = seconds_of(name)
    return None if is_of_day and unit == SECONDS["h"] else unit


def _by_name(names: Mapping[str, str]) -> dict[str, tuple[int, str, int]]:
    """Return the first field of each known name: its number, itself, and the place of the name."""
    known: dict[str, tuple[int, str, int]] = {}
    for number, (field, words) in enumerate(names.items()):
        for place, name in enumerate(words.split()):
            known.setdefault(name, (number, field, place))
    return known


def _rank(
    plain: str, known: Mapping[str, tuple[int, str, int]], fields: Mapping[str, str]
) -> tuple[str | None, int]:
    """Return the field of a name, and the place of the name among those of the field."""
    found = known.get(plain)
    of_place = known.get(_AFTER.sub("", _BEFORE.sub("", plain)))
    if of_place and of_place[1] in _PLACES and (not found or of_place < found):
        found = of_place
    if found:
        return found[1:]
    patterns = {"capacity": _OF_CAPACITY, "pickup": _OF_PICKUPS, "demand": _OF_ORDERS, **_IN_FULL}
    for field, pattern in patterns.items():
        if field in fields and pattern.fullmatch(plain):
            return field, _LAST
    return None, 0


def _plain_names(heading: Sequence[str]) -> list[str]:
    """Return the plain names of a heading: `Destination_Latitude` alone is a latitude."""
    plain = [plain_name(name) for name in heading]
    if any(_FROM.match(name) for name in plain):
        return plain
    return [_TO.sub("", name) for name in plain]


def plain_name(name: str) -> str:
    """Return a heading without its unit, reduced to small letters and digits."""
    spaced = _CAMEL.sub(" ", _UNIT.sub("", name))
    decomposed = unicodedata.normalize("NFKD", spaced.casefold()[:200])
    words = re.sub(r"[^a-z0-9]+", " ", re.sub(r"[\u0300-\u036f]", "", decomposed)).split()
    of_a_day = words[-1:] == ["hours"] and words[:1] in _HOURS_OF
    kept = words[:-1] if len(words) > 1 and words[-1] in SECONDS and not of_a_day else words
    return "".join(kept[:-1] if len(kept) > 1 and kept != words and kept[-1] == "in" else kept)
