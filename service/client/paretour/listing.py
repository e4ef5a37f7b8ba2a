"""Read the list of stored fronts, page by page."""

from dataclasses import dataclass
from datetime import datetime

import httpx
from paretour.expect import unexpected, value_of
from paretour.fronts import Objective

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


parse_listed = value_of(ListedFront)


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
