"""Look for remedies of all kinds, within a time that they share.

The time is the processor's, so a busy machine finds the same remedies, later.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from service.errors import Refusal, Remedy
from service.fleet.fleet import Fleet
from service.fleet.necessary import check_necessary
from service.fleet.plans import FleetFront
from service.fleet.rules import Rules
from service.remedies.asked import AskedFleet, Look
from service.remedies.patch import put
from service.remedies.rest import AskedRest
from service.remedies.stops import any_vehicle, leave_out
from service.remedies.times import (
    earlier_shifts,
    later_windows,
    longer_routes,
    longer_shifts,
    no_slack,
    no_waits,
)
from service.remedies.vehicles import (
    larger_vehicles,
    load_again,
    more_skills,
    more_stops,
    more_vehicles,
    send_more,
)
from service.watch import Watch

_MOST_SECONDS = 1.0  # in all
_LEAST_SECONDS = 0.2  # where the time limit is shorter
_BUSY = 4.0  # times as long by the clock, on a machine that has other work
_MOST_REMEDIES = 6
# Seconds of a trial, which is the longer the more stops there are.
_LEAST_TRIAL, _OF_A_STOP, _MOST_TRIAL = 0.06, 5e-4, 0.3
_SHARE = 1 / 3  # of the time left, for the remedies of one kind
_LONGER = 2.0  # times as long as it is to take, a trial may take
_ENOUGH = 1.0  # seconds of a search that is offered in place of none or of a short one
# Those first that people ask for first.
_KINDS: tuple[Look, ...] = (
    leave_out,
    load_again,
    more_vehicles,
    longer_shifts,
    earlier_shifts,
    later_windows,
    longer_routes,
    more_stops,
    more_skills,
    any_vehicle,
    larger_vehicles,
    no_slack,
    no_waits,
)
_KINDS_OF_REST: tuple[Look, ...] = (leave_out, send_more, longer_shifts, later_windows, no_slack)
# Plans a fleet within some seconds, and raises a refusal if it finds no plan.
PlanWithin = Callable[[Fleet, float, Watch[Any]], FleetFront]


def remedies_of(
    asked: AskedFleet, time_limit: float, most: float, plan: PlanWithin, watch: Watch[Any]
) -> tuple[Remedy, ...]:
    """Return changes to a request for a fleet without a plan, after each of which it has one.

    Args:
        asked: The fleet, which has no plan, or none that was found.
        time_limit: The seconds that the request has for planning: no trial has more.
        most: The most seconds that a request may have.
    """
    seconds = min(_MOST_SECONDS, max(_LEAST_SECONDS, time_limit))
    trial = min(max(_LEAST_TRIAL, _OF_A_STOP * asked.rules.n), _MOST_TRIAL)
    computed = Watch[Any](seconds, watch.lasting(_BUSY * seconds).ended, clock=time.thread_time)
    looking = _Looking(asked.fleet, min(trial, time_limit), plan, computed)
    longer = _Looking(asked.fleet, trial, plan, looking.watch)
    found: list[Remedy] = []
    if time_limit < trial and (remedy := _more_time(asked, min(_ENOUGH, most), longer)):
        found.append(remedy)
    for look in _KINDS_OF_REST if isinstance(asked, AskedRest) else _KINDS:
        looking.begin()
        if remedy := look(asked, looking.tried):
            found.append(remedy)
        if len(found) == _MOST_REMEDIES or looking.watch.ended():
            break
    return tuple(found)


def _more_time(asked: AskedFleet, time_limit: float, looking: "_Looking") -> Remedy | None:
    """Search for longer, where the request has less time than a trial."""
    looking.begin()
    if looking.trial > time_limit or looking.tried(asked.rules) is None:
        return None
    return Remedy("more-time", (put("/time_limit", time_limit),), {"time_limit": time_limit})


@dataclass
class _Looking:
    """Tries rules one after another.

    Args:
        trial: The most seconds of a trial.
        plan: Plans a fleet.
        watch: Watches all trials, by the seconds that this thread computes.
        until: When the trials end of one kind of remedies, in seconds since the first began.
    """

    fleet: Fleet
    trial: float
    plan: PlanWithin
    watch: Watch[Any]
    until: float = 0.0

    def begin(self) -> None:
        """Begin with the next kind of remedies: it has a share of the time left, or two trials."""
        share = max(_SHARE * self.watch.left, _LONGER * self.trial)
        self.until = min(self.watch.spent + share, self.watch.seconds)

    def tried(self, rules: Rules) -> FleetFront | None:
        """Return the front of the fleet under other rules; None if no plan was found in time."""
        left = self.until - self.watch.spent
        if left <= 0:
            return None
        fleet = self.fleet.under(rules)
        ends = min(self.until, self.watch.spent + (_LONGER * self.trial or left))
        ended = self.watch.until(ends).ended
        try:
            check_necessary(fleet, ended)  # planning has a share of its time alone for this
            within = Watch[Any](stop=ended, clock=lambda: self.watch.spent)
            return self.plan(fleet, min(self.trial, left), within)
        except Refusal:  # also if it was stopped
            return None
