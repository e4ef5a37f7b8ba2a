"""The measures of plans: a row of the table `MEASURES` each, with its unit and all words for it.

A new one is listed here first. How a plan is measured is in the modules beside this one.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Literal, get_args

from service.fleet.vehicles import VehicleType, Visit

# The measures that may be objectives. The API lists them in this order: add new ones at the end.
Measure = Literal[
    "vehicles",
    "unassigned",
    "overtime",
    "lateness",
    "imbalance",
    "load_distance",
    "earliness",
    "weighted_arrival",
    "overlap",
    "changes",
    "on_time",
]
# Times by the clock, lengths of routes, prizes, loads times costs, shares, or what is counted.
Unit = Literal["clock", "routes", "prizes", "load", "%", "vehicles", "stops", "visits"]
OF_TIME: Sequence[Unit] = ("clock", "routes")


@dataclass(frozen=True, kw_only=True)
class PlanMeasure:
    """A measure of plans.

    Args:
        unit: Its unit as an objective.
        title: Its title on the page, beside a plan.
        of_plan: Its unit beside a plan, if that is another.
        said: What a share beside a plan is of, to agents.
        column: The title of its column in CSV of the page, if it has one there.
        text: What it is as an objective, for the reference. Texts are joined to one sentence.
        choice: Its title and its name where the page offers it as an objective, and the member of
            `stops` or `vehicles` that is then a column.
        note: What the page says below its name where that could be taken for something else.
        given: Whether the visits and the vehicles of a fleet have the data for it. If not, plans
            have it only as an objective.
        lacking: The code of the refusal of an objective without these data; "" where it may be one.
        of_begins: Whether it depends on when each visit begins, not only on late ones.
    """

    unit: Unit
    title: str
    of_plan: Unit | None = None
    said: str = ""
    column: str = ""
    text: str = ""
    choice: Mapping[str, str] | None = None
    note: str = ""
    given: Callable[[Sequence[Visit], Sequence[VehicleType]], bool] = lambda *_: True
    lacking: str = ""
    of_begins: bool = False


# In the order in which the measures of a plan are listed.
MEASURES: Mapping[str, PlanMeasure] = {
    "vehicles": PlanMeasure(
        unit="vehicles",
        title="Vehicles used",
        text="the number of vehicles that are used",
        choice={"title": "Vehicles used", "name": "vehicles"},
    ),
    "driving": PlanMeasure(unit="clock", title="Driving in all"),
    "service": PlanMeasure(unit="clock", title="At stops in all"),
    "waiting": PlanMeasure(unit="clock", title="Waiting in all"),
    "lateness": PlanMeasure(
        unit="clock",
        title="Late in all",
        text="the lateness after stops are due",
        choice={"title": "Lateness", "name": "lateness", "stops": "due"},
        given=lambda visits, _: any(visit.due < inf for visit in visits),
        lacking="no-due",
    ),
    "earliness": PlanMeasure(
        unit="clock",
        title="Early in all",
        text="the earliness before they are",
        choice={"title": "Earliness", "name": "earliness", "stops": "due"},
        given=lambda visits, _: any(visit.wanted for visit in visits),
        lacking="no-due-from",
        of_begins=True,
    ),
    "weighted_arrival": PlanMeasure(
        unit="clock",
        title="Customer wait",
        text="the weighted arrival, which is the time until each visit begins times its urgency,"
        " each summed up over the plan",
        choice={"title": "Customer wait, by urgency", "name": "customer wait", "stops": "urgency"},
        note="how long each stop waits for its visit, times its urgency, added up",
        given=lambda visits, _: any(visit.urgency != 1 for visit in visits),
        of_begins=True,
    ),
    "overtime": PlanMeasure(
        unit="clock",
        title="Overtime in all",
        text="the overtime beyond shifts",
        choice={"title": "Overtime", "name": "overtime", "vehicles": "max_overtime"},
        given=lambda _, vehicles: any(vehicle.max_overtime for vehicle in vehicles),
        lacking="no-overtime",
    ),
    "longest": PlanMeasure(unit="routes", title="Longest route"),
    "shortest": PlanMeasure(unit="routes", title="Shortest route"),
    "imbalance": PlanMeasure(
        unit="routes",
        title="Longest minus shortest",
        text="the imbalance, by which the longest route is longer than the shortest",
        choice={"title": "Longest minus shortest route", "name": "imbalance"},
    ),
    "unassigned": PlanMeasure(
        unit="prizes",
        title="Prizes left out",
        text="the prizes of the stops that are left out",
        choice={"title": "Orders left out", "name": "orders left out", "stops": "prize"},
        given=lambda visits, _: any(visit.prize is not None for visit in visits),
        lacking="no-prizes",
    ),
    "load_distance": PlanMeasure(
        unit="load",
        title="Load carried",
        text="the load distance, the first costs of each leg times the load",
        choice={"title": "Load carried", "name": "load carried", "vehicles": "capacity"},
        note="each load times how far it is carried, added up",
        given=lambda _, vehicles: bool(vehicles[0].capacity),
        lacking="no-loads",
    ),
    "overlap": PlanMeasure(
        unit="%",
        title="Overlap of routes",
        said="of neighbours ride with somebody else",
        text="the overlap, from 0 to 1, which is the share of neighbours that do not ride with each"
        " other, weighted by nearness",
        choice={"title": "Overlap of routes", "name": "overlap of routes"},
        note="how many neighbours ride with different vehicles, the nearest counting most",
        given=lambda *_: False,  # it takes O(n^2) to find the neighbours
    ),
    "changes": PlanMeasure(
        unit="stops",
        title="Stops changed",
        text="or the changes: how many stops of the plan in `promised` are left out, or visited by"
        " another vehicle or later than with its tolerance",
        note="visited by another vehicle, or later, than in the plan before",
        given=lambda visits, _: any(visit.promised_to is not None for visit in visits),
        lacking="no-promises",
    ),
    "on_time": PlanMeasure(
        unit="visits",
        title="Visits on time",
        of_plan="%",
        said="of visits",
        column="share of visits on time",
        text="or, where times have a `spread` or `days`, on_time: how many visits are late on an"
        " average day",
        choice={"title": "Late visits", "name": "late visits", "stops": "window"},
        note="begun after their window or after they are due, on an average day",
        given=lambda visits, _: any(visit.is_timed for visit in visits),
        lacking="no-window-or-due",
    ),
    "duration": PlanMeasure(
        unit="clock", title="Time in all, on average", column="mean time in all"
    ),
    "duration_p90": PlanMeasure(
        unit="clock", title="Nine days of ten within", column="p90 time in all"
    ),
}
_FIRST = ("vehicles", "unassigned", "overtime")  # which dispatchers choose most
# The objectives in the order in which they are offered.
TRADED: Mapping[str, PlanMeasure] = {
    name: MEASURES[name] for name in (*_FIRST, *MEASURES) if name in get_args(Measure)
}


def joined_texts() -> str:
    """Return what all objectives are, as one sentence: after a text with a comma comes a `;`."""
    texts = [each.text for each in TRADED.values()]
    return "".join(f"{text}{';' if ',' in text else ','} " for text in texts[:-1]) + texts[-1]
