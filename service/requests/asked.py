"""What work asks for, whichever path it came by."""

from collections.abc import Mapping

from service.actor import ActorFacts
from service.instance import Instance
from service.jobs.front_document import Rendered, empty
from service.jobs.messages import Work
from service.requests.coverage import parse_coverage_request
from service.requests.front import parse_front_request
from service.requests.roster import choose_actor
from service.requests.schemas import Limits
from service.requests.task import Task


def read(work: Work, limits: Limits, actors: Mapping[str, ActorFacts]) -> Task:
    """The task in a piece of work.

    Raises:
        Refusal: there is none, it is over a limit, or no actor serves it.
        InvalidInstance: it cannot be planned.
    """
    if work.kind == "coverage":
        covering = parse_coverage_request(work.body, limits, work.upload)
        return Task(
            subject=covering.coverage(),
            demand=covering.demand(),
            actor=choose_actor(actors, covering.kind, covering.named_actor),
            paths=covering.paths,
        )
    asked = parse_front_request(work.body, limits, work.upload)
    return Task(
        subject=asked.instance(),
        demand=asked.demand(),
        actor=choose_actor(actors, asked.kind, asked.named_actor),
    )


def nothing_yet(task: Task, actor: Mapping[str, str]) -> Rendered:
    """The front before anything is found."""
    subject, reference_point = task.subject, task.demand.reference_point
    if isinstance(subject, Instance):
        if reference_point is None:
            reference_point = subject.n * subject.scale
        known = {"cities": subject.n, "scale": subject.scale.tolist()}
    else:
        # What the places cost, and with a spacing which they are, is for a worker to find.
        places = [] if subject.places is None else subject.places.tolist()
        known = {"cities": len(places), "scale": None, "places": places}
    return empty(
        **known,
        reference_point=None if reference_point is None else reference_point.tolist(),
        actor=actor,
    )
