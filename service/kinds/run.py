"""Plan the front of a task of any kind. Workers import this, and with it everything that plans."""

from collections.abc import Mapping

from service.kinds.fleet import run_fleet
from service.kinds.kind import Run
from service.kinds.robots import run_robots
from service.kinds.tours import run_coverage, run_front
from service.requests.task import KindName

RUNS: Mapping[KindName, Run] = {
    "front": run_front,
    "coverage": run_coverage,
    "fleet": run_fleet,
    "robots": run_robots,
}
