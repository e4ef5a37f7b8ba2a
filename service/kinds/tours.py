"""Plan fronts of tours: through stops or cities, or through the places of a map."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import Coverage
from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey, survey
from service.errors import Cancelled, InvalidCoverage, NoTour
from service.front import Front, PlanOptions
from service.instance import Instance, step_lengths, tour_steps
from service.kinds.detours import PlanWithDetours
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Tools
from service.kinds.map_day import day_on_map
from service.kinds.tour_document import encode_front
from service.over_the_day.day import Day
from service.over_the_day.plan import plan_over_the_day
from service.planner import plan
from service.reliability.plan import plan_reliably
from service.replanning.replan import replan
from service.requests.limits import Limits, within_network
from service.requests.parser import check_instance
from service.requests.replan.rest_of_map import about_request
from service.requests.stops import Stops
from service.requests.task import Task
from service.watch import Watch


def run_front(stops: Stops, task: Task, tools: Tools, watch: Watch[FrontDocument]) -> FrontDocument:
    """Return the front of a task; see `Run`."""
    began = watch.spent
    instance, timings = stops.instance, {}
    if task.timings or not stops.measured:  # else it was checked when it came
        check_instance(task, instance)
        timings = {**task.timings, "costs": 1000 * (watch.spent - began)}
    front = _plan(task, instance, tools, watch, day=stops.day)
    if timings:
        front = replace(front, timings={**timings, **front.timings})
    return encode_front(
        front,
        tools.actors[task.actor].info.identity,
        labels=task.labels,
        arrivals=_arrivals(task, instance, front),
    )


def run_coverage(
    coverage: Coverage, task: Task, tools: Tools, watch: Watch[FrontDocument]
) -> FrontDocument:
    """Return the front of a task; see `Run`."""
    limits = tools.limits
    began = watch.spent
    surveyed = survey_map(coverage, task, limits, watch.stopped)
    day = day_on_map(coverage.hours, surveyed.instance)
    instance = surveyed.instance if day is None else day.instance
    check_instance(task, instance)
    surveyed_at = watch.spent
    options = within_network(task.options, instance.n, limits)
    task = replace(task, options=replace(options, start=surveyed.start))
    front = _plan(task, instance, tools, watch, surveyed, day=day)
    planned_at = watch.spent
    paths = None
    if task.paths:
        traced = surveyed.paths(front.tours, limits.path_cells, watch.stopped, front.leg_paths)
        paths = unless_cancelled(traced)
    timings = {
        "survey": 1000 * (surveyed_at - began),
        **front.timings,
        "paths": 1000 * (watch.spent - planned_at),
    }
    return encode_front(
        replace(front, timings=timings),
        tools.actors[task.actor].info.identity,
        surveyed,
        paths,
        arrivals=_arrivals_on_map(task, surveyed, front),
    )


def survey_map(coverage: Coverage, task: Task, limits: Limits, stop: Callable[[], bool]) -> Survey:
    """Return the survey of the map of a task.

    Raises:
        InvalidCoverage: A place cannot be visited, or there are too many.
        Refusal: It takes too long.
        Cancelled: `stop` returned True.
    """
    try:
        most = limits.most_places(shared=False)
        return survey(coverage, most, stop, seconds_to_survey(task, limits))
    except InvalidCoverage as refusal:
        if not task.parts:
            raise
        raise about_request(refusal, task.parts) from None


def seconds_to_survey(task: Task, limits: Limits) -> float:
    """Return how long a survey may take: who asks for a longer search waits as long for it."""
    return max(limits.survey_seconds, task.options.time_limit)


def _plan(
    task: Task,
    instance: Instance,
    tools: Tools,
    watch: Watch[FrontDocument],
    surveyed: Survey | None = None,
    *,
    day: Day | None,
) -> Front:
    """Plan or replan the front of a task.

    Args:
        instance: The costs; over the day the mean ones.
        surveyed: The map, if it has one.
        day: The costs over the day, if they depend on the time.
    """
    actor, options = tools.actors[task.actor], task.options

    def encoded(front: Front) -> FrontDocument:
        return encode_front(front, actor.info.identity, surveyed, labels=task.labels)

    of_fronts = watch.converting(encoded)

    planned = partial(_planned, task, tools)
    try:
        if day is not None:
            under_means = partial(planned, instance)
            return plan_over_the_day(under_means, day, options, task.earlier, of_fronts)
        if surveyed is not None and surveyed.legs.further is not None:
            legs = surveyed.legs
            planning = PlanWithDetours(legs, options, task.earlier, of_fronts)
            return planning.run(planned)
        if task.stops is not None and task.stops.spreads:
            return plan_reliably(planned, instance, task.stops.spreads, options, of_fronts)
        return planned(instance, options, of_fronts)
    except NoTour as refusal:
        raise refusal.named(task.city_names) from None


def _planned(
    task: Task, tools: Tools, instance: Instance, options: PlanOptions, watch: Watch[Front]
) -> Front:
    """Plan or replan the front of an instance, whose costs are certain and the same all day."""
    actor = tools.actors[task.actor]
    if task.earlier is not None:
        return replan(actor, instance, task.earlier, options, watch)
    if tools.search is not None:
        return plan(actor, instance, options, watch, tools.search)
    return plan(actor, instance, options, watch)


def cumulated_lengths(instance: Instance, tours: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return all lengths of tours, shape (k, n), from their first city up to each.

    Shape (k, n + 1, m) for closed tours, with the return, and (k, n, m) for open routes. O(k n).
    """
    return _cumulated(step_lengths(instance, *tour_steps(instance, tours)))


def _cumulated(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pad(steps.cumsum(axis=1), ((0, 0), (1, 0), (0, 0)))


def _arrivals(task: Task, instance: Instance, front: Front) -> NDArray[np.float64] | None:
    """Return all lengths of each tour up to each of its stops, if the task asks for them."""
    if task.arrivals and front.reached is not None:
        return front.reached if front.closed else front.reached[:, :-1]
    return cumulated_lengths(instance, front.tours) if task.arrivals else None


def _arrivals_on_map(task: Task, surveyed: Survey, front: Front) -> NDArray[np.float64] | None:
    """Return the same on a map, where each leg takes its own path."""
    if not task.arrivals or front.reached is not None:
        return _arrivals(task, surveyed.instance, front)
    legs = tour_steps(surveyed.instance, front.tours)
    return _cumulated(surveyed.legs.lengths(legs, front.leg_paths))


def unless_cancelled(paths: Iterable[CoveragePath]) -> list[CoveragePath] | None:
    """Return all paths; None if the task is cancelled before."""
    try:
        return list(paths)
    except Cancelled:
        return None
