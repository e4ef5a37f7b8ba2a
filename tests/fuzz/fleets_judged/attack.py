"""Plan random fleets, and compare each answer with the judge and with all plans."""

import json
import random
from collections import Counter
from collections.abc import Iterator
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
from tests.fuzz.fleets_judged.judge import Judge
from tests.fuzz.fleets_judged.requests import random_fleet, with_bounds_at_arrivals
from tests.fuzz.fleets_judged.timeline import Json

LIMITS = Limits(body_bytes=10**6, cities=50, cells=900, preferences=20, size=1000, seconds=60)
ENOUGH = 20.0  # seconds: a fleet of this size is enumerated in much less
SEARCHED = 0.1  # seconds of search where there are too many vehicles to try all plans
ENUMERATED = 6  # stops to visit, and vehicles
NEAR = 1e-6
PATIENT = 3.0  # seconds for one that is refused, before it is a fault


@dataclass
class Outcome:
    """What came of many fleets."""

    counts: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


def judge_many(count: int, seed: int) -> Outcome:
    """Plan and judge fleets: half of them as they are drawn, half with bounds at arrivals."""
    outcome = Outcome()
    for number in range((count + 1) // 2):
        rng = random.Random(f"judged {seed} {number}")
        request = random_fleet(rng)
        answer = _judged(request, outcome, f"{seed} {number}")
        if answer is not None and request.get("clock") is not None:
            plan = rng.choice(answer["front"])
            if plan["routes"]:
                request = with_bounds_at_arrivals(rng, request, plan)
                _judged(request, outcome, f"{seed} {number} bounded")
                continue
        _judged(random_fleet(rng), outcome, f"{seed} {number} again")
    return outcome


def _judged(request: Json, outcome: Outcome, name: str) -> Json | None:
    """Plan a fleet and add what came of it; return the answer."""
    judge = Judge(request)
    most = sum(min(each.get("count", 1), len(judge.clients)) for each in judge.vehicles)
    many = len(judge.clients) > ENUMERATED
    searched = many or most > ENUMERATED
    request = {**request, "time_limit": SEARCHED if searched else ENOUGH, "size": 1000}
    answer = answer_to(request)
    kind = "searched" if searched else "enumerated"
    if isinstance(answer, Refusal) and answer.code != "no-plan" and not isinstance(answer, NoTour):
        outcome.counts[answer.code] += 1
        return None
    points = [] if many else exact_points(judge)
    if isinstance(answer, Refusal) and points:
        outcome.counts[f"{kind}, tried again"] += 1
        answer = answer_to({**request, "time_limit": PATIENT})
    if isinstance(answer, Refusal):
        outcome.counts[f"{kind}, refused"] += 1
        if points:
            _add(outcome, name, request, f"refused, and there are plans: {points[0]}: {answer}")
        return None
    outcome.counts[kind] += 1
    for fault in _faults(judge, answer, points, kind, outcome):
        _add(outcome, name, request, fault)
    return answer


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
