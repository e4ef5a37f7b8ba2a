"""Write fronts and tours as JSON texts of at most 8 kB, short enough for an agent to read."""

import json
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from paretour import FleetFront, Front, FrontOfAnyKind, Refused
from paretour.choice import knee
from paretour.display import shown
from paretour.kinds import kind_of
from paretour.questions import Option, Question
from paretour.remedies import in_words

from service.amounts.said import amount, on_most_days
from service.mcp.routes import Way, fairest, hours_of, left_out_of, measures_of, names_of, ways_of
from service.objectives import OBJECTIVES

MOST_BYTES = 8000  # of a text
_SLACKS = (0.01, 0.05, 0.1)  # what a trade-off may cost, as shares of the least length
_MOST_NOTES, _LONGEST_NOTE = 12, 300  # notes about a file, and characters of one
_LONGEST_PATCH = 200  # characters
_MOST_COLUMNS = 20  # of a file that cannot be read
_NEAR = 0.5  # share of the way from the knee to an end of a front, where another tour is shown

Named = Mapping[str, Any]


def front_text(front: FrontOfAnyKind, link: str | None, assumed: Sequence[str] = ()) -> str:
    """Return the text of a front: its ranges, up to five of its tours, and the stops of the knee.

    Args:
        link: The address of a page that shows the front, if there is one.
        assumed: Sentences that say how the file that it was planned from was read.
    """
    document = {**_heading(front, link), "tours": _representatives(front)}
    if assumed:
        document["assumed"] = [note[:_LONGEST_NOTE] for note in assumed[:_MOST_NOTES]]
    if notes := [note.text for note in front.notes if note.text not in assumed]:
        document["notes"] = [note[:_LONGEST_NOTE] for note in notes[:_MOST_NOTES]]
    if not len(front):
        return _fitted({**document, "hint": "the front is empty: give it more time_limit"})
    middle = knee(front.lengths)
    hint = "choose_tour gives the stops of another one; explain_front says what is traded"
    return _with_stops({**document, "hint": hint, "stops_of": middle}, front, middle, 0)


def refusal_text(error: Refused) -> str:
    """Return the text of a refusal, with each change that helps and its JSON patch, if short."""
    heading, *remedies = in_words(error.remedies) or [""]
    lines = [str(error), *([heading] if heading else [])]
    for said, remedy in zip(remedies, error.remedies, strict=True):
        lines.append(f"{said}: {_patch_text(remedy.patch)}")
    return "\n".join(lines)


def _patch_text(patch: Sequence[Named]) -> str:
    """Return a JSON patch, of a long one its first operation, or the first item of its list."""
    text, (first, *others) = json.dumps(patch), patch
    if len(text) <= _LONGEST_PATCH:
        return text
    if others or not isinstance(first.get("value"), list):
        return f"{json.dumps(first)} and {len(others)} more like it"
    item, *items = first["value"]
    return f"{json.dumps([{**first, 'value': [item]}])} with {len(items)} more items like it"


def unreadable_text(error: Refused) -> str:
    """Return the text of a file that cannot be read, with what its columns may be taken for."""
    columns = error.document.get("columns") or ()
    if not columns:
        return str(error)
    taken = {each["name"]: each["taken_for"] for each in columns[:_MOST_COLUMNS]}
    choices: list[str] = next(iter(error.document.get("choices", {}).values()), [])
    return as_text({"error": str(error), "columns": taken, "choices": choices})


def explanation(front: FrontOfAnyKind, link: str | None) -> str:
    """Return the text of a front's trade-offs: its ranges, some tours, and sentences.

    A sentence says how much less of one objective a little more of another buys. Of plans, the
    routes of the knee follow.
    """
    document = {
        **_heading(front, link),
        "tours": _representatives(front),
        "trades": _trades(front),
    }
    if not kind_of(front.document).mover or not len(front):
        return _fitted(document)
    middle = knee(front.lengths)
    return _with_stops({**document, "stops_of": middle}, front, middle, 0)


def tour_text(front: FrontOfAnyKind, number: int, first_stop: int, link: str | None) -> str:
    """Return the text of one tour or plan of a front.

    Args:
        first_stop: How many of its stops to leave out before the first that is shown.
        link: The address of a page that shows the front, if there is one.
    """
    losses = front.losses[number].round(4).tolist()
    chosen = {
        "summary": f"{_noun(front)} {number} of {len(front)}: {_lengths_text(front, number)}",
        "front": front.id,
        "number": number,
        **_known(front, number),
        "losses": dict(zip(names_of(front), losses, strict=True)),
    }
    return _with_stops(_linked(chosen, link), front, number, first_stop)


def question_text(front: FrontOfAnyKind, question: Question, picks: Sequence[int]) -> str:
    """Return the text of a question that is not the end: what each option keeps within reach."""
    options = [
        {"option": number, **_reach(front, option)}
        for number, option in enumerate(question.options)
    ]
    return as_text(
        {
            "summary": f"{question.left} questions are left. Ask the person which option is best",
            "front": front.id,
            "picks": list(picks),
            "where_you_stand": _reach(front, question.current),
            "options": options,
            "hint": "every option is at least as good as where you stand, in everything; call again"
            " with the number of the option that was chosen added to picks",
        }
    )


def _reach(front: FrontOfAnyKind, option: Option) -> Named:
    return {
        "at_most": _amounts(front, option.point),
        "at_best": _amounts(front, option.best),
        f"{_noun(front)}s_within_reach": option.within_reach,
    }


def _heading(front: FrontOfAnyKind, link: str | None) -> dict[str, Any]:
    """Return the first members of a front's text: summary, id, status, ranges and link."""
    found: dict[str, Any] = {"summary": _summary(front), "front": front.id, "status": front.status}
    if len(front):
        least, greatest = front.lengths.min(axis=0), front.lengths.max(axis=0)
        found["ranges"] = {
            name: [_short(low), _short(high)]
            for name, low, high in zip(names_of(front), least, greatest, strict=True)
        }
    return _linked(found, link)


def _summary(front: FrontOfAnyKind) -> str:
    count = f"{len(front)} {_noun(front)}{'' if len(front) == 1 else 's'}"
    if not kind_of(front.document).mover:
        count += f" of {front.document['cities']} stops"
    if not len(front):
        return f"{count}, {front.status}"
    ends = zip(front.lengths.min(axis=0), front.lengths.max(axis=0), strict=True)
    triples = zip(names_of(front), _units(front), ends, strict=True)
    ranges = ", ".join(
        f"{shown(name)} {amount(low, unit)} to {amount(high, unit)}"
        for name, unit, (low, high) in triples
    )
    return f"{count}, and none is better than another in everything: {ranges}"


def _representatives(front: FrontOfAnyKind) -> list[Named]:
    """Return a few tours: the least in each objective, the knee, of plans the fairest, and others.

    Of two objectives there are two more, each between the knee and an end of the front.
    """
    if not len(front):
        return []
    chosen: dict[int, list[str]] = {}
    names = names_of(front)
    for index, name in enumerate(names):
        chosen.setdefault(int(front.lengths[:, index].argmin()), []).append(f"least {name}")
    middle = knee(front.lengths)
    chosen.setdefault(middle, []).append("knee")
    if (equal := fairest(front)) is not None:
        chosen.setdefault(equal, []).append("fairest")
    if len(names) == OBJECTIVES:
        for end in (0, len(front) - 1):
            chosen.setdefault(round(middle + _NEAR * (end - middle)), ["between"])
    return [
        {"number": number, "is": ", ".join(chosen[number]), **_known(front, number)}
        for number in sorted(chosen)
    ]


def _trades(front: FrontOfAnyKind) -> list[str]:
    """Return sentences: how much less of one objective a few per cent more of another buy."""
    names, lengths = names_of(front), front.lengths
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
    """Return a sentence about one trade-off; None if it gains nothing.

    Args:
        lengths: The lengths of the tours of the front, shape (k, m).
        paid: The index of the objective that may be more than its least.
        bought: The index of the objective that becomes less.
        slack: How much more may be paid, as a share of the least.
    """
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
    """Return the text of a document with as many stops of a tour or plan as there is room for.

    The first `first` stops are left out.
    """
    if unassigned := left_out_of(front, number):
        document = {**document, "unassigned": unassigned}
    ways = ways_of(front, number)
    pairs = [(at, place) for at, way in enumerate(ways) for place in range(len(way.stops))]
    rest = pairs[first:]

    def text_of(count: int) -> str:
        kept = rest[:count]
        return as_text({**document, **_stops(front, ways, kept), **_left(pairs, first, kept)})

    def bytes_of(count: int) -> int:
        return len(text_of(count).encode())

    if len(rest) <= MOST_BYTES and bytes_of(len(rest)) <= MOST_BYTES:
        return text_of(len(rest))
    # A stop takes at least one byte, so at most MOST_BYTES stops have room.
    count = bisect_right(range(min(len(rest), MOST_BYTES)), MOST_BYTES, key=bytes_of) - 1
    return text_of(count) if count > 0 else _fitted(document)


def _stops(front: FrontOfAnyKind, ways: Sequence[Way], kept: Sequence[tuple[int, int]]) -> Named:
    """Return the stops that have room, with their times, as members of the document.

    Args:
        ways: The routes of the plan, or the one of the tour.
        kept: The stops that have room: the number of the route, and the place in it.
    """
    places: dict[int, list[int]] = {}
    for at, place in kept:
        places.setdefault(at, []).append(place)
    found = []
    for at, inside in places.items():
        way = ways[at]
        times = {} if way.times is None else {"times": [way.times[place] for place in inside]}
        found.append({**way.known, "stops": [way.stops[place] for place in inside], **times})
    if kind_of(front.document).mover:
        return {"routes": found}
    return found[0] if found else {"stops": []}


def _left(pairs: Sequence[Any], first: int, kept: Sequence[Any]) -> Named:
    """Return a member that says how many stops are not in the text, if there are any.

    Args:
        first: How many stops are left out before the first that is shown.
        kept: The stops that are shown.
    """
    last = min(first, len(pairs)) + len(kept)
    if len(kept) == len(pairs):
        return {}
    sentence = f"{len(pairs) - len(kept)} of {len(pairs)} stops are not in this text"
    more = f": choose_tour with first_stop {last} has the next" if last < len(pairs) else ""
    return {"left_out": f"{sentence}{more}"}


def _noun(front: FrontOfAnyKind) -> str:
    return kind_of(front.document).item


def _known(front: FrontOfAnyKind, number: int) -> Named:
    """Return the lengths of a tour or plan, its times of day, and the measures of a plan."""
    found = {"lengths": _lengths(front, number), **hours_of(front, number)}
    more = {"on_most_days": _on_most_days(front, number), "measures": measures_of(front, number)}
    return {**found, **{name: member for name, member in more.items() if member}}


def _on_most_days(front: FrontOfAnyKind, number: int) -> dict[str, str]:
    """Return a sentence for each length of a tour that spreads, by the name of its objective."""
    if isinstance(front, FleetFront):
        return _duration_on_most_days(front, number)
    if not isinstance(front, Front) or front.means is None or front.p90 is None:
        return {}
    pairs = zip(front.means[number], front.p90[number], strict=True)
    said = zip(names_of(front), _units(front), pairs, strict=True)
    return {name: on_most_days(*pair, unit) for name, unit, pair in said if pair[0] < pair[1]}


def _duration_on_most_days(front: FleetFront, number: int) -> dict[str, str]:
    """Return a sentence about the time of all routes of a plan, if times spread."""
    measures = front[number].measures
    if front.clock is None or "duration_p90" not in measures:
        return {}
    pair = measures["duration"], measures["duration_p90"]
    return {"all routes together": on_most_days(*pair, front.clock.unit)}


def _lengths(front: FrontOfAnyKind, number: int) -> dict[str, float]:
    return dict(zip(names_of(front), map(_short, front.lengths[number]), strict=True))


def _lengths_text(front: FrontOfAnyKind, number: int) -> str:
    return _amounts(front, front.lengths[number])


def _amounts(front: FrontOfAnyKind, lengths: Iterable[float]) -> str:
    """Return lengths under the objectives in words, as "time 2:10 h, distance 14.2 km"."""
    triples = zip(names_of(front), _units(front), lengths, strict=True)
    return ", ".join(f"{shown(name)} {amount(length, unit)}" for name, unit, length in triples)


def _units(front: FrontOfAnyKind) -> list[str | None]:
    return [each.unit for each in front.objectives or ()] or [None] * front.lengths.shape[1]


def _short(number: float) -> float:
    """Return a number rounded to seven digits."""
    return float(f"{number:.7g}")


def _linked(document: dict[str, Any], link: str | None) -> dict[str, Any]:
    return document if link is None else {**document, "link": link}


def _fitted(document: Named) -> str:
    """Return the text of a document, shortened if long names make it too long.

    The last trade-offs are left out first, then the last tours, then all ranges, then the last
    sentences on the file and on the request, and then the last stops that a plan leaves out.
    """
    members = dict(document)
    for name in ("trades", "tours", "ranges", "assumed", "notes", "unassigned"):
        while len(as_text(members).encode()) > MOST_BYTES and members.get(name):
            members[name] = members[name][:-1] if isinstance(members[name], list) else {}
    return as_text(members)


def as_text(document: Named) -> str:
    """Return a document as JSON, as agents read it."""
    return json.dumps(document, ensure_ascii=False)
