"""Read the list of stored fronts, page by page."""

from datetime import datetime

import httpx
from paretour.described import answer, member
from paretour.expect import unexpected, value_of
from paretour.fronts import FleetObjective, Objective

PAGE = 100  # the most fronts that the service lists at once


@answer("ListedFrontItem", eq=True)
class ListedFront:
    """A front in a list.

    It comes without its tours: `client.any_job(id).front()` is the front itself.
    """

    id: str
    status: str = member("queued, running, done, cancelled or failed")
    kind: str = member("front, coverage, fleet or robots")
    stored_at: datetime = member(
        "when it was submitted or, once it is finished, when it was finished (RFC 3339)"
    )
    cities: int = member("its cities, stops or places")
    points: int = member("how many nondominated points were found")
    hypervolume: float = member("of the tours or plans that it holds")
    objectives: tuple[FleetObjective | Objective, ...] | None = member("as the request names them")


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
