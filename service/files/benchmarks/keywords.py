"""Check that every keyword of a file of TSPLIB, CVRPLIB, VRPLIB or LKH is read, or is refused.

They are in `keywords.toml`. A keyword that says something about tours or routes is never left out
without a sentence.
"""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from service.errors.printable import shortened
from service.files.tables import number_in
from service.files.tsplib import TsplibFile

_KEYWORDS = tomllib.loads(Path(__file__).with_name("keywords.toml").read_text(encoding="utf-8"))
OF_VEHICLES = tuple(_KEYWORDS["vehicles"].split())
_COUNTS = tuple(_KEYWORDS["counts"].split())
_OF_COSTS = {*_KEYWORDS["costs"].split(), *_KEYWORDS["about"].split()}
_OF_FLEETS = {
    *_COUNTS,
    *_KEYWORDS["fleets"].split(),
    *(f"VEHICLES_{each}{end}" for each in OF_VEHICLES for end in ("", "_SECTION")),
}
# A file with one of these alone may be a tour: DEPOT_SECTION names its start.
_TELLING = _OF_FLEETS - {"DEPOT_SECTION", "BACKHAUL_SECTION"}
_NO_EFFECT: Mapping[str, float] = _KEYWORDS["no_effect"]
_NOTED: Mapping[str, str] = _KEYWORDS["noted"]
_NOT_PLANNED: Mapping[str, str] = _KEYWORDS["not_planned"]
_PLANNED_OTHERWISE: Mapping[str, str] = _KEYWORDS["planned_otherwise"]
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
