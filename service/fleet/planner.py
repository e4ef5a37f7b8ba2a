"""plan_fleet(...): from a fleet to its front of plans."""

from collections.abc import Callable
from itertools import chain, count

from service.construction.first_tours import Constructor
from service.errors import Cancelled, Refusal
from service.fleet.conflicts import no_plan
from service.fleet.enumeration import MOST_STOPS, exact_plans, is_enumerable, some_plan
from service.fleet.evaluation import violations
from service.fleet.first_plans import Cutter, network_sequences, plain_plans, without_changes
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions, front_of
from service.fleet.left_out import with_all_stops
from service.fleet.necessary import check_necessary
from service.fleet.plans import FleetFront, Plan
from service.fleet.search.search import RuinSearch
from service.watch import Watch

_ENUMERATING = 0.5  # share of the time limit, after which the search replaces enumeration
_TRYING = 0.9  # share of the time limit, until when routes are tried if a search found no plan
_LEAST_TRYING = 0.1  # seconds for that
_FINDING_FAULTS = 0.1  # share of the time limit for necessary conditions
# Without a time limit steps are counted, so that the same request has the same answer on any
# machine: some tenths of a second. A step of the necessary conditions takes the longer the more
# stops there are.
_MOST_STEPS = 30_000
_MOST_ENTRIES = 1e8  # of costs that are compared


def plan_fleet(
    fleet: Fleet,
    options: FleetOptions,
    constructor: Constructor | None = None,
    watch: Watch[FleetFront] | None = None,
) -> FleetFront:
    """Return the best front of plans found for a fleet within the time limit.

    Args:
        options: The options of the front and the search.
        constructor: The network whose tours are cut into plans where the time limit is 0; it must
            read matrices. A search does not ask it: its fronts are as good without.
        watch: Asked every few milliseconds whether to stop; planning then ends with the best front
            so far. It also says when to report. The time limit is that of the options.

    Raises:
        NoTour: Some stops cannot be visited under the rules. The refusal names them.
        Refusal: `no-plan`: no plan keeps every rule, or none was found in time. If no rule can be
            broken, a plan is always found. `no-actor`: the time limit is 0 and there is no network.
            `invalid-instance`: costs, prizes and times are too far apart.
        InvalidInstance: The time limit is 0, and costs are too far apart for the network.
        Cancelled: The watch said to stop before a plan was found.
        ValueError: A component of the reference point is not positive, or the size is below 1.
    """
    watch = (watch or Watch()).lasting(options.time_limit)
    entries = int(_MOST_ENTRIES / max(1, fleet.rules.n) ** 2)
    check_necessary(fleet, _ended(watch, _FINDING_FAULTS, min(_MOST_STEPS, entries)))
    if is_enumerable(fleet.rules):
        all_plans = exact_plans(fleet, _ended(watch, _ENUMERATING, _MOST_STEPS))
        if all_plans is not None:
            if not all_plans:
                sentence = "no plan keeps every rule: all were tried"
                raise no_plan(fleet, sentence, _ended(watch, 1.0, _MOST_STEPS))
            return front_of(fleet, options, all_plans, "converged", watch)
    if options.time_limit == 0:
        return _without_search(fleet, options, constructor, watch)
    return _searched(fleet, options, watch)


def _ended(watch: Watch[FleetFront], share: float, steps: int) -> Callable[[], bool]:
    """Return a function that says whether a part of planning must end, and is called at each step.

    Args:
        watch: Watches all of planning.
        share: The share of the time limit after which the part ends.
        steps: After how many steps it ends where there is no time limit.
    """
    if watch.seconds:
        return watch.until(share * watch.seconds).ended
    taken = count(1)
    return lambda: watch.stopped() or next(taken) > steps


def _without_search(
    fleet: Fleet,
    options: FleetOptions,
    constructor: Constructor | None,
    watch: Watch[FleetFront],
) -> FleetFront:
    """Return the front of the plans of the network, and of the plan that is driven, if one is."""
    driven = None if options.driven is None else _completed(fleet, options.driven)
    kept = [] if driven is None else [driven]
    try:
        plans = _constructed(fleet, constructor, watch)
    except Refusal:
        if not kept:
            raise
        plans = []
    return front_of(fleet, options, [*kept, *plans], "converged", watch, constructed=len(plans))


def _completed(fleet: Fleet, plan: Plan) -> Plan | None:
    """Return a plan if it breaks no rule, else with the stops that it lacks; None if that does."""
    if not violations(fleet, plan):
        return plan
    whole = with_all_stops(fleet, plan)
    return None if violations(fleet, whole) else whole


def _searched(fleet: Fleet, options: FleetOptions, watch: Watch[FleetFront]) -> FleetFront:
    """Return the front that a search finds; if it found none, a front of one plain plan."""
    search = RuinSearch(fleet, options, watch)
    driven = None if options.driven is None else _completed(fleet, options.driven)
    if driven is not None:
        search.begin_with(driven)
    terminated = search.run()
    if not len(search) and terminated != "cancelled":
        tried = _tried(fleet, watch)
        for plan in chain([tried] if tried else [], plain_plans(fleet, watch.stopped)):
            if not violations(fleet, plan):
                return front_of(fleet, options, [plan], terminated, watch)
    return search.front(options.size, terminated)


def _tried(fleet: Fleet, watch: Watch[FleetFront]) -> Plan | None:
    """Return a plan of a fleet of few stops, found by trying its routes; None if none is found."""
    if len(fleet.rules.clients) > MOST_STOPS:
        return None
    seconds = max(_TRYING * watch.seconds, watch.spent + _LEAST_TRYING)
    return some_plan(fleet, watch.until(seconds).ended)


def _constructed(
    fleet: Fleet, constructor: Constructor | None, watch: Watch[FleetFront]
) -> list[Plan]:
    """Return the plans made by cutting the tours of a network into routes."""
    if constructor is None:
        raise Refusal("no-actor", kind="fleets with time_limit 0")
    sequences = network_sequences(fleet, constructor)
    for each in without_changes(fleet):
        cutter = Cutter(each, sequences, watch.stopped)
        plans = [plan for plan in cutter.plans() if not violations(fleet, plan)]
        if plans:
            return plans
    if watch.stopped():
        raise Cancelled
    reason = "no cut of the network's tours keeps every rule: a time_limit over 0 may find a plan"
    raise Refusal("no-plan", reason=reason)
