"""Read columns that say which stops ride together, which apart, and which come before others."""

from collections.abc import Sequence
from typing import TypedDict

from paretour.member_parts import ApartRequest, BeforeRequest

from service.files.column_names import GROUPS
from service.files.columns import Columns
from service.files.fleets import Stop
from service.files.reading import quoted
from service.files.visits import texts_in

_MOST = 100  # stops of a group
_SAID = {
    "together": "Stops with the same {name} ride together, on one route.",
    "apart": "Stops with the same {name} do not ride together.",
}
Named = list[tuple[str, list[str]]]  # the id of each stop with a text, and the ids or labels in it


class Groups(TypedDict, total=False):
    """The members of a request for a fleet that say how stops ride with each other."""

    together: list[list[str]]
    apart: list[ApartRequest]
    before: list[BeforeRequest]


def without_groups(columns: Columns) -> None:
    """Take no column for groups: they alone do not make a fleet of stops."""
    for at, field in enumerate(columns.fields):
        if field in GROUPS and not columns.is_chosen(at):
            columns.fields[at] = None


def groups_of(columns: Columns, stops: Sequence[Stop]) -> Groups:
    """Return the members of a request for a fleet that columns of groups are for.

    A field has ids of other stops, or of `together` and `apart` a text that several stops share.
    A column of stops before or after others, or that wait for others, is not used without ids.

    Raises:
        UnreadableFile: A stop is named that does not exist.
    """
    ids = [stop["id"] for stop in stops]
    found: Groups = {}
    for field in GROUPS:
        if (at := columns.find(field)) is None:
            continue
        named = [(ids[row], texts_in(columns, row, at)) for row in columns.filled(at)]
        if any(text in ids for _, texts in named for text in texts):
            _check_ids(columns, at, ids)
            _add_by_ids(found, field, named)
        elif field in _SAID:
            _add_by_labels(found, columns, at, field, named)
        else:
            columns.leave_out(field, ", as it names no stops")
    return found


def have_waits(groups: Groups) -> bool:
    """Return whether some stops wait for others, whoever drives, which needs a clock."""
    return any("vehicles" in each for each in groups.get("before", ()))


def _check_ids(columns: Columns, at: int, ids: Sequence[str]) -> None:
    """Keep the fields of a column that name stops which do not exist as wrong."""
    for row in columns.filled(at):
        others = [text for text in texts_in(columns, row, at) if text not in ids]
        if others:
            columns.refuse(row, at, "no-such-stops", came=others[0])


def _add_by_ids(found: Groups, field: str, named: Named) -> None:
    """Add the group of each stop that names others."""
    for stop, texts in named:
        others = [text for text in dict.fromkeys(texts) if text != stop]
        if not others:
            continue
        if field == "together":
            found.setdefault("together", []).append([stop, *others])
        elif field == "apart":
            found.setdefault("apart", []).append({"stops": [stop], "others": others})
        else:
            first, then = ([stop], others) if field == "before" else (others, [stop])
            item: BeforeRequest = {"first": first, "then": then}
            if field == "waits_for":
                item["vehicles"] = "any"
            found.setdefault("before", []).append(item)


def _add_by_labels(found: Groups, columns: Columns, at: int, field: str, named: Named) -> None:
    """Add the stops that share each text, of two stops or more, and note what that means."""
    shared: dict[str, list[str]] = {}
    for stop, texts in named:
        for text in dict.fromkeys(texts):
            shared.setdefault(text, []).append(stop)
    groups = {text: stops for text, stops in shared.items() if len(stops) > 1}
    name = quoted(columns.names[at])
    if large := [text for text, stops in groups.items() if len(stops) > _MOST]:
        columns.leave_out(field, f", as more than {_MOST} stops have {quoted(large[0])}")
        return
    if groups:
        columns.source.note("groups", _SAID[field].format(name=name))
    for group in groups.values():
        if field == "together":
            found.setdefault("together", []).append(group)
        else:
            found.setdefault("apart", []).append({"stops": group})
