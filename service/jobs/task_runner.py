"""Run a task in a worker process: from the Task to the JSON of its front."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from service.actor import load_actors
from service.actor_info import ActorInfo
from service.extensions.constructors import load_constructors
from service.extensions.names import NO_EXTENSIONS, Extensions
from service.extensions.searches import load_search
from service.front import SearchFunction
from service.jobs.compiled_code import warm_up
from service.kinds.front_document import FrontDocument
from service.kinds.kind import NamedActor, Report, Tools
from service.kinds.parts import Compiling, Part
from service.kinds.table import KINDS, kind_of
from service.requests.limits import Limits
from service.requests.parser import DEFAULT_ACTORS
from service.requests.task import Task
from service.roads.router import RouterSettings
from service.watch import Watch

if TYPE_CHECKING:
    from service.requests.road_measurer import BlockingMeasurer

# Loaded here, with all that plans: later, that would be within the time limit of a task.
_RUNS = {name: kind.load() for name, kind in KINDS.items()}


@dataclass(frozen=True)
class TaskRunner:
    """Plans fronts within limits, with the actors that are loaded.

    With a measurer, it asks for the costs by road of tasks that come without. With a search, it
    plans fronts with that in the place of Paretour's.
    """

    actors: Mapping[str, NamedActor]
    limits: Limits
    measurer: "BlockingMeasurer | None" = None
    search: SearchFunction | None = None

    def warm_up(self, parts: Collection[Part], tell: Callable[[Part | Compiling], None]) -> None:
        """Load parts of the code from the cache, open the networks, and compile the other parts."""
        warm_up(parts, tell, before_compiling=self._open_networks)

    @property
    def infos(self) -> Mapping[str, ActorInfo]:
        """The metadata of the actors by name."""
        return {name: actor.info for name, actor in self.actors.items()}

    def run(self, task: Task, stop: Callable[[], bool], report: Report) -> FrontDocument:
        """Return the front of a task. Its time limit begins once its network is open."""
        if task.actor in self.actors:
            self.actors[task.actor].load()
        task = self.measured(task, stop)
        tools = Tools(self.actors, self.limits, self.search)
        run, watch = _RUNS[kind_of(task).name], Watch(stop=stop, report=report)
        if not task.notes:
            return run(task.subject, task, tools, watch)

        def noted(document: FrontDocument) -> FrontDocument:
            return document.with_notes(task.notes)

        return noted(run(task.subject, task, tools, watch.converting(noted)))

    def measured(self, task: Task, stop: Callable[[], bool]) -> Task:
        """Return a task with its costs by road, where it lacks them and there is a measurer."""
        if self.measurer is None or not task.needs_roads:
            return task
        return self.measurer.measured(task, stop)

    def _open_networks(self) -> None:
        """Open all, those first that build the tours of most requests."""
        for name in (*DEFAULT_ACTORS.values(), *self.actors):
            if name in self.actors:
                self.actors[name].load()

    def terminate(self) -> None:
        """End the running call of a network, if one runs; from any thread."""
        for actor in self.actors.values():
            actor.terminate()


def load_runner(
    directory: Path,
    threads: int,
    limits: Limits,
    own_directory: Path | None = None,
    roads: RouterSettings | None = None,
    extensions: Extensions = NO_EXTENSIONS,
) -> TaskRunner:
    """Return a runner with the actors of a directory, of one of the user's, and of extensions.

    With a routing engine, it asks that for the costs by road of tasks that come without.

    Raises:
        ValueError: As of load_actors, load_constructors and load_search.
    """
    actors = load_actors(directory, threads, own_directory)
    constructors = load_constructors(extensions.constructors, actors)
    search = load_search(extensions.search)
    return TaskRunner({**actors, **constructors}, limits, _measurer(roads), search)


def _measurer(roads: RouterSettings | None) -> "BlockingMeasurer | None":
    if roads is None:
        return None
    from service.requests.road_measurer import BlockingMeasurer
    from service.roads.client import RoadClient  # imports a client of HTTP, which takes 0.2 s

    return BlockingMeasurer(RoadClient(roads))
