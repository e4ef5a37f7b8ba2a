"""Plan random fleets, and compare each answer with the judge and with all plans."""

import itertools
import json
import random
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from math import inf
from typing import Any

from service.errors import NoTour, Refusal
from service.kinds.fleet import run_fleet
from service.kinds.kind import Tools
from service.kinds.parsing import parse_task
from service.requests.limits import Limits
from service.requests.task import TaskSource
from service.watch import Watch
from tests.fuzz.fleets_judged.all_plans import Point, exact_points
from tests.fuzz.fleets_judged.features import features_of
from tests.fuzz.fleets_judged.judge import Judge, Open
from tests.fuzz.fleets_judged.offers import offers_faults, orders_of
from tests.fuzz.fleets_judged.requests import random_fleet, with_bounds_at_arrivals
from tests.fuzz.fleets_judged.timeline import Json

LIMITS = Limits(body_bytes=10**6, cities=50, cells=900, preferences=20, size=1000, seconds=60)
ENOUGH = 20.0  # seconds: a fleet of this size is enumerated in much less
SEARCHED = 0.1  # seconds of search where there are too many vehicles to try all plans
ENUMERATED = 6  # stops to visit, and vehicles
NEAR = 1e-6
OFFERED = 0.3  # share of fleets beside whose plans an order is offered
PATIENT = 3.0  # seconds for one that is refused, before it is a fault


@dataclass
class Outcome:
    """What came of many fleets.

    Attributes:
        counts: How many had each end.
        tried: How many with each feature were judged whose plans the judge has all tried.
        faults: What was wrong.
    """

    counts: Counter[str] = field(default_factory=Counter)
    tried: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


def judge_many(count: int, seed: int) -> Outcome:
    """Plan and judge fleets: half of them as they are drawn, half with bounds at arrivals."""
    outcome = Outcome()
    for number in range((count + 1) // 2):
        rng = random.Random(f"judged {seed} {number}")
        _judge_two(rng, random_fleet(rng), outcome, f"{seed} {number}")
    return outcome


def judge_each(names: Collection[str], count: int, seed: int) -> Outcome:
    """Plan and judge fleets until some features were tried so often.

    Fleets are skipped that have none of what is lacking, or too many vehicles to try all plans.
    """
    outcome = Outcome()
    for number in itertools.count():
        lacking = {name for name in names if outcome.tried[name] < count}
        if not lacking:
            return outcome
        rng = random.Random(f"judged {seed} {number}")
        request = random_fleet(rng)
        if lacking & features_of(request) and not _is_searched(Judge(request)):
            _judge_two(rng, request, outcome, f"{seed} {number}")
    raise AssertionError("numbers do not end")


def _judge_two(rng: random.Random, request: Json, outcome: Outcome, name: str) -> None:
    """Plan and judge a fleet as it is, and then with bounds at arrivals of a plan, or another."""
    answer = _attempt(request, outcome, name)
    if answer is not None and request.get("clock") is not None:
        plan = rng.choice(answer["front"])
        if plan["routes"]:
            request = with_bounds_at_arrivals(rng, request, plan)
            _attempt(request, outcome, f"{name} bounded")
            return
    _attempt(random_fleet(rng), outcome, f"{name} again")


def _attempt(request: Json, outcome: Outcome, name: str) -> Json | None:
    """Plan and judge a fleet, unless the guide leaves open when its routes are driven."""
    try:
        return _judged(request, outcome, name)
    except Open:
        outcome.counts["left open"] += 1
        return None


def _judged(request: Json, outcome: Outcome, name: str) -> Json | None:
    """Plan a fleet and add what came of it; return the answer."""
    judge = Judge(request)
    searched = _is_searched(judge)
    points = exact_points(judge) if len(judge.clients) <= ENUMERATED else []
    # Where there is no plan, other requests are tried for as long, to say what would help.
    seconds = SEARCHED if searched or not points else ENOUGH
    request = {**request, "time_limit": seconds, "size": 1000}
    answer = answer_to(request)
    kind = "searched" if searched else "enumerated"
    if isinstance(answer, Refusal) and answer.code != "no-plan" and not isinstance(answer, NoTour):
        outcome.counts[answer.code] += 1
        return None
    if isinstance(answer, Refusal) and points:
        outcome.counts[f"{kind}, tried again"] += 1
        answer = answer_to({**request, "time_limit": PATIENT})
    if isinstance(answer, Refusal):
        outcome.counts[f"{kind}, refused"] += 1
        if points:
            _add(outcome, name, request, f"refused, and there are plans: {points[0]}: {answer}")
        return None
    outcome.counts[kind] += 1
    outcome.tried.update(features_of(request) if kind == "enumerated" else ())
    for fault in _faults(judge, answer, points, kind, outcome):
        _add(outcome, name, request, fault)
    rng = random.Random(f"offers {name}")
    if kind == "enumerated" and orders_of(request) and rng.random() < OFFERED:
        faults = offers_faults(rng, request, rng.choice(answer["front"]), LIMITS)
        outcome.tried["offers"] += faults is not None
        for fault in faults or ():
            _add(outcome, name, request, fault)
    return answer


def _is_searched(judge: Judge) -> bool:
    """Return whether a fleet has too many stops or vehicles for the service to try all plans."""
    most = sum(min(each.get("count", 1), len(judge.clients)) for each in judge.vehicles)
    return max(most, len(judge.clients)) > ENUMERATED


def _faults(
    judge: Judge, answer: Json, points: list[Point], kind: str, outcome: Outcome
) -> Iterator[str]:
    """Yield what is wrong with an answer; a search may find fewer points than there are."""
    for plan in answer["front"]:
        yield from judge.faults(plan)
    missing = _missing(points, [tuple(plan["lengths"]) for plan in answer["front"]])
    # A process that is held up for ten seconds searches instead.
    if kind == "enumerated" and answer["terminated"] == "converged" and missing:
        yield f"the front lacks {missing}"
    outcome.counts[f"{kind}, all of the front"] += bool(points) and not missing


def answer_to(request: Json) -> Any:
    """Return the answer to a request as JSON, or the refusal."""
    try:
        task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
        document = run_fleet(task.subject, task, Tools({}, LIMITS), Watch())
    except Refusal as refusal:
        return refusal
    return json.loads(document.json(id="", status="done"))


def _missing(points: list[Point], found: list[Point]) -> list[Point]:
    """Return the points that no plan found is as good as."""

    def reaches(one: Point, other: Point) -> bool:
        pairs = zip(one, other, strict=True)
        return all(x <= y + NEAR * max(1.0, abs(y)) and x < inf for x, y in pairs)

    return [point for point in points if not any(reaches(each, point) for each in found)]


def _add(outcome: Outcome, name: str, request: Json, fault: str) -> None:
    outcome.counts["FAULTS"] += 1
    outcome.faults.append(f"{name}: {fault}\n{json.dumps(request)}")
