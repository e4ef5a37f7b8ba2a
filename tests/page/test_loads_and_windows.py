"""Full vehicles and tight windows of plans on the page."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, Request, Response, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    CUT_OFF,
    needs_chromium,
    open_files,
    open_unplanned,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.stored_answers import open_stored_answer

pytestmark = needs_chromium

HOUR, MINUTE = 3600, 60
WIDTHS = (320, 375, 480, 561, 768, 861, 1024, 1440, 1920)  # of a window in pixels
PLACES = [[24.941, 60.171], [24.952, 60.169], [24.933, 60.165], [24.925, 60.18], [24.96, 60.175]]
NAMES = ["depot", "order-1", "order-2", "order-3", "order-4"]
# Of each order: demand, and from when to when it is open.
ORDERS = [
    ([7, 300], [8 * HOUR, 9 * HOUR + 15 * MINUTE]),  # reached five minutes before it closes
    ([6, 250], [8 * HOUR, 9 * HOUR + 26 * MINUTE]),  # six minutes
    ([5, 1_000], [9 * HOUR + 45 * MINUTE, 9 * HOUR + 48 * MINUTE]),  # after a wait of ten minutes
    ([9, 1_100], [8 * HOUR, 10 * HOUR + 30]),  # half a minute
]
REQUEST: dict[str, Any] = {
    "stops": [
        {"id": name, "location": place, **asked}
        for name, place, asked in zip(
            NAMES,
            PLACES,
            [{}, *({"demand": demand, "window": window} for demand, window in ORDERS)],
            strict=True,
        )
    ],
    "vehicles": [
        {"id": "van", "start": "depot", "end": 0, "capacity": [20, 1_500], "reload": ["depot"]}
    ],
    "objectives": [
        {"name": "time", "from": "great_circle", "speed": 30},
        {"name": "Travel time", "from": "great_circle", "speed": 30, "over": "max"},
    ],
    "clock": {"unit": "s", "matrix": [[600] * 5] * 5},
}
STOPS = ["depot", "order-1", "order-2", "depot", "order-3", "order-4", "depot"]
ARRIVALS = [
    hour * HOUR + minute * MINUTE
    for hour, minute in ((9, 0), (9, 10), (9, 20), (9, 27), (9, 35), (10, 0), (10, 10))
]


def answer(request: dict[str, Any], stops: list[str] = STOPS) -> dict[str, Any]:
    """Return a stored front of two plans, whose only route has these stops."""
    total, longest = 3_600.0, 4_200.0
    route = {"vehicle": "van", "stops": stops, "lengths": [total, longest], "arrivals": ARRIVALS}
    measures = {"vehicles": 1, "driving": total, "service": 0.0, "waiting": 600.0}
    plans = [
        {"balance": balance, "measures": measures, "routes": [route], "unassigned": []}
        for balance in (0.0, 1.0)
    ]
    lengths = [[total, longest], [total + 60, longest - 60]]
    return {
        **{"id": 32 * "b", "status": "done", "kind": "fleet", "cities": 5, "points": 2},
        **{"hypervolume": 0.5, "hypervolume_bound": None, "reference_point": [9000, 9000]},
        **{"scale": [1, 1], "timings_ms": {"total": 200}, "terminated": "time_limit"},
        "stops": [{"id": each["id"], "location": each["location"]} for each in request["stops"]],
        "objectives": [{"over": "sum", "unit": "s", **each} for each in request["objectives"]],
        "front": [{**plan, "lengths": each} for plan, each in zip(plans, lengths, strict=True)],
        "actor": None,
    }


@pytest.fixture(scope="module")
def shown(browser: Browser, released: str) -> Iterator[Page]:
    """The page with a plan that is full and late in some windows."""
    with open_unplanned(browser, released) as page:
        open_stored_answer(page, REQUEST, answer(REQUEST))
        yield page


def loads(page: Page) -> list[str]:
    """The loads in the table of routes, which has a column for them."""
    expect(page.locator("#fleet-legend thead th").nth(2)).to_have_text("Load")
    return page.locator("#fleet-legend tbody td:nth-child(3)").all_inner_texts()


def test_stops_that_are_reached_just_before_they_close_say_so(shown: Page) -> None:
    shown.locator("#fleet details").evaluate("details => details.open = true")
    expect(shown.locator("#fleet-stops ol li")).to_have_text(
        [
            "depot 9:00",
            "order-1 9:10, window 8:00 to 9:15, 5 min before its window closes",
            "order-2 9:20, window 8:00 to 9:26",
            "depot 9:27",
            "order-3 9:35, waits until 9:45, window 9:45 to 9:48",
            "order-4 10:00, window 8:00 to 10:01, less than 1 min before its window closes",
            "depot 10:10",
        ]
    )
    expect(shown.locator("#fleet-lanes .tight")).to_have_count(2)
    expect(shown.locator("#fleet-signs .tight")).to_have_text(
        "the stop above it begins at most 5 min before its window closes"
    )
    stop = shown.locator("#fleet-lanes").get_by_role("button", name="order-1")
    expect(stop).to_have_attribute(
        "aria-label", "van, order-1, 9:10, window 8:00 to 9:15, 5 min before its window closes"
    )
    stop.click()
    expect(shown.locator("#fleet-stop")).to_have_text(
        "order-1: window 8:00 to 9:15, begins 9:10, 5 min before its window closes;"
        " van arrives at 9:10 from depot."
    )


def test_a_vehicle_says_the_most_that_it_carries_of_what_it_can(shown: Page) -> None:
    """The second of two trips is the fuller one: 14 and 2,100, where the first has 13 and 550."""
    assert loads(shown) == ["14 of 20 at once, 2,100 of 1,500 at once"]


@pytest.mark.parametrize(
    ("vehicle", "others", "said"),
    [
        (
            {"initial_load": [10, 5], "reload": ["depot"]},
            {},
            "23 of 20 at once, 2,100 of 1,500 at once",
        ),
        # What is picked up at order 2 comes on board after order 1.
        ({}, {"shipments": [{"pickup": 2, "delivery": "order-3"}]}, "16 of 20, 1,400 of 1,500"),
    ],
    ids=["load at start", "shipments"],
)
def test_loads_at_the_start_and_on_the_way_are_counted(
    window: Page, vehicle: dict[str, Any], others: dict[str, Any], said: str
) -> None:
    van = {"id": "van", "start": "depot", "end": "depot", "capacity": [20, 1_500], **vehicle}
    request = {**REQUEST, "vehicles": [van], **others}
    open_stored_answer(window, request, answer(request))
    assert loads(window) == [said]


def test_vehicles_without_a_capacity_have_no_column_of_loads(window: Page) -> None:
    request = {**REQUEST, "vehicles": [{"id": "van", "start": "depot", "end": "depot"}]}
    open_stored_answer(window, request, answer(request))
    titles = window.locator("#fleet-legend thead th").all_inner_texts()
    assert titles == ["Vehicle", "Stops", "Sets off", "Back", "Time", "Whole route"]


def test_a_time_says_what_it_counts(shown: Page) -> None:
    """A total says that it is the driving; the time of the longest route is called by that name."""
    heads = shown.locator("#comparison tbody:first-of-type th").all_inner_texts()
    assert heads == ["Time\ndriving only", "Longest route\nvan: 1 h driving, 10 min waiting"]
    expect(shown.get_by_role("button", name="longest route kept short")).to_be_visible()


def test_neither_loads_nor_windows_are_cut_off(shown: Page) -> None:
    for width in WIDTHS:
        shown.set_viewport_size({"width": width, "height": 900})
        wait_for_next_frame(shown)
        assert shown.evaluate(CUT_OFF) == [], width
    check_on_a_phone(shown, "#fleet")


def test_a_fleet_is_only_searched(window: Page) -> None:
    """The network may have no plan for it, and its refusal would be an error in the console."""
    half_an_hour = [8 * HOUR, 8 * HOUR + 30 * MINUTE]
    stops = [{**each, "demand": [1], "window": half_an_hour} for each in REQUEST["stops"][1:]]
    objectives = [
        {"name": "distance", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": 30, "over": "max"},
    ]
    request = {
        "stops": [REQUEST["stops"][0], *stops],
        "vehicles": [{"id": "van", "count": 4, "start": "depot", "end": "depot", "capacity": [4]}],
        **{"objectives": objectives, "clock": "time", "time_limit": 0.2},
    }
    sent: list[float] = []
    refused: list[str] = []

    def note_request(each: Request) -> None:
        if each.url.endswith("/fleet"):
            sent.append(json.loads(each.post_data or "")["time_limit"])

    def note_response(each: Response) -> None:
        if each.status >= 400:
            refused.append(each.url)

    open_files(window, {"fleet.json": json.dumps(request)})
    window.on("request", note_request)
    window.on("response", note_response)
    window.get_by_role("button", name="Plan", exact=True).click()
    expect(window.locator("#fleet")).to_be_visible()
    wait_until_planned(window)
    window.remove_listener("request", note_request)
    window.remove_listener("response", note_response)
    expect(window.locator("#will-plan")).to_contain_text("Distance against longest route")
    assert sent == [0.2]
    assert refused == []
