"""The measures of a route that depend on its times, and how it differs from what was promised."""

from collections.abc import Callable, Mapping

from service.fleet.plans import Route, path_of
from service.fleet.rounding import excess, is_over
from service.fleet.rules import Rules
from service.fleet.times import Schedule


def lateness(_: Rules, __: Route, times: Schedule) -> float:
    """Return the sum of the times by which the visits of a route begin after they are due."""
    return times.lateness


def earliness(rules: Rules, route: Route, times: Schedule) -> float:
    """Return the sum of the times by which the visits of a route begin before they are wanted."""
    begins = zip(path_of(rules, route), times.begins, strict=True)
    return sum(excess(rules.visits[stop].wanted, begin) for stop, begin in begins)


def weighted_arrival(rules: Rules, route: Route, times: Schedule) -> float:
    """Return the sum over the visits of a route of their urgency times when they begin.

    Times count from the begin of the first shift.
    """
    begins = zip(path_of(rules, route), times.begins, strict=True)
    visits = ((stop, begin) for stop, begin in begins if stop not in rules.depots)
    return sum(rules.visits[stop].urgency * (begin - rules.begin) for stop, begin in visits)


def overtime(rules: Rules, route: Route, times: Schedule) -> float:
    """Return how much later than its shift a route ends."""
    return excess(times.end, rules.vehicles[route.vehicle].shift[1])


def changes(rules: Rules, route: Route, times: Schedule | None) -> int:
    """Return how many promised stops of a route another vehicle should visit, or begin late."""
    path = path_of(rules, route)
    begins = (0.0,) * len(path) if times is None else times.begins
    return sum(
        rules.visits[stop].promised_to != route.vehicle
        or is_over(begin, rules.promised_until[stop])
        for stop, begin in zip(path, begins, strict=True)
        if stop in rules.promises
    )


OF_TIMES: Mapping[str, Callable[[Rules, Route, Schedule], float]] = {
    each.__name__: each for each in (overtime, lateness, earliness, weighted_arrival)
}
