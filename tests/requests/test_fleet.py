"""Requests of POST /fleet: what they mean, and what is refused."""

import copy
import json
from dataclasses import replace
from math import inf
from typing import Any

import pytest

from service.errors import Refusal
from service.fleet.vehicles import ALWAYS, Shipment, VehicleType, Visit
from service.kinds.parsing import parse_task
from service.requests.fleet import FleetRequest, parse_fleet_request
from service.requests.json_schemas import form_schemas, limited_schemas
from service.requests.limits import Limits
from service.requests.task import TaskSource
from tests.helpers.fleet_requests import LIMITS, fleet_of, fleet_request


def test_a_request_becomes_a_fleet() -> None:
    rules = fleet_of(fleet_request()).rules
    assert rules.visits[1] == Visit(demand=(2,), service=3, windows=((480, 600),))
    assert rules.visits[2] == Visit(demand=(1,), prize=4000)
    assert rules.visits[5] == Visit()
    assert rules.vehicles == (
        VehicleType(
            start=0, end=0, count=2, capacity=(5,), shift=(470, 700), longest=200, fixed=50
        ),
        VehicleType(start=0, end=None, capacity=(2,), shift=ALWAYS, longest=inf),
    )
    assert rules.shipments == (Shipment(3, 4),)
    assert (rules.over, rules.clock) == (("sum", "max"), 1)
    assert rules.clients == tuple(range(1, 8))


def test_limits_lower_the_defaults_and_refuse_what_is_over_them() -> None:
    request = fleet_request()
    del request["time_limit"], request["size"]
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    assert (task.options.time_limit, task.options.size) == (0.2, 30)
    few = Limits(
        body_bytes=10**6,
        cities=50,
        cells=9,
        preferences=2,
        size=30,
        seconds=0.2,
        fleet_stops=7,
    )
    with pytest.raises(Refusal) as refused:
        parse_task(TaskSource("fleet", json.dumps(request).encode()), few, {})
    assert (refused.value.code, refused.value.limit) == ("too-many-cities", 7)


def test_long_ids_make_room_for_fewer_plans() -> None:
    request = fleet_request()
    del request["size"]
    limits = replace(LIMITS, path_cells=LIMITS.size * (len(request["stops"]) + 1))
    assert parse_fleet_request(json.dumps(request).encode(), limits).size == LIMITS.size
    request["vehicles"][1] |= {"id": "é" * 100, "count": 10**6}
    most = parse_fleet_request(json.dumps(request).encode(), limits).size
    assert most < LIMITS.size
    request["size"] = most + 1
    with pytest.raises(Refusal, match=f"size must be at most {most} with 8 cities and ids so long"):
        parse_fleet_request(json.dumps(request).encode(), limits)


def changed(path: str, value: Any) -> dict[str, Any]:
    """Return the request with another value at a path, as stops/0/window; None removes it."""
    request = copy.deepcopy(fleet_request())
    *parents, last = [int(part) if part.isdecimal() else part for part in path.split("/")]
    at: Any = request
    for part in parents:
        at = at[part]
    if value is None:
        del at[last]
    elif isinstance(last, int) and last == len(at):
        at.append(value)
    else:
        at[last] = value
    return request


@pytest.mark.parametrize("clock", ["time", {"matrix": [[1] * 8] * 8, "spread": 0.3}])
def test_the_times_of_a_clock_spread(clock: Any) -> None:
    request = fleet_request() | {"clock": clock}
    if clock == "time":
        request["objectives"][1]["spread"] = 0.3
    else:
        request["objectives"][1] = {"name": "vans", "measure": "vehicles"}
    assert fleet_of(request).rules.spread == 0.3


SLOW = [[2] * 8] * 8
TWO_DAYS = [{"matrix": [[4] * 8] * 8}, {"matrix": SLOW}]
SAMPLED = {"name": "time", "days": TWO_DAYS}


@pytest.mark.parametrize("clock", ["time", {"days": TWO_DAYS}])
def test_the_times_of_several_days_are_given(clock: Any) -> None:
    request = fleet_request() | {"clock": clock}
    request["objectives"][1] = SAMPLED | {"over": "max", "percentile": 90}
    if clock != "time":
        request["objectives"][1] = {"name": "late", "measure": "on_time"}
    fleet = fleet_of(request)
    assert (fleet.rules.spread, fleet.rules.clock, fleet.rules.sampled) == (None, 1, True)
    assert fleet.sampled is not None
    assert fleet.sampled[:, 0, 1].tolist() == [4, 2]
    assert fleet.costs[1, 0, 1] == 3


def test_total_and_longest_are_of_the_same_days() -> None:
    request = fleet_request()
    request["objectives"] = [SAMPLED, SAMPLED | {"name": "longest", "over": "max"}]
    assert fleet_of(request).rules.layers == (0, 0)


CANNOT_BE_SAMPLED: list[tuple[Any, str, Any]] = [
    ({}, "/objectives/1/days", "lengths"),
    ({}, "/objectives/1/days", {"matrix": SLOW}),
    ({"days": TWO_DAYS[:1]}, "/objectives/1/days", "time"),
    ({"days": [*TWO_DAYS, {"matrix": [[0]]}]}, "/objectives/1/days/2/matrix", "time"),
    ({"days": TWO_DAYS * 26}, "/objectives/1/days", "time"),
    ({"spread": 0.2}, "/objectives/1/spread", "time"),
    ({"over_the_day": [[0, 1], [9, 2]]}, "/objectives/1/days", "time"),
    ({"matrix": SLOW}, "/objectives/1", "time"),
]


@pytest.mark.parametrize(("members", "pointer", "clock"), CANNOT_BE_SAMPLED)
def test_what_cannot_be_sampled_is_named(members: Any, pointer: str, clock: Any) -> None:
    request = fleet_request() | {"clock": clock}
    request["objectives"] = [
        {"name": "lengths", "from": "great_circle"},
        SAMPLED | members,
        {"name": "vehicles", "measure": "vehicles"},
    ]
    with pytest.raises(Refusal) as refused:
        fleet_of(request)
    assert refused.value.errors[0].pointer == pointer


def test_objectives_are_of_most_days() -> None:
    request = fleet_request()
    time = request["objectives"][1] | {"over": "sum", "spread": 0.3}
    longest = time | {"name": "longest", "over": "max", "spread": None, "percentile": 90}
    request["objectives"] = [time | {"percentile": 95}, longest]
    rules = fleet_of(request).rules
    assert (rules.layers, rules.percents) == ((0, 0), (95, 90))
    for vehicle in request["vehicles"]:
        vehicle["per_time"] = 2
    with pytest.raises(Refusal, match="cannot be given beside a percentile, in /objectives/0"):
        fleet_of(request)
    for vehicle in request["vehicles"]:
        del vehicle["per_time"]
        vehicle["breaks"] = [{"window": [100, 200], "length": 5}]
    with pytest.raises(Refusal, match="cannot be given beside a percentile, in /objectives/0"):
        fleet_of(request)


def promised(vehicle: str, *stops: str, tolerance: Any = None, **members: Any) -> dict[str, Any]:
    """Return a promised plan of one route."""
    route = {"vehicle": vehicle, "stops": list(stops), **members}
    return {"routes": [route], "tolerance": tolerance}


HUGE = 10**400
REFUSED = [
    ("stops", [], "/stops"),
    ("stops", None, "/stops"),
    ("stops/1/demand", [1, 1], "/stops/1/demand"),
    ("stops/1/demand", [-1], "/stops/1/demand/0"),
    ("stops/1/demand", [0.5], "/stops/1/demand/0"),
    ("stops/1/demand", [HUGE], "/stops/1/demand/0"),
    ("stops/1/demand", [1] * 9, "/stops/1/demand"),
    ("stops/0/demand", [1], "/stops/0/demand"),
    ("stops/0/window", [1, 2], "/stops/0/window"),
    ("stops/1/service", -1, "/stops/1/service"),
    ("stops/1/service", 1e151, "/stops/1/service"),
    ("stops/1/window", [3, 2], "/stops/1/window"),
    ("stops/1/window", [3], "/stops/1/window"),
    ("stops/1/window", [-3, 2], "/stops/1/window/0"),
    ("stops/2/prize", -1, "/stops/2/prize"),
    ("stops/4/prize", 1, "/shipments/0/delivery"),
    ("stops/4/demand", [1], "/shipments/0/delivery"),
    ("stops/1/locked", True, "/stops/1/locked"),
    ("stops/1/id", "stop-2", "/stops/2/id"),
    ("shipments/0/pickup", "stop-0", "/shipments/0/pickup"),
    ("shipments/0/pickup", "stop-9", "/shipments/0/pickup"),
    ("shipments/0/delivery", 3, "/shipments/0/delivery"),
    ("shipments/0/delivery", 8, "/shipments/0/delivery"),
    ("shipments/1", {"pickup": 4, "delivery": 5}, "/shipments/1/pickup"),
    ("slack", -1, "/slack"),
    ("leave", "soon", "/leave"),
    ("stops/1/due", [9, 8], "/stops/1/due"),
    ("stops/1/due", [9], "/stops/1/due"),
    ("together", [["stop-5", "stop-0"]], "/together/0"),
    ("together", [["stop-5", "stop-3"]], "/together/0"),
    ("before", [{"first": ["stop-5"], "then": []}], "/before/0/then"),
    ("before", [{"first": [5], "then": [6], "gap": 9}], "/before/0/gap"),
    ("before", [{"first": [5], "then": [6], "vehicles": "any"}], "/before/0/vehicles"),
    ("apart", [{"stops": ["stop-5", "stop-9"]}], "/apart/0/stops/1"),
    ("promised", {"routes": []}, "/promised/routes"),
    ("promised", promised("car", "stop-1"), "/promised/routes/0/vehicle"),
    ("promised", promised("van", "stop-1", shift=1), "/promised/routes/0/shift"),
    ("promised", promised("van", "stop-1", "stop-1"), "/promised/routes/0/stops/1"),
    ("promised", promised("van", "stop-1", "stop-0", "stop-2"), "/promised/routes/0/stops/1"),
    ("promised", promised("van", "stop-1", tolerance=9), "/promised/routes/0/arrivals"),
    ("promised", promised("van", "stop-1", arrivals=[1, 2]), "/promised/routes/0/arrivals"),
    ("promised", {"routes": 3 * promised("van", "stop-1")["routes"]}, "/promised/routes/2/vehicle"),
    ("vehicles/0/shortest", 300, "/vehicles/0/shortest"),
    ("vehicles", [], "/vehicles"),
    ("vehicles/0/count", 0, "/vehicles/0/count"),
    ("vehicles/0/count", HUGE, "/vehicles/0/count"),
    ("vehicles/0/start", "stop-77", "/vehicles/0/start"),
    ("vehicles/0/end", 8, "/vehicles/0/end"),
    ("vehicles/1/capacity", [1, 2], "/vehicles/1/capacity"),
    ("vehicles/1/shift", [5, 1], "/vehicles/1/shift"),
    ("vehicles/1/longest", 0, "/vehicles/1/longest"),
    ("vehicles/1/id", "van", "/vehicles/1/id"),
    ("objectives/0/over", "mean", "/objectives/0/over"),
    ("objectives/0/over", "max", "/objectives/1/over"),
    ("objectives/1/over", None, None),
    ("objectives/0/name", "time", "/objectives/1/name"),
    ("objectives/1/matrix", [[0.0]], "/objectives/1/matrix"),
    ("objectives/0/from", "road_time", "/objectives/0/from"),
    ("objectives/0/spread", 0.2, "/objectives/0/spread"),
    ("objectives/1/spread", -1, "/objectives/1/spread"),
    ("objectives/0/percentile", 90, "/objectives/0/percentile"),
    ("objectives/1/percentile", 90, "/objectives/1/percentile"),
    ("objectives/2", {"name": "late", "measure": "on_time"}, "/objectives/2/measure"),
    ("clock", "minutes", "/clock"),
    ("clock", None, "/vehicles/0/shift"),
    ("time_limit", 0, None),
    ("time_limit", -1, "/time_limit"),
    ("time_limit", 1, "/time_limit"),
    ("size", 31, "/size"),
    ("seed", -1, "/seed"),
    ("reference_point", [1.0], "/reference_point"),
    ("preferences", 5, "/preferences"),
]


@pytest.mark.parametrize(("path", "value", "pointer"), REFUSED)
def test_what_is_wrong_is_pointed_at(path: str, value: Any, pointer: str | None) -> None:
    source = TaskSource("fleet", json.dumps(changed(path, value)).encode())
    if pointer is None:
        parse_task(source, LIMITS, {})
        return
    with pytest.raises(Refusal) as refused:
        parse_task(source, LIMITS, {})
    assert refused.value.status == 422
    assert [fault.pointer for fault in refused.value.errors] == [pointer]
    assert pointer.strip("/") in refused.value.detail


def test_all_that_a_depot_cannot_have_is_said_at_once() -> None:
    request = changed("stops/0/demand", [1])
    request["stops"][0] |= {"service": 5, "due": 9}
    with pytest.raises(Refusal) as refused:
        fleet_of(request)
    said = "stops/0/demand must not be given, nor service or due, for a stop at which vehicles"
    assert refused.value.detail.startswith(said)
    assert refused.value.detail.endswith("an order there needs a stop of its own")


def test_a_prize_or_a_fixed_cost_needs_a_first_objective_that_is_a_sum() -> None:
    request = changed("objectives/1/over", "sum")
    request["objectives"][0]["over"] = "max"
    with pytest.raises(Refusal, match="added to the first objective"):
        fleet_of(request)


def test_some_types_of_vehicles_take_longer_at_a_stop() -> None:
    request = changed(
        "stops/1/services", [{"vehicle": fleet_request()["vehicles"][1]["id"], "service": 9}]
    )
    assert fleet_of(request).rules.visits[1].services == (3, 9)
    request["stops"][1]["services"][0]["vehicle"] = "tram"
    with pytest.raises(Refusal, match="stops/1/services/0/vehicle"):
        fleet_of(request)


@pytest.mark.parametrize("member", ["fixed", "per_distance", "per_time"])
def test_prices_need_a_first_objective_that_is_a_sum(member: str) -> None:
    request = changed("objectives/1/over", "sum")
    request["objectives"][0]["over"] = "max"
    request["vehicles"] = [{"id": "van", "start": 0, "end": 0, member: 2}]
    with pytest.raises(Refusal, match=f"vehicles/0/{member} is added to the first objective"):
        fleet_of(request)


@pytest.mark.parametrize("member", ["speed_factor", "service_factor", "per_time"])
def test_factors_of_times_need_a_clock(member: str) -> None:
    request = changed("clock", None)
    request["vehicles"] = [{"id": "van", "start": 0, "end": 0, member: 2}]
    with pytest.raises(Refusal, match=f"vehicles/0/{member} needs the name of the objective"):
        fleet_of(request)


@pytest.mark.parametrize(
    ("member", "clock", "fault"),
    [
        ("max_driving", None, "needs the name of the objective"),
        ("max_distance", "time", "needs an objective whose costs are not time"),
    ],
)
def test_limits_on_driving_need_what_they_are_of(
    member: str, clock: str | None, fault: str
) -> None:
    request = changed("clock", clock)
    request["objectives"] = [{"name": "time", "from": "great_circle"}, {"measure": "vehicles"}]
    request["objectives"][1]["name"] = "vehicles"
    request["vehicles"] = [{"id": "van", "start": 0, "end": 0, member: 2}]
    with pytest.raises(Refusal, match=f"vehicles/0/{member} {fault}"):
        fleet_of(request)


def test_times_are_refused_without_a_clock() -> None:
    request = changed("clock", None)
    for vehicle in request["vehicles"]:
        vehicle.pop("shift", None)
    with pytest.raises(Refusal, match=r"stops/1/service needs the name of the objective"):
        fleet_of(request)


def test_schemas_have_names_and_limits() -> None:
    schemas = limited_schemas(FleetRequest, LIMITS, [])
    assert set(schemas) == {
        "FleetStopItem",
        "ShipmentItem",
        "BreakItem",
        "ApartItem",
        "BeforeItem",
        "PromisedRouteItem",
        "PromisedItem",
        "ServiceItem",
        "SliceItem",
        "MatrixItem",
        "ProfileMatrixItem",
        "VehicleItem",
        "FleetObjectiveItem",
        "ClockItem",
        "FleetRequest",
    }
    fields = form_schemas(LIMITS, [])["FleetRequest"]["properties"]
    assert fields["stops"]["maxItems"] == LIMITS.fleet_stops
    assert fields["time_limit"]["maximum"] == fields["time_limit"]["default"] == 0.2
    assert schemas["FleetRequest"]["required"] == ["stops", "vehicles", "objectives"]
