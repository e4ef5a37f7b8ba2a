"""A kind of plan as a row of a table, and the interface of the function that plans it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from service.actor_info import ActorInfo
from service.construction.first_tours import Constructor
from service.front import ReportOf, SearchFunction
from service.kinds.front_document import FrontDocument
from service.requests.limits import Limits
from service.requests.task import KindName, Task

Report = ReportOf[FrontDocument]


class NamedActor(Constructor, Protocol):
    """A constructor of tours with a name and a digest."""

    @property
    def info(self) -> ActorInfo:
        """The information in its file."""

    def load(self) -> None:
        """Prepare for calls, so that the first one is as fast as the others."""


@dataclass(frozen=True)
class Tools:
    """The tools of a worker: the actors by name, and the limits of its service.

    `search` improves tours in the place of Paretour's search, if the operator has named one.
    """

    actors: Mapping[str, NamedActor]
    limits: Limits
    search: SearchFunction | None = None


class Run(Protocol):
    """Plans the front of a task of one kind."""

    def __call__(
        self, task: Task, tools: Tools, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        """Return the front of a task whose costs by road have been measured.

        Args:
            task: The task.
            tools: The actors and limits.
            stop: Called often; planning ends soon after it returns True.
            report: Called regularly with the progress, and with a function that returns the best n
                tours or plans found so far.

        Raises:
            Refusal: No tour or plan exists or was found, or the task asks for too much.
            Cancelled: `stop` returned True before a tour or plan was found.
        """


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of plan.

    Args:
        name: The member `kind` of its answers.
        of_plans: Whether its fronts are of plans for several vehicles or robots, not of tours.
        label: The label of its fronts in the metrics.
        outline: Returns the number of cities of a task, and the members of its answer that are
            known before anything is planned.
    """

    name: KindName
    of_plans: bool
    label: str
    outline: Callable[[Task], tuple[int, dict[str, Any]]]
