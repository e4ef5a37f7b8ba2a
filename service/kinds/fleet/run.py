"""Plan the front of a fleet for a task."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from service.errors import NoTour
from service.fleet.fleet import Fleet
from service.fleet.necessary import least_lengths
from service.fleet.plans import FleetFront
from service.front import ReportOf, reporting
from service.kinds.fleet.document import encode_fleet
from service.kinds.front_document import FrontDocument
from service.kinds.kind import NamedActor, Report, Tools
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.limits import check_reference_point
from service.requests.task import Task


def run_fleet(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    """Return the front of plans of a task; see `Run`."""
    subject, actor = task.subject, tools.actors.get(task.actor)
    assert isinstance(subject, UnmeasuredFleet)
    assert task.labels is not None
    labels = task.labels

    def encoded(front: FleetFront) -> FrontDocument:
        return encode_fleet(front, identity_of(front, actor), subject, labels)

    began = time.perf_counter()
    fleet = subject.fleet()
    timings = {**task.timings, "costs": 1000 * (time.perf_counter() - began)}
    try:
        front = plan_front(task, fleet, actor, stop, reporting(report, encoded))
    except NoTour as refusal:
        raise refusal.named(task.city_names) from None
    return encoded(replace(front, timings={**timings, **front.timings}))


def plan_front(
    task: Task,
    fleet: Fleet,
    actor: NamedActor | None,
    stop: Callable[[], bool],
    report: ReportOf[FleetFront],
) -> FleetFront:
    """Return the front of plans of a fleet, with the options of a task."""
    # Imported here so that a service or a worker starts without PyVRP.
    from service.fleet.planner import FleetOptions, plan_fleet

    check_reference_point(task.options, partial(least_lengths, fleet), "plan")
    options = FleetOptions(
        time_limit=task.options.time_limit,
        size=task.options.size,
        seed=task.options.seed,
        reference_point=task.options.reference_point,
    )
    return plan_fleet(fleet, options, actor, stop, report)


def identity_of(front: FleetFront, actor: NamedActor | None) -> dict[str, str] | None:
    """Return the identity of the network whose tours were cut into plans of a front, if any."""
    return actor.info.identity if actor is not None and front.constructed else None


def warm_up() -> None:
    """Import PyVRP, which takes some tenths of a second, and compile the optimal split."""
    import service.fleet.planner  # noqa: F401
    from service.fleet import first_plans

    first_plans.warm_up()
