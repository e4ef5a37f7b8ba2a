"""Planning in this process, with no service."""

import json
from dataclasses import asdict

from paretour import Actor, Front, Plan
from paretour.values import front_of
from rich.console import Console

from service.actor import load_actors
from service.cli.configured import configured, loaded
from service.cli.errors import Wrong
from service.cli.progress import interruptible, watching
from service.errors import Refusal
from service.instance import InvalidInstance
from service.jobs.messages import Work
from service.jobs.runner import load_planner


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
            raise Wrong(str(error)) from None
    status = "cancelled" if stop() else "done"
    return front_of(json.loads(found.json(id="", status=status)))


def _work(plan: Plan) -> Work:
    upload = None if plan.file is None else plan.file.content
    return Work("coverage" if plan.path == "/coverage" else "front", plan.json, upload)


def actors_here() -> tuple[Actor, ...]:
    """The networks to choose from."""
    actors = loaded(lambda its: load_actors(its.actors, its.threads), configured())
    return tuple(Actor(**asdict(actor.facts)) for _, actor in sorted(actors.items()))
