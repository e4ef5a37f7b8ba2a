"""Stored tasks: read what this version has stored, and what earlier versions have."""

from collections.abc import Mapping

from service.actor_info import ActorInfo
from service.requests.earlier_versions import parse_rest
from service.requests.limits import Limits
from service.requests.parser import parse_task
from service.requests.task import Task, TaskSource
from service.requests.task_codec import decode_task, encode_task


def stored(task: Task) -> TaskSource:
    """Return a task as it is stored."""
    return TaskSource("task", encode_task(task))


def read_task(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return a stored task; of earlier versions, parsed from the request that they stored.

    Raises:
        Refusal: The request of an earlier version is refused now.
        ValueError: The task is damaged.
    """
    match source.kind:
        case "task":
            return decode_task(source.body)
        case "replan" | "replan-coverage":
            return parse_rest(source, limits, actors)
    return parse_task(source, limits, actors)
