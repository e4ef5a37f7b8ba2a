"""Read the list of stored fronts, page by page."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

import httpx
from paretour.expect import count, each, members, number, text, unexpected
from paretour.fronts import Objective
from paretour.values import parse_objective

PAGE = 100  # the most fronts that the service lists at once


@dataclass(frozen=True, kw_only=True)
class ListedFront:
    """A front in a list, without its tours; `client.any_job(id).front()` is the front itself.

    Attributes:
        id: Its id.
        status: queued, running, done, cancelled or failed.
        kind: front, coverage, fleet or robots.
        stored_at: When it was submitted or, once it is finished, when it was finished.
        cities: The number of its cities, stops or places.
        points: The number of nondominated points found.
        hypervolume: The hypervolume of the tours that it holds.
        objectives: Their names and units, if the request named them.
    """

    id: str
    status: str
    kind: str
    stored_at: datetime
    cities: int
    points: int
    hypervolume: float
    objectives: tuple[Objective, ...] | None


def parse_listed(value: Any, where: str) -> ListedFront:
    """Read one front of a list."""
    item = members(value, where)
    return ListedFront(
        id=item.read("id", text),
        status=item.read("status", text),
        kind=item.read("kind", text),
        stored_at=item.read("stored_at", _time),
        cities=item.read("cities", count),
        points=item.read("points", count),
        hypervolume=item.read("hypervolume", number),
        objectives=item.maybe("objectives", each(parse_objective)),
    )


def next_page(response: httpx.Response) -> str | None:
    """Return what the next page begins after, as the answer's header `Link` says; None at the end.

    Raises:
        UnexpectedAnswer: The link has no such parameter.
    """
    link = response.links.get("next", {}).get("url")
    if link is None:
        return None
    try:
        after: str = httpx.URL(link).params["after"]
    except (httpx.InvalidURL, KeyError):
        raise unexpected("header Link", "the address of the next page", link) from None
    return after


def _time(value: Any, where: str) -> datetime:
    try:
        return datetime.fromisoformat(text(value, where))
    except ValueError:
        raise unexpected(where, "a time of RFC 3339", value) from None
