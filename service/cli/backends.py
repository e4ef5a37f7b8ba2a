"""Who plans for the command: this process, or a service at a URL."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol, cast

from paretour import (
    Actor,
    Client,
    CoverageRequest,
    Front,
    FrontRequest,
    Plan,
    coverage_plan,
    front_plan,
)
from paretour.values import parse_front
from rich.console import Console

from service.actor import load_actors
from service.cli.errors import UsageError, configured, loaded
from service.cli.files import read_layer, read_map, read_request
from service.cli.progress import interruptible, watching
from service.errors import InvalidInstance, Refusal
from service.jobs.runner import load_planner
from service.requests.task import Work


def plan_there(client: Client, plan: Plan, stderr: Console) -> Front:
    """The front that the service finds, or had found when Ctrl-C was pressed."""
    job = client.post(plan)
    try:
        with watching(stderr, plan) as tell:
            for progress in job.progress():
                tell(progress)
        return job.result()
    except KeyboardInterrupt:
        found = job.cancel()
        if not len(found.tours):
            raise
        return found


def plan_here(plan: Plan, stderr: Console) -> Front:
    """The front, as the service would answer it, or what was found when Ctrl-C was pressed."""
    planner = loaded(lambda its: load_planner(its.actors, its.threads, its.limits), configured())
    if plan.seconds != 0:
        with stderr.status("loading the search; the first time it is compiled, for half a minute"):
            planner.warm_up()
    with interruptible() as stop, watching(stderr, plan) as tell:
        try:
            found = planner.plan(_work(plan), stop, tell)
        except (Refusal, InvalidInstance) as error:
            raise UsageError(str(error)) from None
    status = "cancelled" if stop() else "done"
    return parse_front(json.loads(found.json(id="", status=status)))


def _work(plan: Plan) -> Work:
    upload = None if plan.file is None else plan.file.content
    return Work("coverage" if plan.path == "/coverage" else "front", plan.json, upload)


def actors_here() -> tuple[Actor, ...]:
    """The networks to choose from."""
    actors = loaded(lambda its: load_actors(its.actors, its.threads), configured())
    return tuple(Actor(**asdict(actor.facts)) for _, actor in sorted(actors.items()))


Options = Mapping[str, Any]


class Asked(Protocol):
    """What files and options ask for together."""

    def plan(self) -> Plan:
        """What is to be planned.

        Raises:
            UnreadableFile: a file is nothing that can be planned.
            OSError: there is no such file.
            UsageError: an option says nothing.
        """


@dataclass(frozen=True, kw_only=True)
class Cities:
    """Cities in a file, or one for each objective; options that are None leave it to the file."""

    file: Path
    file2: Path | None
    unrounded: bool
    angles: str | None = None
    options: Options

    def plan(self) -> Plan:
        """The cities' front."""
        files = [self.file] if self.file2 is None else [self.file, self.file2]
        read = read_request(files, unrounded=self.unrounded)
        given = {**self.options, "preferences": self._angles()}
        return front_plan(cast(FrontRequest, {**read, **_without_none(given)}))

    def _angles(self) -> list[float] | None:
        try:
            return None if self.angles is None else [float(a) for a in self.angles.split(",")]
        except ValueError:
            sentence = f"--angles must be numbers with commas between, got {self.angles!r}"
            raise UsageError(sentence) from None


@dataclass(frozen=True, kw_only=True)
class Map:
    """A map in a file, costs on it in another; options that are None leave it to the file."""

    file: Path
    cost_layer: Path | None
    options: Options

    def plan(self) -> Plan:
        """The front of places on the map."""
        read, png = read_map(self.file)
        layer = None if self.cost_layer is None else read_layer(self.cost_layer)
        given = _without_none({**self.options, "cost_layer": layer})
        return coverage_plan(cast(CoverageRequest, {**read, **given}), png)


def _without_none(options: Options) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}


@dataclass(frozen=True)
class Planner:
    """The service at a URL, or this process.

    What plans in this process is imported where it does, as it takes a second and the compiler.
    """

    url: str | None
    api_key: str | None

    def front(self, plan: Plan, stderr: Console) -> Front:
        """The front that is to be planned."""
        if self.url is not None:
            with Client(self.url, api_key=self.api_key) as client:
                return plan_there(client, plan, stderr)
        from service.cli.backends import plan_here

        return plan_here(plan, stderr)

    def actors(self) -> tuple[Actor, ...]:
        """The networks to choose from."""
        if self.url is not None:
            with Client(self.url, api_key=self.api_key) as client:
                return client.actors()
        from service.cli.backends import actors_here

        return actors_here()
