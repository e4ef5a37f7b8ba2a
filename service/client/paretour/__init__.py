"""A client of the service, for programs that wait and for programs that await.

    from service.client import Client

    with Client("http://localhost:8000") as client:
        front = client.front(coordinates=cities, time_limit=2)
        tour = front.nearest(angle=30).tour

What is asked, and how an answer is read, is written once, in `calls` and `following`; the two
clients only carry it to and fro. Nothing else of the service is needed.
"""

from paretour.asynchronous import AsyncClient, AsyncJob
from paretour.errors import Refused
from paretour.requests import Plan, coverage_plan, front_plan
from paretour.sync import Client, Job
from paretour.values import Actor, CoverageRequest, Front, FrontRequest, Path, Progress, Tour

__all__ = [
    "Actor",
    "AsyncClient",
    "AsyncJob",
    "Client",
    "CoverageRequest",
    "Front",
    "FrontRequest",
    "Job",
    "Path",
    "Plan",
    "Progress",
    "Refused",
    "Tour",
    "coverage_plan",
    "front_plan",
]
