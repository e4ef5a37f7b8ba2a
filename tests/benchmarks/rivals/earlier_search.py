"""A program: plan fleets by the earlier search with PyVRP, in a checkout that still has it.

It reads requests of POST /fleet, one a line, and writes for each a line: the routes of its plans.
"""

import json
import sys

from service.fleet.pyvrp_search import PyvrpSearch

from service.fleet.fronts import FleetOptions
from service.requests.fleet import parse_fleet_request
from service.settings import Settings
from service.watch import Watch


def planned(line: str) -> list[list[list[int]]]:
    """Return the stops of each route of each plan that is found for a request."""
    limits = Settings(max_fleet_stops=10_000, max_body_bytes=2**28, max_time_limit=3600).limits
    request = parse_fleet_request(line.encode(), limits)
    options = FleetOptions(time_limit=request.time_limit, size=request.size)
    search = PyvrpSearch(request.subject().fleet(), options, Watch(request.time_limit))
    terminated = search.run()
    plans = search.front(options.size, terminated).plans if len(search) else ()
    return [[list(map(int, route.stops)) for route in plan.routes] for plan in plans]


if __name__ == "__main__":
    for each in sys.stdin:
        print(json.dumps(planned(each)), flush=True)
