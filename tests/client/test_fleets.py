"""Both clients plan a fleet, and have its plans as values."""

import numpy as np
import pytest
from paretour import Refused

from tests.helpers.answers import Connect
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.straight_lines import seconds_between


def test_a_fleet_is_planned_and_its_plans_are_values(connect: Connect, url: str) -> None:
    client = connect(url)
    request = fleet_request()
    request["objectives"][1]["matrix"] = np.array(request["objectives"][1]["matrix"])
    front = client.fleet(**request)
    assert front.document["status"] == front.status == "done"
    assert [each.name for each in front.objectives] == ["distance", "time"]
    assert front.lengths.tolist() == [plan.lengths.tolist() for plan in front.plans]
    for plan, item in zip(front.plans, front.document["front"], strict=True):
        assert plan.unassigned == tuple(item["unassigned"])
        for route, each in zip(plan.routes, item["routes"], strict=True):
            assert (route.vehicle, list(route.stops)) == (each["vehicle"], each["stops"])
            assert route.arrivals.tolist() == each["arrivals"]
    with pytest.raises(ValueError, match="read-only"):
        front.lengths[0, 0] = 1


def test_a_job_of_a_fleet_gives_its_plans_and_is_found_by_its_id(
    connect: Connect, url: str
) -> None:
    client = connect(url)
    job = client.submit_fleet(**fleet_request())
    front = job.result()
    assert (front.id, front.status) == (job.id, "done")
    assert front.plans
    again = client.fleet_job(job.id)
    assert again.front().document == front.document
    assert again.cancel().document == front.document  # it has ended, so nothing is cancelled
    again.forget()
    with pytest.raises(Refused, match="there is no front"):
        again.front()


def test_one_plan_of_a_fleet_is_given_as_geojson(connect: Connect, url: str) -> None:
    client = connect(url)
    front = client.fleet(**fleet_request())
    last = len(front.plans) - 1
    lines = client.geojson(front.id, plan=last)["features"][: len(front.plans[last].routes)]
    assert [line["properties"]["plan"] for line in lines] == [last] * len(lines)
    assert [tuple(line["properties"]["stops"]) for line in lines] == [
        route.stops for route in front.plans[last].routes
    ]
    with pytest.raises(Refused, match="plan must be less than"):
        client.geojson(front.id, plan=last + 1)


def test_a_fleet_is_timed_along_straight_lines_at_a_speed(connect: Connect, url: str) -> None:
    places = {"depot": [24.94, 60.17], "a": [24.95, 60.18], "b": [24.93, 60.16]}
    front = connect(url).fleet(
        stops=[{"id": name, "location": place} for name, place in places.items()],
        vehicles=[{"id": "van", "start": "depot", "end": "depot"}],
        objectives=[
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "from": "great_circle", "speed": 30, "over": "max"},
        ],
        clock="time",
        time_limit=0.1,
    )
    assert [each.unit for each in front.objectives] == ["m", "s"]
    [route] = front.plans[0].routes
    first, second = route.stops[:2]
    way = seconds_between(places[first], places[second], 30)
    assert route.arrivals[1] - route.arrivals[0] == pytest.approx(way)
    with pytest.raises(Refused, match="objectives/1/speed needs from great_circle"):
        connect(url).front(
            stops=[{"id": name, "location": place} for name, place in places.items()],
            objectives=[
                {"name": "distance", "from": "great_circle"},
                {"name": "time", "from": "road_time", "speed": 30},
            ],
        )
