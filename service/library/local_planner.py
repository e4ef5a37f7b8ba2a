"""Plan a request in this process, and answer as the service does.

The garbage collector waits while this module imports what plans.
"""

from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, cast

from paretour import FrontOfAnyKind, Plan, Progress, Refused
from paretour.bars import Display
from paretour.expect import members
from paretour.kinds import parse_any
from paretour.offers import Offers
from paretour.offers import parse_offers as read_offers
from pydantic_core import from_json

from service.jobs.uncollected import uncollected

with uncollected():
    from service.errors import Cancelled, Refusal
    from service.jobs.compiled_code import is_loaded, load_from_cache, warm_up
    from service.jobs.task_runner import TaskRunner, load_runner
    from service.kinds.front_document import FrontDocument
    from service.kinds.offers import answer_offers, parse_offers
    from service.kinds.parsing import parse_replan, parse_task
    from service.kinds.parts import Compiling, Part
    from service.kinds.table import parts_of
    from service.library.interrupts import interrupt_flag, until_done
    from service.requests.replan.way import ReplanSource, StoredFront
    from service.requests.task import Task, TaskKind, TaskSource
    from service.requests.task_codec import encode_task
    from service.settings import Settings


@dataclass(frozen=True)
class Planned:
    """A planned task, its front as a document, and whether Ctrl-C ended it."""

    task: Task
    document: FrontDocument
    interrupted: bool

    @property
    def answer(self) -> bytes:
        """The answer as JSON. No service has stored the front, so it has no id."""
        return self.document.json(id="", status="cancelled" if self.interrupted else "done")

    def front(self) -> FrontOfAnyKind:
        """Return the front as the client does."""
        return parse_any(from_json(self.answer))


@dataclass(frozen=True)
class LocalPlanner:
    """Plans in this process, one task after another, with the actors and limits of the settings."""

    runner: TaskRunner

    def plan(self, plan: Plan, display: Display) -> Planned:
        """Plan what a request asks for. Ctrl-C ends the search with the best front so far.

        Raises:
            Refused: The request cannot be planned, as the service would refuse it.
            KeyboardInterrupt: Ctrl-C was pressed before there was a front.
        """
        upload = None if plan.file is None else plan.file.content
        source = TaskSource(cast(TaskKind, plan.path.removeprefix("/")), plan.json, upload)
        parse = partial(parse_task, source, self.runner.limits, self.runner.infos)
        return self._planned(parse, plan, display)

    def replan(self, plan: Plan, earlier: Planned, display: Display) -> Planned:
        """Plan the rest of what was planned before, in the same way; raises as `plan` does."""
        stored = StoredFront("", encode_task(earlier.task), earlier.document)
        source = ReplanSource(plan.json, stored)
        parse = partial(parse_replan, source, self.runner.limits, self.runner.infos)
        return self._planned(parse, plan, display)

    def offers(self, plan: Plan, earlier: Planned) -> Offers:
        """Return the offers of an order beside what was planned before.

        Raises:
            Refused: The request is not valid, or the front is not of a fleet.
        """
        stored = StoredFront("", encode_task(earlier.task), earlier.document)
        runner = self.runner
        try:
            asked = parse_offers(ReplanSource(plan.json, stored), runner.limits, runner.infos)
            asked = replace(asked, task=runner.measured(asked.task, lambda: False))
            answer = answer_offers(asked, runner.limits, runner.infos)
        except Refusal as error:
            raise Refused(error.document("")) from None
        return read_offers(members(from_json(answer), "answer"))

    def _planned(self, parse: Callable[[], Task], plan: Plan, display: Display) -> Planned:
        try:
            task = parse()
            self._load_all(task, display)
            with interrupt_flag() as interrupted, display.planning(plan.seconds) as show:
                run = partial(
                    self.runner.run,
                    task,
                    interrupted,
                    lambda found, _: show(Progress(**asdict(found))),
                )
                document = until_done(run, interrupted, self.runner.terminate)
        except Cancelled:
            raise KeyboardInterrupt from None
        except Refusal as error:
            raise Refused(error.document("")) from None
        return Planned(task, document, interrupted())

    def _load_all(self, task: Task, display: Display) -> None:
        """Load what a task needs before the clock of its time limit starts.

        Its network is opened meanwhile, which holds no lock of Python.
        """
        actor = self.runner.actors.get(task.actor or "")
        if missing := [part for part in parts_of(task) if not is_loaded(part)]:
            with ThreadPoolExecutor(1) as threads:
                if actor is not None:
                    threads.submit(actor.load)
                if missing := [part for part in missing if not load_from_cache(part)]:
                    self._load(missing, display)
        if actor is not None:
            actor.load()

    def _load(self, missing: Collection[Part], display: Display) -> None:
        """Compile parts of the code, and show how far that is."""
        with display.loading() as say:

            def tell(told: Part | Compiling) -> None:
                if isinstance(told, Compiling):
                    say(str(told))

            warm_up(missing, tell)


def load_default_planner() -> LocalPlanner:
    """Return the planner with the settings of the environment.

    Raises:
        ValueError: A setting is wrong, or as of load_runner.
    """
    given: dict[str, Any] = {}  # by the program: nothing
    return load_planner(Settings(**given))


def load_planner(settings: Settings) -> LocalPlanner:
    """Return the planner with the actors, the limits and the routing engine of the settings.

    Raises:
        ValueError: As of load_runner.
    """
    runner = load_runner(
        settings.actors,
        settings.threads,
        settings.limits,
        settings.own_actors,
        settings.roads,
        settings.extensions,
    )
    return LocalPlanner(runner)
