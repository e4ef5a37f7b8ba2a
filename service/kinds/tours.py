"""Plan the tours of an instance for a task: through stops, or through the places of a map."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from service.coverage.survey import Survey
from service.errors import NoTour
from service.front import Front, reporting
from service.instance import Instance, cumulated_lengths
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report, Tools
from service.kinds.tour_document import encode_front
from service.planner import plan
from service.replanning.replan import replan
from service.requests.task import Task


def plan_tours(
    task: Task,
    instance: Instance,
    tools: Tools,
    stop: Callable[[], bool],
    report: Report,
    surveyed: Survey | None = None,
) -> Front:
    """Plan or replan the front of a task; `surveyed` is the map, if it has one."""
    actor = tools.actors[task.actor]

    def encoded(front: Front) -> FrontDocument:
        return encode_front(front, actor.info.identity, surveyed, labels=task.labels)

    report_encoded = reporting(report, encoded)
    try:
        if task.earlier is not None:
            return replan(actor, instance, task.options, task.earlier, stop, report_encoded)
        return plan(actor, instance, task.options, stop, report_encoded)
    except NoTour as refusal:
        raise refusal.named(task.city_names) from None


def arrivals_of(task: Task, instance: Instance, front: Front) -> NDArray[np.float64] | None:
    """Return both lengths of each tour up to each of its stops, if the task asks for them."""
    return cumulated_lengths(instance, front.tours) if task.arrivals else None
