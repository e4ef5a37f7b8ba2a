"""A kind of plan as one object, and the interfaces of the functions in it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Generic, Literal, Protocol, TypeVar

from service.actor_info import ActorInfo
from service.construction.first_tours import Constructor
from service.front import SearchFunction
from service.kinds.front_document import FrontDocument
from service.kinds.parts import Part
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import KindName, Task, TaskSource
from service.watch import ReportOf, Watch

Report = ReportOf[FrontDocument]
S = TypeVar("S")  # the subject of a kind's tasks
S_contra = TypeVar("S_contra", contravariant=True)
Actors = Mapping[str, ActorInfo]


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


class Run(Protocol[S_contra]):
    """Plans the front of a task of one kind."""

    def __call__(
        self, subject: S_contra, task: Task, tools: Tools, watch: Watch[FrontDocument]
    ) -> FrontDocument:
        """Return the front of a task whose costs by road have been measured.

        Args:
            tools: The actors and limits.
            watch: Asked often whether to stop, and told the progress regularly.

        Raises:
            Refusal: No tour or plan exists or was found, or the task asks for too much.
            Cancelled: The watch said to stop before a tour or plan was found.
        """


@dataclass(frozen=True, kw_only=True)
class Kind(Generic[S]):
    """A kind of plan: all that differs between kinds.

    Args:
        name: The member `kind` of its answers, and the function of the client that plans it.
        path: The path of HTTP, without a slash, to which its requests are posted.
        subject: The type of the subject of its tasks.
        read: Returns the task that a request asks for. Kinds with the same path have the same.
        rest: Returns the task of the rest of a front that is replanned, or refuses that.
        planner: The module and the name of the function that plans it. A process that only serves
            HTTP must not import it: it comes with the engines.
        parts: Returns the parts of the compiled code that a task needs, with those of a bound.
        outline: Returns the number of cities of a task, and the members of its answer that are
            known before anything is planned.
        label: The label of its fronts in the metrics.
        item: What its fronts hold.
        mover: What takes a route of a plan, and the member of the route with its name; None where
            the front holds tours.
        visits: The member of a tour or route with what it visits, in order.
        stops: What people call these.
        on_grid: Whether it is planned on the grid of a map.
    """

    name: KindName
    path: Literal["front", "coverage", "fleet"]
    subject: type[S]
    read: Callable[[TaskSource, Limits, Actors], Task]
    rest: Callable[[S, Task, ReplanSource, Limits, Actors], Task]
    planner: tuple[str, str]
    parts: Callable[[S, Task], frozenset[Part]]
    outline: Callable[[S, Task], tuple[int, dict[str, Any]]]
    label: str
    item: Literal["tour", "plan"] = "tour"
    mover: Literal["vehicle", "robot"] | None = None
    visits: Literal["tour", "stops"] = "tour"
    stops: Literal["stops", "places"] = "stops"
    on_grid: bool = False

    def load(self) -> Run[S]:
        """Import the function that plans it, and return that."""
        module, name = self.planner
        return getattr(import_module(module), name)
