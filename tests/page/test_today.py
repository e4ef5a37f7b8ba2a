"""A fleet's day on the page: what is done by now, what changes for whom, and what is planned."""

import json
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.helpers.accessibility import found_on_desk_and_phone
from tests.helpers.browsing import (
    curl_body,
    needs_chromium,
    open_files,
    paste,
    wait_until_planned,
)
from tests.helpers.node import Node

HOUR, MINUTE = 3600, 60
CLOCK = {"clock": "time", "objectives": [{"name": "distance"}, {"name": "time", "unit": "min"}]}
STOPS = [{"id": name, "demand": [2], "service": 10} for name in ("A", "B", "C", "D")]
ASKED = {
    **CLOCK,
    "stops": [{"id": "depot"}, *STOPS],
    "vehicles": [
        {"id": "van", "count": 2, "start": "depot", "end": "depot", "capacity": [9]},
    ],
}
# Two vans: the first is at A from 9:00 to 9:10, at B at 10:00, and back at 11:00.
ROUTES = [
    {"vehicle": "van", "stops": ["depot", "A", "B", "depot"], "arrivals": [510, 540, 600, 660]},
    {"vehicle": "van", "stops": ["depot", "C", "D", "depot"], "arrivals": [600, 630, 660, 720]},
]
DRIVEN = {"at": 3, "routes": ROUTES, "names": ["van 1", "van 2"], "asked": ASKED}
PROGRESS = """async ([driven, now, turned]) => {
  const { progressOf, doneOf } = await import("./page/today/progress.js");
  const { vanSaid } = await import("./page/today/said.js");
  const { knownFleet } = await import("./page/fleet/known_fleet.js");
  const { vans, clock } = progressOf(driven, { now, turned: new Set(turned) });
  const known = knownFleet(driven.asked);
  const said = (van) => vanSaid(van, { isOutOfService: false, clock, known, vehicle: "van" });
  return vans.map((van) => [doneOf(van).join(""), van.isOut, van.share, said(van)]);
}"""


@pytest.mark.parametrize(
    ("now", "turned", "first"),
    [
        (500, [], ["", False, 0, "sets off at 8:30"]),
        (525, [], ["", True, 0.5, "0 of 2 done, on the way to A; load 4 of 9"]),
        (545, [], ["A", True, 0, "0 of 2 done, at A until 9:10; load 2 of 9"]),
        (575, [], ["A", True, 0.5, "1 of 2 done, on the way to B; load 2 of 9"]),
        (635, [], ["AB", True, 0.5, "2 of 2 done, on the way to depot; load 0 of 9"]),
        (660, [], ["AB", True, 0, "all 2 done, back at depot"]),
        (575, ["A"], ["", True, 0, "0 of 2 done, at depot; load 4 of 9"]),
        (500, ["A"], ["A", True, 0, "1 of 2 done, at A; load 2 of 9"]),
        (None, ["A", "B"], ["AB", True, 0, "all 2 done"]),
    ],
)
def test_what_is_done_comes_from_the_times_of_the_plan(
    node: Node, now: int | None, turned: list[str], first: list[Any]
) -> None:
    assert node.evaluate(PROGRESS, [DRIVEN, now, turned])[0] == first


LOADS = """async ([driven, now]) => {
  const { progressOf } = await import("./page/today/progress.js");
  const { onBoard } = await import("./page/today/said.js");
  const { loadOf } = await import("./page/fleet/routes_of_plan.js");
  const { knownFleet } = await import("./page/fleet/known_fleet.js");
  const [van] = progressOf(driven, { now, turned: new Set() }).vans;
  const known = knownFleet(driven.asked);
  return [onBoard(van, known, "van"), loadOf(driven.routes[0], known)];
}"""


@pytest.mark.parametrize(("now", "on_board"), [(525, "4"), (575, "7"), (635, "6")])
def test_what_stops_give_back_is_on_board_to_the_end(node: Node, now: int, on_board: str) -> None:
    """A gets 2 and gives 5 back, and B gets 2 and gives 1 back."""
    back = {"A": [5], "B": [1]}
    stops = [{**stop, "pickup": back.get(str(stop["id"]), [0])} for stop in STOPS]
    driven = {**DRIVEN, "asked": {**ASKED, "stops": [{"id": "depot"}, *stops]}}
    assert node.evaluate(LOADS, [driven, now]) == [on_board, "7 of 9"]


LOADING = """async ([driven, now, out]) => {
  const { progressOf } = await import("./page/today/progress.js");
  const { loadingSaid } = await import("./page/today/said.js");
  const { vans } = progressOf(driven, { now, turned: new Set() });
  return loadingSaid(vans, driven.routes, driven.asked, new Set(out));
}"""


@pytest.mark.parametrize(
    ("now", "out", "van", "can"),
    [
        (540, [], {}, True),  # the second has not left
        (540, ["van 2"], {}, False),
        (630, [], {}, False),
        (630, [], {"reload": ["depot"]}, True),
        (630, [], {"count": 3}, True),
        (660, [], {}, True),  # the first is back
        (660, ["van 1"], {}, False),
    ],
)
def test_the_page_says_when_nobody_can_load_new_orders(
    node: Node, now: int, out: list[str], van: dict[str, Any], can: bool
) -> None:
    asked = {**ASKED, "vehicles": [{**ASKED["vehicles"][0], **van}]}  # type: ignore[dict-item]
    said = node.evaluate(LOADING, [{**DRIVEN, "asked": asked}, now, out])
    assert said == "" if can else said.startswith("All vehicles are on their way")


BODY = """async ([driven, now, tips, out, cancelled, added]) => {
  const { progressOf } = await import("./page/today/progress.js");
  const { FleetRest, bodyOf } = await import("./page/today/rest.js");
  const { vans } = progressOf(driven, { now, turned: new Set() });
  const placed = vans.map((van, at) => ({ ...van, tip: tips?.[at] }));
  const sets = { out: new Set(out), removed: new Set(cancelled) };
  const day = { vans: placed, now, nowSaid: "9:35", ...sets, added };
  const body = bodyOf(driven, day);
  const rest = new FleetRest(driven, body, day);
  const routes = [...body.routes, {}, {}].map(({ route }) => ({ vehicle: "van", route }));
  const [plan] = rest.answer({ front: [{ routes }] }).front;
  return [body, rest.names, plan.routes.map(({ name, place }) => [name, place])];
}"""


def test_a_replanning_says_how_far_the_vehicles_are_and_what_has_changed(node: Node) -> None:
    new = {"id": "E", "location": [1, 2]}
    placed = {
        **ASKED,
        "seed": 7,
        "time_limit": 0,
        "objectives": [
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "from": "great_circle", "speed": 9, "unit": "min"},
        ],
    }
    driven = {**DRIVEN, "asked": placed}
    given = [driven, 575, [[3, 4], None], [], ["B", "A"], [new]]
    body, names, named = node.evaluate(BODY, given)
    # What is done is not cancelled, and no time of planning would be no plan.
    assert body == {
        **{"plan": 3, "now": 575, "add": [new], "remove": ["B"], "seed": 7},
        "routes": [
            {"route": 0, "done": ["A"], "position": {"id": "van 1 at 9:35", "location": [3, 4]}}
        ],
    }
    assert names == ["depot", "A", "B", "C", "D", "E", "van 1 at 9:35"]
    # A vehicle keeps its name and its colour; one that has not left has those of its kind.
    assert named == [["van 1", 0], ["van 2", 1], ["van 3", 2]]
    broken, *_ = node.evaluate(BODY, [driven, 635, [[3, 4], [5, 6]], ["van 1"], [], []])
    assert broken["routes"] == [
        {"route": 0, "done": ["A", "B"], "broken_down": True},
        {"route": 1, "done": ["C"], "leaves": 640},
    ]
    limited = {**DRIVEN["routes"][0], "driving": [0, 20, 50, 80], "distance": [0, 2, 5, 9]}
    known = {**driven, "routes": [limited, *DRIVEN["routes"][1:]]}
    way, *_ = node.evaluate(BODY, [known, 575, [[3, 4], None], [], [], []])
    [first] = way["routes"]
    assert 20 < first["driving"] < 50
    assert first["distance"] == 2 + (first["driving"] - 20) / 10
    by_costs, *_ = node.evaluate(BODY, [DRIVEN, 575, [[3, 4], None], [], [], []])
    assert by_costs["routes"] == [{"route": 0, "done": ["A"]}]


@pytest.mark.parametrize(
    ("at", "share", "line"),
    [
        (0, 0, [[0, 0]]),
        (0, 0.5, [[0, 0], [2, 0]]),
        (1, 0, [[0, 0], [2, 0], [4, 0]]),
        (1, 0.25, [[0, 0], [2, 0], [4, 0], [4, 1]]),
        (2, 0, [[0, 0], [2, 0], [4, 0], [4, 4]]),
    ],
)
def test_what_is_driven_is_the_first_part_of_the_way(
    node: Node, at: int, share: float, line: list[list[float]]
) -> None:
    way = [[0, 0], [2, 0], [4, 0], [4, 4]]
    stops = [[0, 0], [4, 0], [4, 4]]
    assert node.call("today/progress.js", "travelled", way, stops, at, share) == line


CHANGES = """async ([routes, vehicle, day]) => {
  const { progressOf } = await import("./page/today/progress.js");
  const { changesOf } = await import("./page/today/changes.js");
  const before = progressOf(routes[0], { now: 575, turned: new Set() });
  const after = progressOf(routes[1], { now: null, turned: new Set() });
  const clock = after.clock && { said: after.clock.said, second: 60 };
  const known = { ...day, out: new Set(day.out), removed: new Set(day.removed) };
  const customerOf = (stop) => (stop === "B" ? "Bo" : "");
  return changesOf(before.vans, after.vans, clock, { ...known, customerOf });
}"""


def test_what_changes_is_said_for_each_stop_and_vehicle(node: Node) -> None:
    routes = [
        {
            **{"vehicle": "van", "route": 1, "name": "van 2"},
            **{"stops": ["depot", "C", "D", "B", "E", "depot"]},
            "arrivals": [600, 630, 665, 690, 710, 750],
        }
    ]
    rest = {"routes": routes, "names": ["van 2"], "asked": ASKED}
    day: dict[str, Any] = {"out": ["van 1"], "removed": [], "unassigned": []}
    found = node.evaluate(CHANGES, [[DRIVEN, rest], "van", {**day, "added": [{"id": "E"}]}])
    assert found["said"] == [
        "B (Bo) moves from van 1 to van 2: 11:30, 1 h 30 min later",
        "E is new: van 2 at 11:50",
        "D stays with van 2: 11:05, 5 min later",
    ]
    assert found["many"] == (
        "Of 4 stops, 1 stays as planned (within 5 min); 1 stays with its vehicle, but 5 min or more"
        " earlier or later; 1 moves to another vehicle; and 1 is new."
    )
    assert found["last"] == "The last vehicle is back at 12:30, 30 min later."
    assert found["vehicles"] == [
        {
            **{"name": "van 1", "isOut": True, "after": None},
            "before": {"stops": 1, "back": "11:00"},
        },
        {
            **{"name": "van 2", "isOut": False},
            **{"before": {"stops": 2, "back": "12:00"}, "after": {"stops": 4, "back": "12:30"}},
        },
    ]
    routes[0] |= {"stops": ["depot", "C", "depot"], "arrivals": [600, 630, 690]}
    day |= {"removed": ["B"], "unassigned": ["D", "E"], "added": [{"id": "E"}]}
    found = node.evaluate(CHANGES, [[DRIVEN, rest], "van", day])
    assert found["said"] == [
        "D is left out: van 2 no longer goes there",
        "E is new, and is left out: nobody can go there",
        "B (Bo) is cancelled: van 1 no longer goes there",
    ]
    del routes[0]["arrivals"]
    untimed = {**DRIVEN, "routes": [{**each, "arrivals": None} for each in ROUTES]}
    found = node.evaluate(CHANGES, [[untimed, rest], "van", {**day, "unassigned": []}])
    assert found["said"] == ["B (Bo) is cancelled: van 1 no longer goes there"]
    assert found["last"] == ""


PLACES = [[24.95, 60.17], [24.96, 60.18], [24.97, 60.17], [24.93, 60.17], [24.92, 60.18]]
VAN = {"start": "depot", "end": "depot", "capacity": [8], "reload": ["depot"]}
FLEET: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": [24.941, 60.171]},
        *(
            {"id": f"A{at}", "location": place, "demand": [2], "service": 20 * MINUTE}
            for at, place in enumerate([*PLACES, *([x, y + 0.02] for x, y in PLACES)])
        ),
    ],
    "vehicles": [
        {**VAN, "id": "Pekka", "shift": [8 * HOUR, 14 * HOUR], "max_trips": 2},
        {**VAN, "id": "Anna", "shift": [8 * HOUR, 14 * HOUR], "max_trips": 2},
        {**VAN, "id": "Olli", "shift": [10 * HOUR, 16 * HOUR]},
    ],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": 5, "over": "max"},
    ],
    "clock": "time",
    "seed": 7,
    "time_limit": 0.05,
}
FLEET["stops"][1]["window"] = FLEET["stops"][4]["window"] = [8 * HOUR, 8.5 * HOUR]


@needs_chromium
def test_a_day_is_replanned_from_what_is_done_by_now(window: Page) -> None:
    page, panel, changes = window, window.locator("#today"), window.locator("#changes")
    left = left_of_a_planned_day(page)
    first, *_, last = left
    page.get_by_role("button", name=f"Cancel {last}").click()
    broken = panel.locator(".van", has_text=first).get_by_role("checkbox")
    broken.check()
    order_three(page, known=first)
    replan(page)
    for said in (f"{last} is cancelled", "extra 1 is new", "out of service"):
        expect(changes).to_contain_text(said)
    found = found_on_desk_and_phone(page, "#today", "#changes")
    # The drivers' sheets have each stop that is left once, and none that is done or cancelled.
    rest = sorted({*left, "B1", "extra 1"} - {last})
    assert sorted(on_sheets(page)) == rest
    page.get_by_role("button", name="Keep the plan before").click()
    expect(changes).to_be_hidden()
    expect(broken).to_be_checked()
    expect(panel.locator(".gone")).to_contain_text(last)
    assert curl_body(page, "fleet")["stops"] == FLEET["stops"]
    replan(page)
    page.get_by_role("button", name="Drive the new plan").click()
    expect(changes).to_be_hidden()
    assert sorted(stops(page, ":not(.done)")) == rest
    say_time(page, "10:00")
    replan(page)
    page.locator("#add").click()
    expect(page.locator("#status")).to_contain_text("Undo brings it back")
    expect(panel).to_be_hidden()
    assert found == []


@needs_chromium
def test_what_helps_a_day_that_has_no_plan_is_one_click(window: Page) -> None:
    """The van that is left has no room for the other one's stops, all of them still to come."""
    vans = [{**VAN, "id": name, "capacity": [4], "reload": []} for name in ("Pekka", "Anna")]
    depot, *orders = FLEET["stops"][:5]
    later = [{**order, "window": [9 * HOUR, 14 * HOUR]} for order in orders]
    asked = {**FLEET, "stops": [depot, *later], "vehicles": vans}
    open_files(window, {"fleet.json": json.dumps(asked)})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    window.locator("#today > summary").click()
    say_time(window, "8:30")
    window.locator("#vans .van", has_text="Anna").get_by_role("checkbox").check()
    window.locator("#replan-fleet").click()
    remedies = window.locator("#today-remedies").get_by_role("button")
    expect(remedies.first).to_be_visible()
    assert found_on_desk_and_phone(window, "#today") == []
    remedies.filter(has_text="leave").first.click()
    expect(window.locator("#changes")).to_contain_text("left out")
    expect(remedies).to_have_count(0)


def left_of_a_planned_day(page: Page) -> list[str]:
    """Plan the fleet, say that it is 9:30, and return the stops that are not done by then."""
    open_files(page, {"fleet.json": json.dumps(FLEET)})
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    page.locator("#today > summary").click()
    say_time(page, "soon")
    expect(page.locator("#today-now-fault")).to_have_text("Write a time, as 11:00.")
    say_time(page, "9:30")
    expect(page.locator("#plane-1 canvas.past")).to_be_visible()
    done, left = stops(page, ".done"), stops(page, ":not(.done)")
    assert done
    # One press takes a stop back, and another has it done again.
    page.locator(f"#vans [data-turn={done[-1]}]").click()
    assert done[-1] in stops(page, ":not(.done)")
    page.locator(f"#vans [data-turn={done[-1]}]").click()
    assert (stops(page, ".done"), stops(page, ":not(.done)")) == (done, left)
    return left


def order_three(page: Page, known: str) -> None:
    """Order by a click on the map, by rows that are pasted, and by one that is not taken."""
    page.get_by_role("button", name="Click where it is").click()
    page.locator("#plane-1").click(position={"x": 200, "y": 150})
    expect(page.get_by_label("Service of extra 1")).to_have_value("20 min")  # as the others
    said = "2 rows were read; 1 is a stop of the plan already."
    paste_orders(page, f"id,lon,lat\nB1,24.95,60.18\n{known},24.95,60.18\n", said)
    page.locator("#add-order").click()
    page.get_by_label("Name of order 3").fill(known)
    page.get_by_label("Name of order 3").press("Tab")
    page.locator("#replan-fleet").click()
    fault = f"{known} is a stop of the plan already: give the new order another name."
    expect(page.locator("#today-fault")).to_have_text(fault)
    page.locator("#orders").get_by_role("button", name=f"Delete {known}").click()


def paste_orders(page: Page, text: str, said: str) -> None:
    """Paste the rows of new orders, and wait until they are read."""
    paste(page, text, page.locator("#orders-help"), said)


def replan(page: Page) -> None:
    page.locator("#replan-fleet").click()
    expect(page.locator("#changes")).to_be_visible()


def say_time(page: Page, text: str) -> None:
    page.locator("#today-now").fill(text)
    page.locator("#today-now").press("Tab")


def stops(page: Page, which: str) -> list[str]:
    """Return the names of the stops that are done, or of those that are not."""
    chips = page.locator(f"#vans .chips li{which} .of")
    names: list[str] = chips.evaluate_all("chips => chips.map(each => each.dataset.turn)")
    return names


def on_sheets(page: Page) -> list[str]:
    """Return the stops that drivers are told to visit, without starts and ends."""
    page.evaluate("window.print = () => {}")
    page.get_by_role("button", name="Print the stops").click()
    names = page.locator("#sheet tbody td:nth-child(2)").all_text_contents()
    return [name for name in names if ": " not in name]
