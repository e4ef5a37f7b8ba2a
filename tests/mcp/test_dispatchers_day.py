"""A dispatcher's day with an agent, from the morning to the afternoon, by the SDK's client."""

import asyncio
import json
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import httpx
import pytest
from mcp import Client
from paretour import AsyncClient

from service.amounts.read import budget_in, number_in
from service.amounts.said import amount, clock_time
from service.api.app import Edge
from service.mcp import server
from service.mcp.times import with_times
from service.mcp.tools import Planner
from service.requests.front import FrontRequest
from service.requests.replan.offers import OffersRequest
from tests.helpers.serving import app_of, serving
from tests.mcp.test_tools import FLEET, LIMITS, agent, call, said

ORDERS = [
    {"id": f"o{i}", "location": [24.9 + i * i % 11 / 100, 60.1 + i * 3 % 7 / 100], "demand": [1]}
    for i in range(1, 13)
]
DAY: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": [24.93, 60.13]},
        *({**order, "service": "10 min", "window": ["8:00", "16:00"]} for order in ORDERS),
    ],
    "vehicles": [
        {
            "id": name,
            "start": 0,
            "end": 0,
            "capacity": [6],
            "shift": ["8:00", "18:00"],
            "reload": ["depot"],
        }
        for name in ("Anna", "Pekka", "Sofia")
    ],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": 20, "over": "max"},
    ],
    "clock": "time",
    "time_limit": 0.2,
}
VANS = "id,start,capacity\nvan-1,depot,8\nvan-2,depot,8\n"
TABLE = "id,lat,lon,demand\ndepot,60.13,24.93,\n" + "".join(
    f"{order['id']},{order['location'][1]},{order['location'][0]},1\n" for order in ORDERS
)


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    limits = replace(LIMITS, seconds=30)  # of offers, which take no time unless others do
    with serving(app_of(limits=limits, edge=Edge(agents=True))) as address:
        yield address


def check_plan(plan: dict[str, Any]) -> None:
    """Check that all is there which a dispatcher reads: times of day, lengths, loads, measures."""
    for route in plan["routes"]:
        assert len(route["times"]) == len(route["stops"])
        assert (route["leaves"], route["ends"]) == (route["times"][0], route["times"][-1])
        minutes = [int(h) * 60 + int(m) for h, m in (time.split(":") for time in route["times"])]
        assert minutes == sorted(minutes)
        assert minutes[0] >= 8 * 60
        assert route["lengths"].keys() == {"distance", "time"}
        assert route["load"] <= 6


def test_a_day_of_a_dispatcher_from_the_morning_to_the_afternoon(url: str) -> None:
    async def talk() -> None:
        async with agent(url) as client:
            morning = await call(client, "plan_fleet", **DAY)
            check_plan(morning)
            stored = httpx.get(f"{url}/front/{morning['front']}").json()["front"]
            explained = await call(client, "explain_front", front=morning["link"])
            assert explained["front"] == morning["front"]
            assert {each["stops_of"] for each in (explained, morning)} == {morning["stops_of"]}
            check_plan(explained)
            await check_choices(client, morning, stored)
            chosen = await check_questions(client, morning, stored)
            rest = await check_replanning(client, morning, stored, chosen)
            assert await call(client, "explain_front", front=rest["link"])
            check_plan(await call(client, "choose_tour", front=rest["link"], knee=True))

    asyncio.run(talk())


async def check_choices(client: Any, morning: dict[str, Any], stored: list[Any]) -> None:
    named = {each["is"]: each for each in morning["tours"]}
    fair = next(each for is_, each in named.items() if "fairest" in is_)
    imbalances = [plan["measures"]["imbalance"] for plan in stored]
    assert imbalances[fair["number"]] == min(imbalances)
    assert fair["measures"]["imbalance"] == amount(min(imbalances), "s")
    least = min(plan["lengths"][0] for plan in stored)
    by_share = await call(client, "choose_tour", front=morning["front"], at_most={"distance": "3%"})
    assert stored[by_share["number"]]["lengths"][0] <= 1.03 * least
    check_plan(by_share)
    by_time = await call(client, "choose_tour", front=morning["front"], at_most={"time": "9:00 h"})
    assert by_time["lengths"]["time"] <= 9 * 3600
    refused = await said(
        client, "choose_tour", True, front=morning["front"], at_most={"time": "3 km"}
    )
    assert "must be in the unit of its objective" in refused


async def check_questions(client: Any, morning: dict[str, Any], stored: list[Any]) -> Any:
    picks: list[int] = []
    asked = await call(client, "ask", front=morning["front"])
    while "options" in asked:
        assert asked["picks"] == picks
        picks.append(asked["options"][-1]["option"])
        asked = await call(client, "ask", front=morning["front"], picks=picks)
    assert list(asked["lengths"].values()) == pytest.approx(stored[asked["number"]]["lengths"])
    check_plan(asked)
    return asked


async def check_replanning(
    client: Any, morning: dict[str, Any], stored: list[Any], chosen: dict[str, Any]
) -> dict[str, Any]:
    """Replan at eleven, when one van is out and an order is new, and say by whom what was done."""
    plan, routes = chosen["number"], stored[chosen["number"]]["routes"]
    # Of twelve orders and three vans, one visits four at least: after two there are some left.
    driven = max(routes, key=lambda route: len(visits_of(route)))
    number, (_, second, *_, last) = routes.index(driven), visits_of(driven)
    begins = driven["arrivals"][driven["stops"].index(second)]
    done = {route["vehicle"]: route["stops"][:2] for route in routes}
    now = clock_time(begins, "s")
    planned = {"front": morning["front"], "plan": plan, "now": now, "time_limit": 0.2}
    refused = await said(client, "replan", True, **planned, done={"Ann": []})
    assert "'Ann' is no vehicle with a route" in refused
    for vehicle, stops in done.items():
        wrong = {**done, vehicle: [*stops, "nobody"]}
        refused = await said(client, "replan", True, **planned, done=wrong)
        assert f"done/{vehicle}/2 must be the id" in refused, refused
    added = await order_in_last_slot(client, {**planned, "done": done, "time_limit": 30})
    said_by_van = await call(client, "replan", **planned, done=done, add=[added])
    visited = {stop for each in said_by_van["routes"] for stop in each["stops"]}
    assert "new" in visited
    assert not visited & {route["stops"][1] for route in routes} - {
        each["stops"][0] for each in said_by_van["routes"]
    }
    planned["now"] = begins + 60
    as_planned: dict[str, Any] = await call(
        client, "replan", **planned, done="as planned", remove=[last]
    )
    said_of = f"route {number} ({driven['vehicle']}) has visited as planned"
    assert any(each.startswith(said_of) for each in as_planned["assumed"])
    check_plan(as_planned)
    # The visit has begun that is to take 10 minutes.
    (begun,) = (each for each in as_planned["routes"] if each.get("was_route") == number)
    assert begun["leaves"] == clock_time(begins + 600, "s")
    return await check_breakdown(client, planned, number, driven)


async def order_in_last_slot(client: Any, planned: dict[str, Any]) -> dict[str, Any]:
    """Ask for the slots of an order, and return it with the window of the last one offered."""
    order = {"id": "new", "location": [24.95, 60.14], "demand": [1]}
    hours = {"from": "6:00", "to": "18:00", "length": "2:00 h"}
    offered = await call(client, "offer_slots", **planned, order=order, every=hours)
    assert [each["slot"] for each in offered["not_possible"]][:1] == [["6:00", "8:00"]]
    latest = offered["slots"][-1]
    assert latest["rise"].keys() == {"distance", "time"}
    return {**order, "window": latest["window"]}


def visits_of(route: dict[str, Any]) -> list[str]:
    return [stop for stop in route["stops"] if stop != "depot"]


async def check_breakdown(
    client: Any, planned: dict[str, Any], number: int, driven: dict[str, Any]
) -> dict[str, Any]:
    """Replan when a van breaks down: others, which load again at the depot, bring what is left."""
    out = {"done": "as planned", "broken_down": [driven["vehicle"]]}
    rest = await call(client, "replan", **planned, **out)
    check_plan(rest)
    assert not any(each.get("was_route") == number for each in rest["routes"])
    left = set(visits_of(driven)[2:])
    assert left <= {stop for each in rest["routes"] for stop in each["stops"]}
    tight = [{"stop": min(left), "windows": [[0, 1]]}]
    refused = await said(client, "replan", True, **{**planned, **out, "time_limit": 2}, stops=tight)
    assert "- leave stop" in refused
    assert "out where that helps" in refused
    return rest


def test_a_client_that_asks_for_progress_hears_what_a_tool_waits_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Compiling(Planner):
        async def stored(self, front: str) -> Any:
            await asyncio.sleep(0.5)
            raise ValueError(front)

    async def state() -> str:
        return "compiling the search: 40 %"

    monkeypatch.setattr(server, "_PAUSE", 0.1)
    heard: list[str | None] = []

    async def hear(_: float, __: float | None, message: str | None) -> None:
        heard.append(message)

    async def talk() -> None:
        planner = Compiling(AsyncClient("http://nowhere"), state=state)
        made = server.make_server(lambda _: nullcontext(planner), "test")
        async with Client(made) as client:
            await client.call_tool("explain_front", {"front": "x"}, progress_callback=hear)

    asyncio.run(talk())
    assert heard
    assert set(heard) == {"compiling the search: 40 %"}


def test_progress_is_told_over_http_to_those_who_ask_for_it(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "_PAUSE", 0.1)
    heard: list[str | None] = []

    async def hear(_: float, __: float | None, message: str | None) -> None:
        heard.append(message)

    async def talk() -> None:
        day = {**DAY, "time_limit": 0.6}
        async with agent(url) as client:
            told = await client.call_tool("plan_fleet", day, progress_callback=hear)
            check_plan(json.loads(told.content[0].text))

    asyncio.run(talk())
    assert any(str(each).startswith("planning") for each in heard)


def test_a_plan_names_the_stops_that_it_leaves_out(url: str) -> None:
    async def talk() -> None:
        stops = [{**stop, "prize": 0} if "demand" in stop else stop for stop in FLEET["stops"]]
        vans = [{**FLEET["vehicles"][0], "count": 1}]
        async with agent(url) as client:
            front = await call(client, "plan_fleet", **{**FLEET, "stops": stops, "vehicles": vans})
            depot, *others = [stop["id"] for stop in stops]
            served = {stop for each in front["routes"] for stop in each["stops"]} - {depot}
            assert sorted([*served, *front["unassigned"]]) == others

    asyncio.run(talk())


def test_several_files_are_planned_together(url: str) -> None:
    async def talk() -> None:
        async with agent(url) as client:
            files = [{"name": "orders.csv", "text": TABLE}, {"name": "vans.csv", "text": VANS}]
            planned = await call(client, "plan_file", files=files, time_limit=0.1)
            assert {route["vehicle"] for route in planned["routes"]} <= {"van-1", "van-2"}
            refused = await said(client, "plan_file", True, files=files, text=TABLE)
            assert "text or files must be given" in refused

    asyncio.run(talk())


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("10:00", "s", 36000),
        ("10:00", "min", 600),
        ("2:10 h", "h", 2 + 1 / 6),
        ("90 min", "s", 5400),
        ("12.5 km", "m", 12500),
        ("40 EUR", "EUR", 40),
        ("40", None, 40),
        ("day 2, 8:05", "min", 1925),
        (clock_time(115500, "s"), "s", 115500),
        *((amount(x, unit), unit, x) for unit in ("s", "m", "EUR") for x in (0, 30, 7200, 2e7)),
    ],
)
def test_amounts_are_read_as_people_write_them(text: str, unit: str, number: float) -> None:
    assert number_in(text, unit) == pytest.approx(number)


def test_times_of_the_day_are_read_wherever_a_request_has_them() -> None:
    day = {
        "departure": {"earliest": "8:00", "latest": "day 2, 0:10"},
        "objectives": [
            {"name": "a", "over_the_day": [["0:00", 1], ["0:01", 2]]},
            {"from": "road_time", "traffic": {"at": ["0:01"]}},
            {"slices": [{"from": "0:01", "matrix": [[0]]}]},
        ],
        "every": {"from": "0:01", "to": "0:03", "length": "1 min", "step": "1 min"},
    }
    read: Any = with_times(day, "s", FrontRequest, OffersRequest)
    assert read["departure"] == {"earliest": 28800, "latest": 87000}
    changing, traffic, sliced = read["objectives"]
    assert changing["over_the_day"] == [[0, 1], [60, 2]]
    assert (traffic["from"], traffic["traffic"]["at"]) == ("road_time", [60])
    assert sliced["slices"][0]["from"] == 60
    assert read["every"] == {"from": 60, "to": 180, "length": 60, "step": 60}


def test_budgets_and_times_are_read_and_written() -> None:
    assert budget_in("3%", 200, "m") == 206
    assert [clock_time(t, "s") for t in (29100, 115500)] == ["8:05", "day 2, 8:05"]
    assert [amount(t, "min") for t in (130, 60, 12)] == ["2:10 h", "1:00 h", "12 min"]
    assert amount(14200, "m") == "14.2 km"
    with pytest.raises(ValueError, match="must be a number, a time as 10:00"):
        number_in("soon", "s")


def test_what_dispatchers_ask_for_is_asked_for_in_their_words(url: str) -> None:
    vans = [
        {**DAY["vehicles"][0], "id": "bike", "speed_factor": 0.8, "service_factor": 0.5},
        {**DAY["vehicles"][1], "min_stops": 2, "shortest": "0:30 h"},
    ]
    rush = [["0:00", 1], ["9:00", 1.2]]
    asked = {
        **DAY,
        "stops": [
            {**stop, "due": ["8:30", "15:00"]} if i else stop for i, stop in enumerate(DAY["stops"])
        ],
        "vehicles": vans,
        "objectives": [
            DAY["objectives"][0],
            {**DAY["objectives"][1], "over": "sum", "over_the_day": rush},
            {"name": "mixed areas", "measure": "overlap"},
        ],
        "together": [["o1", "o2"]],
        "apart": [{"stops": ["o1", "o3"]}],
        "before": [{"first": ["o2"], "then": ["o1"]}],
        "slack": "10 min",
        "leave": "early",
    }

    async def talk() -> None:
        async with agent(url) as client:
            shown = next(t for t in (await client.list_tools()).tools if t.name == "plan_fleet")
            assert asked.keys() <= shown.input_schema["properties"].keys()
            front = await call(client, "plan_fleet", **asked)
            routes = [each["stops"] for each in front["routes"]]
            (both,) = (stops for stops in routes if "o1" in stops)
            assert both.index("o2") < both.index("o1")
            assert "o3" not in both
            plan = front["tours"][0]
            assert plan["measures"]["overlap"].endswith("% of neighbours ride with somebody else")
            assert plan["measures"]["earliness"].endswith(("min", "h", "0 s"))
            assert all(each["leaves"] == "8:00" for each in front["routes"])
            fewest = {"front": front["front"], "now": "8:00", "changes": {"tolerance": "15 min"}}
            rest = await call(client, "replan", **fewest, time_limit=0.2)
            assert min(each["measures"]["changes"] for each in rest["tours"]) == "0 stops"

    asyncio.run(talk())
