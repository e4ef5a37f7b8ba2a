"""Write fronts and tours as texts of a few kilobytes, which fit into what an agent reads."""

import json
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from paretour import FleetFront, Front, FrontOfAnyKind
from paretour.display import shown

from service.objectives import OBJECTIVES

MOST_BYTES = 8000  # of an answer, so that it is never over 8 kB
_SLACKS = (0.01, 0.05, 0.1)  # shares of the least length, which a trade-off may cost
_MOST_NOTES, _LONGEST_NOTE = 5, 200  # notes about a file, and characters of one
_NEAR = 0.5  # of the way from one end of a front to the knee

Named = Mapping[str, Any]


def front_text(front: FrontOfAnyKind, link: str | None, assumed: Sequence[str] = ()) -> str:
    """Return a front: its ranges, up to five of its tours, and the stops of the knee.

    Args:
        front: The front.
        link: The address at which people see it, if there is one.
        assumed: Sentences about the file that it was planned from.
    """
    document = {**_heading(front, link), "tours": _representatives(front)}
    if assumed:
        document["assumed"] = [note[:_LONGEST_NOTE] for note in assumed[:_MOST_NOTES]]
    if not len(front):
        return _fitted({**document, "hint": "the front is empty: give it more time_limit"})
    knee = _knee(front)
    hint = "choose_tour gives the stops of another one; explain_front says what is traded"
    return _with_stops({**document, "hint": hint, "stops_of": knee}, front, knee, 0)


def explanation(front: FrontOfAnyKind, link: str | None) -> str:
    """Return what a front trades: its ranges, its knee, and what a little more of each buys."""
    document = {**_heading(front, link), "tours": _representatives(front)}
    return _fitted({**document, "trades": _trades(front)})


def tour_text(front: FrontOfAnyKind, number: int, first_stop: int, link: str | None) -> str:
    """Return one tour or plan of a front, with its stops from `first_stop` on."""
    losses = front.losses[number].round(4).tolist()
    chosen = {
        "summary": f"{_noun(front)} {number} of {len(front)}: {_lengths_text(front, number)}",
        "front": front.id,
        "number": number,
        "lengths": _lengths(front, number),
        "losses": dict(zip(_names(front), losses, strict=True)),
    }
    return _with_stops(_linked(chosen, link), front, number, first_stop)


def _heading(front: FrontOfAnyKind, link: str | None) -> dict[str, Any]:
    """Return the summary, the id, the link and the range of each objective."""
    found: dict[str, Any] = {"summary": _summary(front), "front": front.id, "status": front.status}
    if len(front):
        least, greatest = front.lengths.min(axis=0), front.lengths.max(axis=0)
        found["ranges"] = {
            name: [_short(low), _short(high)]
            for name, low, high in zip(_names(front), least, greatest, strict=True)
        }
    return _linked(found, link)


def _summary(front: FrontOfAnyKind) -> str:
    count = f"{len(front)} {_noun(front)}{'' if len(front) == 1 else 's'}"
    if isinstance(front, Front):
        count += f" of {front.tours.shape[1]} stops"
    if not len(front):
        return f"{count}, {front.status}"
    ends = zip(front.labels, front.lengths.min(axis=0), front.lengths.max(axis=0), strict=True)
    ranges = ", ".join(f"{shown(label)} {low:.6g} to {high:.6g}" for label, low, high in ends)
    return f"{count}, and none is better than another in everything: {ranges}"


def _representatives(front: FrontOfAnyKind) -> list[Named]:
    """Return the least of each objective, the knee, and tours between, at most five."""
    if not len(front):
        return []
    chosen: dict[int, list[str]] = {}
    names = _names(front)
    for index, name in enumerate(names):
        chosen.setdefault(int(front.lengths[:, index].argmin()), []).append(f"least {name}")
    knee = _knee(front)
    chosen.setdefault(knee, []).append("knee")
    if len(names) == OBJECTIVES:
        for end in (0, len(front) - 1):
            chosen.setdefault(round(knee + _NEAR * (end - knee)), []).append("between")
    return [
        {"number": number, "is": ", ".join(chosen[number]), "lengths": _lengths(front, number)}
        for number in sorted(chosen)
    ]


def _trades(front: FrontOfAnyKind) -> list[str]:
    """Return sentences: what a few per cent of one objective buys of each other one."""
    names, lengths = _names(front), front.lengths
    slacks = _SLACKS if len(names) == OBJECTIVES else _SLACKS[1:2]
    return [
        sentence
        for paid in range(len(names))
        for slack in slacks
        for bought in range(len(names))
        if paid != bought and (sentence := _trade(lengths, names, paid, bought, slack))
    ]


def _trade(
    lengths: np.ndarray, names: Sequence[str], paid: int, bought: int, slack: float
) -> str | None:
    """Return what a share more than the least of one objective buys of another; None if nothing."""
    if not len(lengths):
        return None
    budget = lengths[:, paid].min() * (1 + slack)
    at_least = lengths[lengths[:, paid] == lengths[:, paid].min(), bought].min()
    within = np.where(lengths[:, paid] <= budget, lengths[:, bought], np.inf)
    number = int(within.argmin())
    if not within[number] < at_least:
        return None
    less = 1 - within[number] / at_least
    cost = f"up to {slack:.0%} more {names[paid]} than the least (at most {budget:.6g})"
    return f"{cost} buys {less:.1%} less {names[bought]}: {within[number]:.6g}, tour {number}"


def _with_stops(document: Named, front: FrontOfAnyKind, number: int, first: int) -> str:
    """Return a document with as many stops of a tour or plan as there is room for."""
    routes = _routes(front, number)
    pairs = [(route, stop) for route, (_, stops) in enumerate(routes) for stop in stops]
    rest = pairs[first:]

    def text_of(count: int) -> str:
        kept = rest[:count]
        return _text({**document, **_stops(front, routes, kept), **_left(pairs, first, kept)})

    def bytes_of(count: int) -> int:
        return len(text_of(count).encode())

    if len(rest) <= MOST_BYTES and bytes_of(len(rest)) <= MOST_BYTES:
        return text_of(len(rest))
    # A stop takes bytes of its own, so no more of them fit than there are bytes.
    count = bisect_right(range(min(len(rest), MOST_BYTES)), MOST_BYTES, key=bytes_of) - 1
    return text_of(count) if count > 0 else _fitted(document)


def _routes(front: FrontOfAnyKind, number: int) -> list[tuple[str, Sequence[Any]]]:
    """Return the routes of a plan, each with its vehicle; a tour is one route without any."""
    item = front[number]
    if isinstance(front, Front):
        return [("", front.stops[number] if front.stops else front.tours[number].tolist())]
    if isinstance(front, FleetFront):
        return [(route.vehicle, route.stops) for route in front.plans[number].routes]
    return [(route.robot, route.tour.tolist()) for route in item.routes]  # type: ignore[union-attr]


def _stops(
    front: FrontOfAnyKind,
    routes: Sequence[tuple[str, Sequence[Any]]],
    kept: Sequence[tuple[int, Any]],
) -> Named:
    """Return the stops that are kept: a list, or one for each route of a plan."""
    if isinstance(front, Front):
        return {"stops": [stop for _, stop in kept]}
    found: dict[int, list[Any]] = {}
    for route, stop in kept:
        found.setdefault(route, []).append(stop)
    vehicles = {route: routes[route][0] for route in found}
    return {
        "routes": [
            {"route": route, "vehicle": vehicles[route], "stops": stops}
            for route, stops in found.items()
        ]
    }


def _left(pairs: Sequence[Any], first: int, kept: Sequence[Any]) -> Named:
    """Return a sentence about the stops that are not in the text, if there are any."""
    last = min(first, len(pairs)) + len(kept)
    if len(kept) == len(pairs):
        return {}
    sentence = f"{len(pairs) - len(kept)} of {len(pairs)} stops are not in this text"
    more = f": choose_tour with first_stop {last} has the next" if last < len(pairs) else ""
    return {"left_out": f"{sentence}{more}"}


def _knee(front: FrontOfAnyKind) -> int:
    return int(front.losses.sum(axis=1).argmin())


def _noun(front: FrontOfAnyKind) -> str:
    return "tour" if isinstance(front, Front) else "plan"


def _names(front: FrontOfAnyKind) -> list[str]:
    """Return the names of the objectives, or their indexes, by which a tour can be chosen."""
    if front.objectives:
        return [objective.name for objective in front.objectives]
    return [str(index) for index in range(front.lengths.shape[1])]


def _lengths(front: FrontOfAnyKind, number: int) -> dict[str, float]:
    return dict(zip(_names(front), map(_short, front.lengths[number]), strict=True))


def _lengths_text(front: FrontOfAnyKind, number: int) -> str:
    pairs = zip(front.labels, front.lengths[number], strict=True)
    return ", ".join(f"{shown(label)} {length:.6g}" for label, length in pairs)


def _short(number: float) -> float:
    """Return a number with the digits that a reader needs."""
    return float(f"{number:.7g}")


def _linked(document: dict[str, Any], link: str | None) -> dict[str, Any]:
    return document if link is None else {**document, "link": link}


def _fitted(document: Named) -> str:
    """Return a document without its last lines, where names are so long that they have no room."""
    members = dict(document)
    for name in ("trades", "tours", "ranges"):
        while len(_text(members).encode()) > MOST_BYTES and members.get(name):
            members[name] = members[name][:-1] if isinstance(members[name], list) else {}
    return _text(members)


def _text(document: Named) -> str:
    return json.dumps(document, ensure_ascii=False)
