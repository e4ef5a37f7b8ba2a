"""The measures of a route that depend on its times, and how it differs from what was promised."""

from collections.abc import Callable, Iterator, Mapping

from service.fleet.fleet import Fleet
from service.fleet.plans import Route, path_of
from service.fleet.rounding import excess, is_over
from service.fleet.schedule import schedule


def lateness(fleet: Fleet, route: Route) -> float:
    """Return the sum of the times by which the visits of a route begin after they are due."""
    return schedule(fleet, route).lateness


def earliness(fleet: Fleet, route: Route) -> float:
    """Return the sum of the times by which the visits of a route begin before they are wanted."""
    visits = fleet.rules.visits
    return sum(excess(visits[stop].wanted, begin) for stop, begin in _begins(fleet, route))


def weighted_arrival(fleet: Fleet, route: Route) -> float:
    """Return the sum over the visits of a route of their urgency times when they begin.

    Times count from the begin of the first shift.
    """
    rules = fleet.rules
    visits = ((stop, begin) for stop, begin in _begins(fleet, route) if stop not in rules.depots)
    return sum(rules.visits[stop].urgency * (begin - rules.begin) for stop, begin in visits)


def overtime(fleet: Fleet, route: Route) -> float:
    """Return how much later than its shift a route ends."""
    return excess(schedule(fleet, route).end, fleet.rules.vehicles[route.vehicle].shift[1])


def changes(fleet: Fleet, route: Route) -> int:
    """Return how many promised stops of a route another vehicle should visit, or begin late."""
    rules = fleet.rules
    return sum(
        rules.visits[stop].promised_to != route.vehicle
        or is_over(begin, rules.promised_until[stop])
        for stop, begin in _begins(fleet, route)
        if stop in rules.promises
    )


def _begins(fleet: Fleet, route: Route) -> Iterator[tuple[int, float]]:
    """Yield each stop of a route and when its visit begins: 0 without a clock."""
    path = path_of(fleet.rules, route)
    untimed = fleet.rules.clock is None
    begins = (0.0,) * len(path) if untimed else schedule(fleet, route).begins
    return zip(path, begins, strict=True)


OF_TIMES: Mapping[str, Callable[[Fleet, Route], float]] = {
    each.__name__: each for each in (lateness, overtime, earliness, weighted_arrival)
}
