"""The front of a task before anything is found."""

from service.jobs.fleets.fleet_document import empty_fleet
from service.jobs.fleets.robot_document import empty_robot_plans
from service.jobs.front_document import FrontDocument, empty_front
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.maps.robots import SharedCoverage
from service.requests.task import Task


def empty_document(task: Task) -> FrontDocument:
    """Return the document of a task, of tours or of plans, before anything is found."""
    match task.subject:
        case UnmeasuredFleet():
            return empty_fleet(task)
        case SharedCoverage() as subject:
            return empty_robot_plans(task, subject)
    return empty_front(task)
