"""Write and read stored tasks, and read those that earlier versions stored."""

from collections.abc import Mapping

from service.actor_info import ActorInfo
from service.requests.earlier_versions import parse_rest
from service.requests.limits import Limits
from service.requests.parser import parse_task
from service.requests.task import Task, TaskSource
from service.requests.task_codec import decode_task, encode_task


def stored(task: Task) -> TaskSource:
    """Return a task in the form in which it is stored."""
    return TaskSource("task", encode_task(task))


def read_task(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return a stored task; earlier versions stored the request, which is parsed again.

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
