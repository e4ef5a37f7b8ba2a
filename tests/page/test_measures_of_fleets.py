"""Measures of plans on the page, from a stored front: lateness, shifts, trips, late stops."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    copied,
    needs_chromium,
    open_unplanned,
    saved,
    wait_for_next_frame,
)
from tests.helpers.sampled import few
from tests.helpers.stored_answers import open_stored_answer

pytestmark = needs_chromium

HOUR, MINUTE, DAY = 3600, 60, 86400
MINUS = "\N{MINUS SIGN}"
ID = 32 * "a"
MATRIX = [[600] * 5] * 5
REQUEST: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": [24.941, 60.171]},
        {"id": "order-9", "location": [24.952, 60.169], "service": 300},
        {
            "id": "order-17",
            "location": [24.933, 60.165],
            "due": 9 * HOUR + 12 * MINUTE,
            "windows": [[8 * HOUR, 10 * HOUR]],
        },
        {"id": "order-4", "location": [24.925, 60.18], "release": 10 * HOUR},
        {
            "id": "far",
            "location": [24.96, 60.175],
            "prize": 900,
            "windows": [[9 * HOUR, 9.5 * HOUR]],
        },
    ],
    "vehicles": [
        {
            "id": "van",
            "start": "depot",
            "end": 0,
            "shifts": [[9 * HOUR, 12 * HOUR], [DAY + 9 * HOUR, DAY + 12 * HOUR]],
            "max_overtime": HOUR,
            "reload": ["depot"],
        }
    ],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "lateness", "measure": "lateness"},
    ],
    "clock": {"unit": "s", "matrix": MATRIX},
    "time_limit": 0.2,
}


def route(stops: list[str], shift: int, *times: tuple[int, int]) -> dict[str, Any]:
    arrivals = [DAY * shift + hour * HOUR + minute * MINUTE for hour, minute in times]
    lengths = [4000.0, 0.0]
    return {
        "vehicle": "van",
        "stops": stops,
        "lengths": lengths,
        "shift": shift,
        "arrivals": arrivals,
    }


TIMES = {"driving": 3000.0, "service": 300.0, "waiting": 35 * MINUTE, "overtime": 0.0}
LATE = {
    "balance": 0.0,
    "lengths": [4000.0, 13.0 * MINUTE],
    "measures": {
        **{"vehicles": 1, "lateness": 13.0 * MINUTE, "unassigned": 900, **TIMES},
        **{"longest": 3900.0, "shortest": 3900.0, "imbalance": 0.0},
    },
    "routes": [
        route(
            ["depot", "order-9", "order-17", "depot", "order-4", "depot"],
            0,
            *((9, 0), (9, 10), (9, 25), (9, 35), (10, 10), (10, 20)),
        )
    ],
    "unassigned": ["far"],
}
IN_TIME = {
    "balance": 1.0,
    "lengths": [5000.0, 0.0],
    "measures": {
        **LATE["measures"],
        "vehicles": 2,
        "lateness": 0.0,
        "unassigned": 0,
        "waiting": 0.0,
    },
    "routes": [
        route(["depot", "order-17", "far", "depot"], 0, (8, 50), (9, 0), (9, 10), (9, 20)),
        route(["depot", "order-9", "order-4", "depot"], 1, (9, 0), (9, 10), (9, 25), (9, 35)),
    ],
    "unassigned": [],
}


def answer(measure: str, values: list[float]) -> dict[str, Any]:
    """Return a stored front of both plans under distance and a measure with these values."""
    plans = [
        {**plan, "lengths": [plan["lengths"][0], value]}
        for plan, value in zip((LATE, IN_TIME), values, strict=True)
    ]
    return {
        **{"id": ID, "status": "done", "kind": "fleet", "cities": 5, "points": 2},
        **{"hypervolume": 0.5, "hypervolume_bound": None, "reference_point": [9000, 9000]},
        **{"scale": [1, 1], "timings_ms": {"total": 200}, "terminated": "time_limit"},
        "stops": [{"id": s["id"], "location": s["location"]} for s in REQUEST["stops"]],
        "objectives": [
            {"name": "distance", "unit": "m", "over": "sum"},
            {"name": measure, "unit": None, "over": "sum", "measure": measure},
        ],
        "front": plans,
        "actor": None,
    }


def open_stored(page: Page, measure: str, values: list[float]) -> None:
    """Open a stored front by a link that has its request, and wait until it is shown."""
    objectives = [REQUEST["objectives"][0], {"name": measure, "measure": measure}]
    open_answer(page, objectives, answer(measure, values))


def open_answer(page: Page, objectives: list[Any], front: dict[str, Any]) -> None:
    """Open a stored answer by a link that has its request."""
    open_stored_answer(page, {**REQUEST, "objectives": objectives}, front)


@pytest.fixture(scope="module")
def late(browser: Browser, released: str) -> Iterator[Page]:
    """The page with a front of lateness, from one late plan to one that is in time."""
    with open_unplanned(browser, released) as page:
        open_stored(page, "lateness", [13.0 * MINUTE, 0.0])
        yield page


def select(page: Page, key: str) -> None:
    page.get_by_role("slider", name="Balance").press(key)
    wait_for_next_frame(page)


def rows(page: Page) -> dict[str, list[str]]:
    """The table of lengths and measures, by the name of each row without the note below it."""
    lines = page.locator("#comparison tbody tr").all()
    cells = [line.locator("th, td").all_inner_texts() for line in lines]
    return {name.splitlines()[0]: others for name, *others in cells}


def test_a_plan_says_its_measures_and_how_much_another_differs(late: Page) -> None:
    select(late, "Home")
    late.get_by_role("button", name="Keep to compare").click()
    select(late, "End")
    found = rows(late)
    late.get_by_role("button", name="Stop comparing").click()
    assert found == {
        "Distance": ["5,000 m", "4,000 m", "+25.0 %"],
        "Lateness": ["0 min", "13 min", f"{MINUS}13 min"],
        "Vehicles used": ["2", "1", "+1"],
        "Driving in all": ["50 min", "50 min", "same"],
        "At stops in all": ["5 min", "5 min", "same"],
        "Waiting in all": ["0 min", "35 min", f"{MINUS}35 min"],
        "Overtime in all": ["0 min", "0 min", "same"],
        "Longest route": ["1 h 5 min", "1 h 5 min", "same"],
        "Shortest route": ["1 h 5 min", "1 h 5 min", "same"],
        "Longest minus shortest": ["0 min", "0 min", "same"],
        "Prizes left out": ["0 m", "900 m", f"{MINUS}900 m"],
    }


def test_a_total_and_the_longest_route_say_what_they_count(window: Page) -> None:
    """The longest of two routes of 65 minutes has 25 minutes of driving, of 50 in all."""
    objectives = [
        {"name": "driving", "from": "road_time"},
        {"name": "longest route", "from": "road_time", "over": "max"},
    ]
    routes = [
        {**each, "lengths": [25.0 * MINUTE, length]}
        for each, length in zip(IN_TIME["routes"], (30.0 * MINUTE, 35.0 * MINUTE), strict=True)
    ]
    plans = [
        {**IN_TIME, "routes": routes, "lengths": [50.0 * MINUTE, 35.0 * MINUTE], "balance": 0.0},
        {**IN_TIME, "routes": routes, "lengths": [60.0 * MINUTE, 30.0 * MINUTE]},
    ]
    named = [{**each, "unit": "s"} for each in objectives]
    front = {**answer("lateness", [0.0, 0.0]), "front": plans, "objectives": named}
    open_answer(window, objectives, front)
    select(window, "Home")
    heads = window.locator("#comparison tbody:first-of-type th").all_inner_texts()
    assert heads == [
        "Driving\nall vehicles together",
        "Longest route\nvan, day 2: 30 min driving, 5 min at stops",
    ]
    expect(window.locator("#choice")).to_have_text(
        "The least driving. Every other plan makes the longest route shorter, for more driving."
        " The last vehicle is back at day 2, 9:35."
    )
    expect(window.get_by_role("button", name="longest route kept short")).to_be_visible()
    expect(window.locator("#less-2")).to_have_text("longest route shorter")
    select(window, "End")
    expect(window.locator("#choice")).to_have_text(
        "20 % more driving (10 min) than the least,"
        " and the longest route is 14 % shorter (5 min): the shortest of all plans found."
        " The last vehicle is back at day 2, 9:35."
    )
    titles = window.locator("#fleet-legend thead th").all_inner_texts()
    assert titles[2:] == ["Sets off", "Back", "Driving", "Whole route"]
    assert window.locator("#fleet-legend tfoot td").all_inner_texts()[-1] == "30 min, the longest"


def test_the_column_of_an_imbalance_is_named_after_what_its_rows_have(window: Page) -> None:
    open_stored(window, "imbalance", [13.0 * MINUTE, 0.0])
    window.locator("#balance").press("Home")
    titles = window.locator("#fleet-legend thead th").all_inner_texts()
    assert titles[-1].startswith("Whole route")
    last = window.locator("#fleet-legend tfoot td").last
    expect(last).to_have_text("13 min, longest minus shortest")
    head, *_ = saved(window, "CSV").decode().splitlines()
    assert head.endswith(",route distance (m),whole route (s),leaves,back,stops,selected")


def test_lateness_is_said_as_a_time(late: Page) -> None:
    select(late, "End")
    expect(late.locator("#choice")).to_have_text(
        "25 % more distance (1,000 m) than the least, for 13 min less lateness: none at all."
        " The last vehicle is back at day 2, 9:35."
    )
    chart = late.get_by_label(re.compile("A choice of 2 plans"))
    expect(chart).to_have_attribute("aria-label", re.compile("lateness from 0 min to 13 min$"))
    assert "13 min" in saved(late, "SVG").decode()


def test_a_stop_says_why_it_is_late_by_a_click_and_by_keys(late: Page) -> None:
    select(late, "Home")
    said = late.locator("#fleet-stop")
    why = (
        "order-17: window 8:00 to 10:00, due 9:12, begins 9:25, 13 min late;"
        " van, day 1, arrives at 9:25 from order-9."
    )
    late.locator("#fleet-lanes .visit").nth(2).click()
    expect(said).to_have_text(why)
    expect(late.locator("#fleet-lanes .window")).to_have_count(1)
    expect(late.locator("#fleet-lanes .late")).to_have_count(1)
    late.keyboard.press("ArrowRight")
    late.keyboard.press("Enter")
    expect(said).to_have_text(
        "depot: van, day 1, loads again at 10:00, when its load is released;"
        " it arrives at 9:35 from order-17 and waits 25 min."
    )
    box = late.locator("#plane-1")
    box.focus()
    for key in ("Escape", "Enter", "Enter"):
        box.press(key)
    expect(said).to_contain_text("order-9: begins 9:10")
    box.press("Enter")
    expect(said).to_have_text(why)
    expect(late.locator("#fleet-lanes [aria-pressed=true]")).to_have_attribute(
        "aria-label", "van, day 1, order-17, 9:25, 13 min late, window 8:00 to 10:00, due 9:12"
    )
    box.press("Enter")
    box.press("Enter")
    expect(said).to_have_text("far is left out of this plan.")
    # The same stop stays chosen in another plan.
    select(late, "End")
    expect(said).to_contain_text("far: window 9:00 to 9:30, begins 9:10")
    expect(late.locator("#stop-help")).to_contain_text("far is chosen. Drag it")


def test_routes_name_their_day_and_count_no_depot_as_a_stop(late: Page) -> None:
    select(late, "Home")
    assert late.locator("#fleet-legend tbody tr").inner_text().split("\t")[:2] == [
        "van, day 1",
        "3",
    ]
    select(late, "End")
    names = late.locator("#fleet-legend tbody th").all_inner_texts()
    assert names == ["van, day 1", "van, day 2"]
    second = late.locator("#fleet-stops > li").nth(1).locator("li").all_text_contents()
    assert second[:2] == ["depot day 2, 9:00", "order-9 day 2, 9:10"]


def test_exports_have_the_shift_and_the_depot_in_the_middle(late: Page) -> None:
    select(late, "Home")
    head, first, *_ = saved(late, "CSV").decode().splitlines()
    assert head.split(",")[4:6] == ["vehicle", "shift"]
    assert first.split(",")[4:6] == ["van", "0"]
    assert first.endswith(",depot order-9 order-17 depot order-4 depot,yes")
    program = copied(late, "as Python")
    compile(program, "program", "exec")
    assert '"measure": "lateness"' in program


@pytest.mark.parametrize("scheme", few(1, ["dark", "light"]))
def test_axe_finds_nothing_in_the_lanes(late: Page, scheme: Any) -> None:
    late.emulate_media(color_scheme=scheme)
    select(late, "Home")
    late.locator("#fleet-lanes .visit").nth(2).click()
    check_on_a_phone(late, "#fleet")
    late.emulate_media(color_scheme="light")


def test_vehicles_are_counted(window: Page) -> None:
    open_stored(window, "vehicles", [7.0, 5.0])
    select(window, "Home")
    expect(window.locator("#choice")).to_contain_text(
        "The least distance. Every other plan has fewer vehicles, for more distance."
    )
    select(window, "End")
    expect(window.locator("#choice")).to_contain_text(
        "25 % more distance (1,000 m) than the least,"
        " for 2 fewer vehicles: the fewest of all plans found."
    )
    expect(window.get_by_role("button", name="fewest vehicles")).to_be_visible()
    line = window.get_by_role("slider", name="At most this many vehicles")
    line.press("Home")
    expect(window.locator("#budget")).to_have_text("Budget: 5 vehicles.")
    assert rows(window)["Vehicles"][0] == "5"
    drawing = saved(window, "SVG").decode()
    assert not re.search(r">[567]\.\d+<", drawing)


def test_what_is_carried_is_said_in_words(window: Page) -> None:
    front = answer("load_distance", [1_234_000.0, 800_000.0])
    front["objectives"][1]["name"] = "load carried"
    asked = [REQUEST["objectives"][0], {"name": "load carried", "measure": "load_distance"}]
    name = "Load carried, load-km"
    open_answer(window, asked, front)
    select(window, "Home")
    window.get_by_role("button", name="Keep to compare").click()
    select(window, "End")
    assert rows(window)[name][:2] == ["800", "1,230"]
    assert f">{name}<" in saved(window, "SVG").decode()
    expect(window.locator("#choice")).to_contain_text("less load carried")
