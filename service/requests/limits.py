"""The most that a request may bring or ask for, and the refusals of more."""

from dataclasses import dataclass
from typing import TypeVar

from service.errors import Refusal
from service.requests.schemas import FrontRequest, PlanRequest
from service.requests.validation import invalid

Request = TypeVar("Request", bound=PlanRequest)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """The most that a request may bring or ask for."""

    body_bytes: int
    cities: int
    cells: int
    preferences: int
    size: int
    seconds: float


def within(limits: Limits, request: Request, n: int) -> Request:
    """The request, about n cities, with defaults within the limits.

    Raises:
        Refusal: it is over a limit.
    """
    _check_limits(request, n, limits)
    defaults = defaults_within(limits).items()
    asked = request.model_fields_set
    lowered = {k: v for k, v in defaults if k not in asked and v < getattr(request, k)}
    return request.model_copy(update=lowered) if lowered else request


def defaults_within(limits: Limits) -> dict[str, float]:
    """The defaults that a limit may lower: who asks for nothing is never over a limit."""
    most = {
        "preferences": limits.preferences,
        "size": limits.size,
        "time_limit": limits.seconds,
    }
    fields = FrontRequest.model_fields
    return {name: min(fields[name].default, limit) for name, limit in most.items()}


def _check_limits(request: PlanRequest, n: int, limits: Limits) -> None:
    if request.start >= n:
        raise invalid("start", f"must be a city, 0 to {n - 1}, got {request.start}")
    if "preferences" in request.model_fields_set:
        looked = request.preferences
        k = looked if isinstance(looked, int) else len(looked)
        _check_most("preferences", limits.preferences, k)
    if "size" in request.model_fields_set:
        _check_most("size", limits.size, request.size)
    if "time_limit" in request.model_fields_set:
        _check_most("time_limit", limits.seconds, request.time_limit)
    _check_most("initial_tours", limits.size, len(request.initial_tours))
    for index, tour in enumerate(request.initial_tours):
        if sorted(tour) != list(range(n)):
            demand = f"must visit each city, 0 to {n - 1}, once"
            raise invalid(f"initial_tours/{index}", demand)


def _check_most(name: str, limit: float, actual: float) -> None:
    if actual > limit:
        raise Refusal("over-limit", name=name, pointer=f"/{name}", limit=limit, actual=actual)
