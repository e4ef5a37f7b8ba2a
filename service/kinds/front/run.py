"""Plan the front of tours through stops or cities."""

import time
from collections.abc import Callable
from dataclasses import replace

from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report, Tools
from service.kinds.tour_document import encode_front
from service.kinds.tours import arrivals_of, plan_tours
from service.requests.parser import check_instance
from service.requests.task import Task


def run_front(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    """Return the front of a task; see `Run`."""
    stops = task.stops
    assert stops is not None
    began = time.perf_counter()
    instance, timings = stops.instance, {}
    if task.timings or not stops.measured:  # else it was checked when it came
        check_instance(task, instance)
        timings = {**task.timings, "costs": 1000 * (time.perf_counter() - began)}
    front = plan_tours(task, instance, tools, stop, report)
    if timings:
        front = replace(front, timings={**timings, **front.timings})
    return encode_front(
        front,
        tools.actors[task.actor].info.identity,
        labels=task.labels,
        arrivals=arrivals_of(task, instance, front),
    )
