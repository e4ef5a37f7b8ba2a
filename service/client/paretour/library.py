"""Plan without a service: in this process, or many fronts in several processes of its own.

That needs the whole package, not the client alone. What plans is imported by the first call, as it
takes seconds and loads a compiler.
"""

from collections.abc import Iterable, Mapping
from concurrent.futures import as_completed
from contextlib import nullcontext
from functools import cache
from importlib import import_module
from typing import Any, Unpack, cast, overload
from weakref import WeakKeyDictionary

from paretour.bars import Bars, Display, Silent, bar_class
from paretour.explaining import explaining
from paretour.kinds import FrontOfAnyKind
from paretour.members import (
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    OffersRequest,
    ReplanFleetRequest,
    ReplanRequest,
    RobotsRequest,
)
from paretour.offers import Offers
from paretour.plans import FleetFront, RobotFront
from paretour.requests import (
    Instance,
    Plan,
    coverage_plan,
    fleet_plan,
    front_plan,
    offers_plan,
    replan_plan,
)
from paretour.values import Front

_planned: WeakKeyDictionary[FrontOfAnyKind, Any] = WeakKeyDictionary()  # what `replan` starts from


@explaining(FrontRequest)
def plan(
    instance: Instance | None = None,
    /,
    *,
    progress: bool = False,
    **request: Unpack[FrontRequest],
) -> Front:
    """Plan a front in this process, as `Client.front` has a service do. Ctrl-C ends it early.

    Args:
        instance: Coordinates, matrices or stops, unless they are among the members.
        progress: Whether to show a bar, which needs tqdm.
        **request: The members of the request, as of `Client.front`.

    Returns:
        The front; after Ctrl-C the best so far.

    Raises:
        Refused: The request cannot be planned.
        ModuleNotFoundError: Only the client is installed, or tqdm is not.
    """
    return cast(Front, _run(front_plan(request, instance), progress))


@explaining(CoverageRequest)
def plan_coverage(
    png: bytes | None = None, *, progress: bool = False, **request: Unpack[CoverageRequest]
) -> Front:
    """Plan a front over a map in this process, as `Client.coverage` and `plan` do."""
    return cast(Front, _run(coverage_plan(request, png), progress))


@explaining(FleetRequest)
def plan_fleet(*, progress: bool = False, **request: Unpack[FleetRequest]) -> FleetFront:
    """Plan a front of plans for a fleet in this process, as `Client.fleet` and `plan` do."""
    return cast(FleetFront, _run(fleet_plan(request), progress))


@explaining(RobotsRequest)
def plan_robots(
    png: bytes | None = None, *, progress: bool = False, **request: Unpack[RobotsRequest]
) -> RobotFront:
    """Plan for several robots on a map in this process, as `Client.robots` and `plan` do."""
    return cast(RobotFront, _run(coverage_plan(request, png), progress))


@overload
def replan(front: Front, *, progress: bool = False, **request: Unpack[ReplanRequest]) -> Front: ...
@overload
def replan(
    front: FleetFront, *, progress: bool = False, **request: Unpack[ReplanFleetRequest]
) -> FleetFront: ...
@explaining(ReplanRequest, ReplanFleetRequest)
def replan(front: Front | FleetFront, *, progress: bool = False, **request: Any) -> Any:
    """Plan the rest of a front that was planned in this process, as `Client.replan` does.

    Args:
        front: The front.
        progress: Whether to show a bar, as `plan` does.
        **request: What has changed, and the options of the new front.

    Raises:
        ValueError: The front was not planned in this process.
        Refused: The front cannot be replanned so.
    """
    earlier = _planned_here(front)
    return _run(replan_plan(front, cast(ReplanRequest, request)), progress, earlier)


def _planned_here(front: FrontOfAnyKind) -> Any:
    """Return what was planned in this process."""
    if front not in _planned:
        raise ValueError("front must be one that was planned in this process")
    return _planned[front]


@explaining(OffersRequest)
def offer_slots(front: FleetFront, **request: Unpack[OffersRequest]) -> Offers:
    """Return the offers of an order beside a plan of this process, as `Client.offers` does.

    Args:
        front: A front that `plan_fleet` or `replan` returned.
        **request: The order, the slots, and what has changed.

    Raises:
        ValueError: The front was not planned in this process.
        Refused: The request is not valid.
    """
    earlier = _planned_here(front)
    return _planner().offers(offers_plan(front, request), earlier)


class InstanceFailed(Exception):
    """One of many instances could not be planned. Its cause is what `plan` raises for it.

    Attributes:
        index: The number of the instance, from 0.
    """

    def __init__(self, index: int, reason: str) -> None:
        super().__init__(index, reason)
        self.index = index
        self.reason = reason

    def __str__(self) -> str:
        return f"instance {self.index}: {self.reason}"


def plan_many(
    instances: Iterable[FrontRequest | Instance],
    *,
    workers: int | None = None,
    progress: bool = False,
    **options: Unpack[FrontRequest],
) -> list[Front]:
    """Plan a front of each instance in several processes, and return them in order.

    Args:
        instances: Coordinates, matrices or stops of each, or the members of its request, as of
            `plan`.
        workers: The number of processes; by default one for each processor.
        progress: Whether to show a bar, which needs tqdm.
        **options: Members of all requests that lack them, as `time_limit`.

    Raises:
        InstanceFailed: An instance cannot be planned; the others are given up.
        KeyboardInterrupt: Ctrl-C was pressed; all are given up.
        ModuleNotFoundError: Only the client is installed, or tqdm is not.
    """
    instances = list(instances)
    fronts: list[Any] = [None] * len(instances)
    bars: Any = bar_class()(total=len(instances), desc="planning") if progress else nullcontext()
    crews = whole_package("service.library.crew")
    with crews.Crew(workers, len(instances)) as crew, bars as bar:

        def run(instance: FrontRequest | Instance) -> Any:
            return crew.run(_plan_of(instance, options))

        numbers = {crew.submit(run, each): index for index, each in enumerate(instances)}
        for future in as_completed(numbers):
            index = numbers.pop(future)
            try:
                fronts[index] = crews.front_of(future.result())
            except Exception as error:
                raise InstanceFailed(index, str(error)) from error
            if bar is not None:
                bar.update()
    return fronts


def _plan_of(instance: FrontRequest | Instance, options: FrontRequest) -> Plan:
    """Return the request that plans one of many instances."""
    if isinstance(instance, Mapping):
        return front_plan(cast(FrontRequest, {**options, **instance}))
    return front_plan(options, instance)


def _run(plan: Plan, progress: bool, earlier: Any = None) -> FrontOfAnyKind:
    display: Display = Bars() if progress else Silent()
    planner = _planner()
    if earlier is None:
        planned = planner.plan(plan, display)
    else:
        planned = planner.replan(plan, earlier, display)
    front: FrontOfAnyKind = planned.front()
    _planned[front] = planned
    return front


@cache
def _planner() -> Any:
    return whole_package("service.library.local_planner").load_default_planner()


def whole_package(module: str) -> Any:
    """Return a module of the whole package.

    Raises:
        ModuleNotFoundError: Only the client is installed.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or not module.startswith(error.name):
            raise
        raise ModuleNotFoundError(
            "only the client of Paretour is installed; to plan in this process, install the whole "
            "package: pip install paretour",
            name=error.name,
        ) from None
