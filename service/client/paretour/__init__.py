"""The Python client of Paretour.

    from paretour import Client

    with Client("http://localhost:8000") as client:
        front = client.front(coordinates=cities, time_limit=2)
        tour = front.choose(balance=0.3).tour

Without a service, and with the whole package, `plan` does the same in this process:

    import paretour

    front = paretour.plan(coordinates=cities, time_limit=2)

AsyncClient is the same as Client for asynchronous programs. Both send the requests of `calls` and
read the events of `events`. They only need the address of a service.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from paretour.choice import Choice
from paretour.errors import Refused
from paretour.expect import UnexpectedAnswer
from paretour.fronts import FleetObjective, Objective, RequestNote
from paretour.kinds import FrontOfAnyKind
from paretour.library import (
    InstanceFailed,
    offer_slots,
    plan,
    plan_coverage,
    plan_fleet,
    plan_many,
    plan_robots,
    replan,
)
from paretour.member_parts import ObjectiveRequest, RobotRequest, StopRequest
from paretour.members import (
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    OffersRequest,
    ReplanRequest,
    RobotsRequest,
)
from paretour.offers import Offer, OfferChoice, Offers
from paretour.plans import FleetFront, FleetPlan, FleetRoute, RobotFront, RobotPlan, RobotRoute
from paretour.remedies import Remedy
from paretour.requests import Plan, coverage_plan, fleet_plan, front_plan, replan_plan
from paretour.ros.maps import read_ros_map
from paretour.ros.paths import Path
from paretour.values import Actor, Front, Progress, Tour, Uncovered, UncoveredRegion

if TYPE_CHECKING:
    from paretour.asynchronous import AsyncClient, AsyncJob
    from paretour.listing import ListedFront
    from paretour.sync import Client, Job

__all__ = [
    "Actor",
    "AsyncClient",
    "AsyncJob",
    "Choice",
    "Client",
    "CoverageRequest",
    "FleetFront",
    "FleetObjective",
    "FleetPlan",
    "FleetRequest",
    "FleetRoute",
    "Front",
    "FrontOfAnyKind",
    "FrontRequest",
    "InstanceFailed",
    "Job",
    "ListedFront",
    "Objective",
    "ObjectiveRequest",
    "Offer",
    "OfferChoice",
    "Offers",
    "OffersRequest",
    "Path",
    "Plan",
    "Progress",
    "Refused",
    "Remedy",
    "ReplanRequest",
    "RequestNote",
    "RobotFront",
    "RobotPlan",
    "RobotRequest",
    "RobotRoute",
    "RobotsRequest",
    "StopRequest",
    "Tour",
    "Uncovered",
    "UncoveredRegion",
    "UnexpectedAnswer",
    "coverage_plan",
    "fleet_plan",
    "front_plan",
    "offer_slots",
    "plan",
    "plan_coverage",
    "plan_fleet",
    "plan_many",
    "plan_robots",
    "read_ros_map",
    "replan",
    "replan_plan",
]

# What needs httpx is imported once it is named: programs that only call `plan` start sooner.
_OF_CLIENTS = {
    "AsyncClient": "asynchronous",
    "AsyncJob": "asynchronous",
    "Client": "sync",
    "Job": "sync",
    "ListedFront": "listing",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        found: Any = _version()
    elif name in _OF_CLIENTS:
        found = getattr(import_module(f"paretour.{_OF_CLIENTS[name]}"), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("paretour-client")
    except PackageNotFoundError:  # it came with the whole of Paretour
        return version("paretour")
