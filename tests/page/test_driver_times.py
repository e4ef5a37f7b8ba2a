"""The times that the page gives drivers: of a stored plan, whose every minute is known."""

import csv
import io
import json
from collections.abc import Iterator
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    needs_chromium,
    open_files,
    open_unplanned,
    saved,
    wait_until_planned,
)
from tests.helpers.node import Node
from tests.helpers.stored_answers import open_stored_answer

pytestmark = needs_chromium

GPX = "{http://www.topografix.com/GPX/1/1}"


def at(time: str) -> int:
    """Return a time of the day in seconds."""
    hours, minutes = map(int, time.split(":"))
    return 3600 * hours + 60 * minutes


def span(begin: str, end: str) -> list[int]:
    return [at(begin), at(end)]


STOPS: list[dict[str, Any]] = [
    {"id": "depot"},
    {"id": "A", "demand": [2], "service": 300, "window": span("8:15", "9:00")},
    {"id": "B", "service": 600, "windows": [span("9:00", "10:00"), span("14:00", "15:00")]},
    {"id": "C", "due": at("9:00")},
    {"id": "D", "service": 300, "window": span("8:40", "9:30")},
    {"id": "E", "service": 300},
]
BASE = {"start": "depot", "end": "depot"}
VEHICLES: list[dict[str, Any]] = [
    {
        **BASE,
        "id": "van",
        "count": 2,
        "shift": span("7:30", "17:00"),
        "breaks": [{"window": span("9:05", "9:30"), "length": 900}],
    },
    {
        **BASE,
        "id": "van 1",
        "shift": span("8:00", "17:00"),
        "breaks": [
            {"window": span("7:00", "7:30"), "length": 600},
            {"window": span("8:00", "8:20"), "length": 1200},
        ],
    },
    {"id": "bike", "shift": span("7:30", "17:00")},
]
REQUEST: dict[str, Any] = {
    "stops": [
        {**stop, "location": [24.94 + place / 100, 60.17]} for place, stop in enumerate(STOPS)
    ],
    "vehicles": VEHICLES,
    "objectives": [
        {"name": "driving", "from": "road_time"},
        {"name": "longest route", "from": "road_time", "over": "max"},
    ],
    "clock": {"unit": "s", "matrix": [[600] * 6] * 6},
}


def route(vehicle: str, visits: str, *breaks: str) -> dict[str, Any]:
    """Return a route by its stops and arrivals, such as "depot 8:05, A 8:15"."""
    stops, arrivals = zip(*(each.split() for each in visits.split(", ")), strict=True)
    taken = {"breaks": [at(each) for each in breaks]} if breaks else {}
    times = [at(each) for each in arrivals]
    lengths = [600.0 * (len(stops) - 1), float(times[-1] - times[0])]
    return {
        "vehicle": vehicle,
        "stops": list(stops),
        "lengths": lengths,
        "arrivals": times,
        **taken,
    }


ROUTES = [
    route("van", "depot 8:05, A 8:15, B 8:30, depot 9:35", "9:10"),
    route("van", "depot 7:30, C 7:40, depot 7:50"),
    route("van 1", "depot 8:00, D 8:10, depot 8:55", "8:10"),
    route("bike", "E 10:00"),
]
NAMES = ["van 2", "van 3", "van 1", "bike"]
ANSWER: dict[str, Any] = {
    **{"id": 32 * "b", "status": "done", "kind": "fleet", "cities": 6, "points": 1},
    **{"hypervolume": 0.5, "hypervolume_bound": None, "reference_point": [9000, 9000]},
    **{"scale": [1, 1], "timings_ms": {"total": 200}, "terminated": "time_limit", "actor": None},
    "stops": [{"id": each["id"], "location": each["location"]} for each in REQUEST["stops"]],
    "objectives": [
        {"name": "driving", "unit": "s", "over": "sum"},
        {"name": "longest route", "unit": "s", "over": "max"},
    ],
    "front": [
        {
            "balance": 0.0,
            "lengths": [4200.0, 5400.0],
            "routes": ROUTES,
            "unassigned": [],
        }
    ],
}
TWICE = "9:00 to 10:00 or 14:00 to 15:00"
WHY = "Sets off at 8:05, to be at A when its window opens at 8:15. The shift begins at 7:30."


@pytest.fixture(scope="module")
def stored(browser: Browser, released: str) -> Iterator[Page]:
    """The page with the stored plan, for tests that only look."""
    with open_unplanned(browser, released) as page:
        open_stored_answer(page, REQUEST, ANSWER)
        yield page


def given(page: Page, name: str) -> str:
    """Return the text of the file that a button saves."""
    with page.expect_download() as download:
        page.get_by_role("button", name=name).click()
    return download.value.path().read_text()


def test_each_visit_has_its_window_arrival_waiting_break_and_leaving(stored: Page) -> None:
    rows = csv.DictReader(io.StringIO(given(stored, "Save the stops of the selected tour")))
    times = ("window", "arrives", "waits", "break", "leaves", "load")
    found = [(row["vehicle"], row["stop"], *(row[each] for each in times)) for row in rows]
    assert found == [
        ("van 2", "depot", "", "", "", "", "8:05", ""),
        ("van 2", "A", "8:15 to 9:00", "8:15", "", "", "8:20", "2"),
        ("van 2", "B", TWICE, "8:30", "30 min", "9:10 to 9:25", "9:25", ""),
        ("van 2", "depot", "", "9:35", "", "", "", ""),
        ("van 3", "depot", "", "", "", "", "7:30", ""),
        ("van 3", "C", "due 9:00", "7:40", "", "", "7:40", ""),
        ("van 3", "depot", "", "7:50", "", "", "", ""),
        ("van 1", "depot", "", "", "", "", "8:00", ""),
        ("van 1", "D", "8:40 to 9:30", "8:10", "10 min", "8:10 to 8:30", "8:45", ""),
        ("van 1", "depot", "", "8:55", "", "", "", ""),
        ("bike", "E", "", "10:00", "", "", "10:05", ""),
    ]


def test_vehicles_have_the_same_names_in_files_lanes_and_tables(stored: Page) -> None:
    gpx = ElementTree.fromstring(given(stored, "Save the selected tour as GPX"))
    assert [each.findtext(f"{GPX}name") for each in gpx.findall(f"{GPX}rte")] == NAMES
    front = csv.DictReader(io.StringIO(saved(stored, "CSV").decode()))
    assert [row["vehicle"] for row in front] == NAMES
    assert stored.locator("#fleet-legend tbody th").all_inner_texts() == NAMES
    assert stored.locator("#fleet-stops b").all_text_contents() == NAMES
    assert stored.locator("#fleet-lanes .name").all_text_contents() == NAMES


def test_each_vehicle_says_when_it_leaves_and_when_it_is_back(stored: Page) -> None:
    hours = [("8:05", "9:35"), ("7:30", "7:50"), ("8:00", "8:55"), ("10:00", "10:05")]
    expect(stored.locator("#choice")).to_contain_text("The last vehicle is done at 10:05.")
    cells = [row.split("\t") for row in stored.locator("#fleet-legend tr").all_inner_texts()]
    places = [cells[0].index(title) for title in ("Sets off", "Back")]
    assert [tuple(row[at] for at in places) for row in cells[1:-1]] == hours
    assert [cells[-1][at] for at in places] == ["7:30, the first", "10:05, the last"]
    front = csv.DictReader(io.StringIO(saved(stored, "CSV").decode()))
    assert [(row["leaves"], row["back"]) for row in front] == hours


def test_gpx_says_the_times_of_each_point(stored: Page) -> None:
    gpx = ElementTree.fromstring(given(stored, "Save the selected tour as GPX"))
    said = [each.findtext(f"{GPX}desc") for each in gpx.iter(f"{GPX}rtept")]
    assert said[:2] == ["leaves 8:05", "window 8:15 to 9:00, arrives 8:15, leaves 8:20"]
    assert said[3] == "arrives 9:35"


def test_a_vehicle_that_leaves_after_its_shift_begins_says_why(stored: Page) -> None:
    stored.evaluate("window.print = () => {}")
    stored.get_by_role("button", name="Print the stops of the selected tour").click()
    parts = stored.locator("#sheet section")
    assert parts.locator("h2").all_text_contents() == NAMES
    assert [parts.nth(at).locator("> p").last.text_content() for at in range(4)] == [
        WHY.replace(". The", "; back at 9:35. The"),
        "Sets off at 7:30, back at 7:50.",
        "Sets off at 8:00, back at 8:55.",
        "Sets off at 10:00, done at 10:05.",
    ]
    heads = [part.locator("thead td").all_text_contents() for part in parts.all()]
    assert heads[0] == ["", "stop", "window", "arrives", "waits", "break", "sets off", "load"]
    assert heads[3] == ["", "stop", "arrives", "sets off"]
    assert stored.locator("#fleet-lanes g:has(> .name) > title").all_text_contents() == [WHY]
    stored.locator("#fleet-lanes .visit").first.click()
    expect(stored.locator("#fleet-stop")).to_have_text(
        "depot: van 2 sets off at 8:05, to be at A when its window opens at 8:15;"
        " its shift begins at 7:30."
    )


def test_breaks_are_said_of_a_stop_and_of_the_longest_route(stored: Page) -> None:
    stored.locator("#fleet-lanes").get_by_role("button", name="D, 8:40").click()
    expect(stored.locator("#fleet-stop")).to_have_text(
        "D: window 8:40 to 9:30, begins 8:40; van 1 arrives at 8:10 from depot and waits 10 min"
        " for the window to open; the driver has a break from 8:10 to 8:30."
    )
    expect(stored.locator("#comparison tbody:first-of-type th").nth(1)).to_contain_text(
        "van 2: 30 min driving, 15 min at stops, 30 min waiting, 15 min in breaks"
    )


def test_a_vehicle_of_any_plan_drives_from_leaving_to_the_next_arrival(window: Page) -> None:
    """Each drive takes ten minutes; the breaks are between a stop at eight and one at eleven."""
    windows = [span("8:00", "8:30"), *[span(f"{8 + k % 3}:00", "12:00") for k in range(5)]]
    stops: list[dict[str, Any]] = [
        {"id": f"s{k}", "service": 60 * (k % 4), "window": opens}
        for k, opens in enumerate([*windows, span("11:00", "12:00")])
    ]
    breaks = [
        {"window": span("9:00", "9:30"), "length": 900},
        {"window": span("10:00", "10:10"), "length": 600},
    ]
    shift = span("7:00", "17:00")
    request = {
        "stops": [{"id": "depot"}, *stops],
        "vehicles": [{**BASE, "id": "van", "shift": shift, "breaks": breaks}],
        "objectives": [
            {"name": "time", "unit": "s", "matrix": [[600] * 8] * 8},
            {"name": "longest", "unit": "s", "matrix": [[600] * 8] * 8, "over": "max"},
        ],
        "clock": "time",
        "time_limit": 0.3,
    }
    open_files(window, {"fleet.json": json.dumps(request)})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    rows = list(csv.DictReader(io.StringIO(given(window, "Save the stops of the selected tour"))))
    assert len(rows) == len(stops) + 2
    assert sum(row["break"].count(" to ") for row in rows) == len(breaks)
    for row, following in pairwise(rows):
        assert at(following["arrives"]) == pytest.approx(at(row["leaves"]) + 600, abs=60), rows


def closing(arrives: str, closes: str, stop: str) -> dict[str, Any]:
    return {**visit(arrives, arrives, stop=stop), "closes": at(closes), "by": at(closes)}


WAITING = """async (before) => {
  const { knownFleet } = await import("./page/fleet/known_fleet.js");
  const { visitTimes } = await import("./page/fleet/visit_times.js");
  const { visitSentence } = await import("./page/fleet/visit_sentence.js");
  const stops = ["A", "C", "B"].map((id) => ({ id }));
  const known = knownFleet({ stops, vehicles: [{ id: "van" }], before });
  const route = { vehicle: "van", stops: ["B"], arrivals: [5], ends: [20] };
  const visits = visitTimes(route, known).map((visit) => ({ ...visit, closing: "" }));
  const clock = { said: (time) => `${time} h`, lasting: (time) => `${time} h` };
  return visitSentence({ name: "van", visits }, 0, clock);
}"""


@pytest.mark.parametrize(
    ("before", "said"),
    [
        ([{"first": [0], "then": ["B"], "vehicles": "any"}], "waits 15 h until A is done."),
        ([{"first": [0, "C"], "then": [2], "vehicles": "any"}], "until A and C are done."),
        ([{"first": [0], "then": ["B"]}], "arrives at 5 h."),  # on one route
    ],
)
def test_a_vehicle_waits_until_others_are_done(node: Node, before: list[Any], said: str) -> None:
    assert node.evaluate(WAITING, before).endswith(said)


NOTE = """async (visits) => {
  const { departureNote } = await import("./page/fleet/visit_sentence.js");
  const minutes = (time) => String((time / 60) % 60).padStart(2, "0");
  return departureNote(visits, (time) => `${Math.floor(time / 3600)}:${minutes(time)}`);
}"""


def visit(arrives: str, begins: str, opens: str = "", stop: str = "A") -> dict[str, Any]:
    """What a vehicle does at a stop, which opens as it begins if that is said."""
    arrival, begin = at(arrives), at(begins)
    times = {"stop": stop, "arrival": arrival, "begin": begin, "waiting": begin - arrival}
    return {**times, **({"opens": at(opens)} if opens else {})}


@pytest.mark.parametrize(
    ("visits", "why"),
    [
        ([visit("8:15", "8:15", "8:15")], ", to be at A when its window opens at 8:15"),
        (
            [visit("8:10", "8:10"), visit("8:15", "8:15", "8:15", "B")],
            ", to be at B when its window opens",
        ),
        # Later than that it would be late, and so it waits at the next stop all the same.
        (
            [closing("8:15", "8:15", "B"), visit("8:20", "9:01")],
            " for B, whose window closes at 8:15",
        ),
        (
            [visit("8:10", "8:10", "8:10"), closing("8:15", "8:15", "B"), visit("8:20", "9:01")],
            " for B, whose window closes at 8:15",
        ),
        ([closing("8:15", "8:40", "B"), visit("8:20", "9:01")], ""),
        (  # with ten minutes in hand
            [{**closing("8:15", "8:25", "B"), "by": at("8:15")}, visit("8:20", "9:01")],
            " for B, whose window closes at 8:25 and must be reached by 8:15",
        ),
        (
            [{**visit("8:15", "8:20", "8:20", "B"), "closes": at("8:22"), "by": at("8:15")}],
            " for B, whose window closes at 8:22 and must be reached by 8:15",
        ),
        ([visit("8:10", "8:15", "8:15")], ""),  # it waits there
        ([visit("8:10", "8:12"), visit("8:15", "8:15", "8:15", "B")], ""),  # or before
        ([{**visit("8:15", "8:15", "8:15"), "waiting": 20}], ""),  # for some seconds
        ([visit("8:15", "8:15")], ""),
    ],
)
def test_a_vehicle_leaves_for_the_stop_that_keeps_it_from_leaving_later(
    node: Node, visits: list[dict[str, Any]], why: str
) -> None:
    start = {**visit("8:05", "8:05", stop="depot"), "shift": at("7:30"), "released": 0}
    said = node.evaluate(NOTE, [start, *visits])
    assert said.startswith(f"Sets off at 8:05{why}")
    assert why or said.startswith("Sets off at 8:05. ")
