"""A typo in a field, or a value that is refused: the plan stays, and the field says why."""

import json

import pytest
from playwright.sync_api import Locator, Page, Request, expect

from tests.helpers.browsing import (
    DESK,
    PHONE,
    copied,
    curl_body,
    needs_chromium,
    open_files,
    open_link,
    saved,
    shown_front,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.sampled import few

pytestmark = needs_chromium

PLANES = "0,0,5,5\n3,1,9,1\n5,2,2,8\n"
NAMED = "name,x,y,u,v\ndepot,0,0,5,5\nshop,3,1,9,1\nschool,5,2,2,8\n"
ON_EARTH = "id,lon,lat,risk\ndepot,24.94,60.17,1\nshop,24.95,60.18,2\nschool,24.93,60.16,3\n"
FLEET = json.dumps(
    {
        "stops": [
            {"id": "depot", "location": [24.94, 60.17]},
            {"id": "shop", "location": [24.95, 60.18], "demand": [2]},
            {
                "id": "school",
                "location": [24.93, 60.16],
                "demand": [3],
                "window": [28800, 43200],
                "service": 300,
            },
        ],
        "vehicles": [{"id": "van", "count": 2, "start": "depot", "end": "depot", "capacity": [8]}],
        "objectives": [
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "from": "great_circle", "speed": 30, "over": "max"},
        ],
        "clock": "time",
    }
)
DAY = json.dumps(
    {
        "stops": [
            {"id": f"order-{k}", "location": [24.93 + k % 3 / 100, 60.16 + k % 4 / 100]}
            for k in range(7)
        ],
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {
                "name": "time",
                "from": "great_circle",
                "speed": 30,
                "over_the_day": [[25200, 1], [27000, 1.6]],
            },
        ],
        "departure": {"earliest": 25200, "latest": 30600},
    }
)
MAP = json.dumps(
    {
        "grid": [[0] * 12] * 12,
        "cell_size": 1,
        "robot_radius": 0.1,
        "cost_layer": [[row * column % 5 for row in range(12)] for column in range(12)],
        "places": [[1, 1], [1, 9], [9, 5]],
    }
)
SERVED = FLEET.replace('"demand": [2]', '"demand": [2], "vehicle": "van"')
LAYERED = json.dumps(
    {
        "grid": [[0] * 12] * 12,
        "cell_size": 1,
        "spacing": 5,
        "cost_layers": [
            {"name": "noise", "layer": [list(range(12))] * 12},
            {"name": "dust", "layer": [[row] * 12 for row in range(12)]},
        ],
    }
)
RADIUS = "Robot\N{RIGHT SINGLE QUOTATION MARK}s radius, m"
SPEED = "Speed of the second objective, km/h"


def plan(page: Page) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()


def planned_choice(page: Page) -> str:
    """Plan by the network alone, and return the sentence about the selected tour."""
    page.get_by_label("Seconds of planning").fill("0")
    plan(page)
    wait_until_planned(page)
    expect(page.locator("#choice")).not_to_be_empty()
    return page.locator("#choice").inner_text()


def write(page: Page, label: str, text: str) -> None:
    """Write a text into a field by its label, and leave it."""
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Tab")


def open_text(page: Page, content: str) -> None:
    open_files(page, {"stops.json" if content.startswith("{") else "stops.csv": content})


def named(page: Page, label: str) -> Locator:
    """The field with a label that is seen."""
    return page.get_by_label(label, exact=True).locator("visible=true")


def check_shown(page: Page, chosen: str) -> None:
    """Check that the plan is still shown, and can be saved."""
    expect(page.locator("#choice")).to_have_text(chosen)
    expect(page.get_by_role("button", name="Save JSON")).to_be_enabled()


def check_mended(page: Page) -> None:
    """Check that a request whose values are what they were is planned, and nothing is at fault."""
    plan(page)
    wait_until_planned(page)
    expect(page.locator(".fault:not(:empty)")).to_have_count(0)
    expect(page.locator("[aria-invalid=true]")).to_have_count(0)


# By form: fields, the fault beside them, and what it says of "6o.18".
TYPOS = {
    PLANES: [("x₂ of 2", "stops", "X₂ of stop 2 must be a valid number")],
    FLEET: [
        ("Latitude of shop", "stops", "Latitude of shop cannot be “6o.18”"),
        ("Count of van", "vehicles", "Count of van cannot be “6o.18”"),
        (SPEED, "objectives", "The speed of the second objective must be"),
    ],
    DAY: [
        ("Leaves at, or from", "departure", "Leaves at must be a time, as 7:30."),
        ("to", "departure-latest", "Leaves at must be a time, as 7:30."),
        ("Rush hours", "hours", "Rush hours must be times and factors in order"),
        ("Start", "start", "Start must be"),
        ("Seconds of planning", "time_limit", "Seconds of planning must be a valid number"),
    ],
    MAP: [
        ("Tours", "size", "Tours must be a valid integer"),
        ("Start", "start", "Start must be"),
        ("Metres a cell", "cell_size", "Metres a cell must be a valid number"),
        (RADIUS, "robot_radius", f"{RADIUS} must be a valid number"),
    ],
    NAMED: [("y₂ of shop", "stops", "Y₂ of shop must be a number")],
    ON_EARTH: [("Latitude of shop", "stops", "Latitude of shop must be a number")],
}


@pytest.mark.parametrize("content", few(3, TYPOS), ids=range(len(few(3, TYPOS))))
def test_a_typo_keeps_the_last_plan_and_is_said_at_its_field(window: Page, content: str) -> None:
    open_text(window, content)
    chosen = planned_choice(window)
    for label, fault, said in TYPOS[content]:
        field = named(window, label)
        before = field.input_value()
        field.fill("6o.18")
        plan(window)
        expect(window.locator(f"#{fault}-fault")).to_contain_text(said)
        expect(field).to_be_focused()
        expect(field).to_have_attribute("aria-invalid", "true")
        check_shown(window, chosen)
        field.fill(before)
        field.press("Tab")
        check_mended(window)


# By form: fields, what is typed, the fault beside them, and what it says.
REFUSED = {
    PLANES: [("First objective", "", "objectives", "Each objective needs a name of its own")],
    FLEET: [
        ("Count of van", "0", "vehicles", "Count of van cannot be “0”: write a whole"),
        ("Window of school", "12:00-8:00", "stops", "cannot be “12:00-8:00”: write two"),
        ("Name of stop 2", "school", "stops", "Each stop needs a name of its own"),
        ("Name of vehicle 1", "", "vehicles", "Each vehicle needs a name of its own"),
        ("Second objective", "distance", "objectives", "Each objective needs a name"),
        (SPEED, "-5", "objectives", "The speed of the second objective must be"),
        (
            "Start of van",
            "yard",
            "vehicles",
            "Start of van must be the name of a stop, got “yard”",
        ),
    ],
    SERVED: [
        (
            "Served by of shop",
            "bike",
            "stops",
            "Served by of shop must be the name of a vehicle, got “bike”",
        ),
        ("Served by of shop", "van 2", "stops", "“van 2”: give that vehicle a row of its"),
    ],
    LAYERED: [
        ("Name of cost layer 2", "noise", "cost_layers", "Each cost layer needs a name"),
        ("Name of cost layer 2", "distance", "cost_layers", "layer needs a name of its own"),
    ],
    DAY: [("Start", "order-8", "start", "Start must be the name of a stop")],
    NAMED: [
        ("Name of stop 2", "depot", "stops", "Each stop needs a name of its own"),
        ("Seconds of planning", "100000", "time_limit", "must be at most 60"),
    ],
    ON_EARTH: [("Latitude of shop", "95", "stops", "Latitude of shop must be")],
}


@pytest.mark.parametrize("content", few(3, REFUSED), ids=range(len(few(3, REFUSED))))
def test_a_value_that_is_refused_keeps_the_last_plan(window: Page, content: str) -> None:
    open_text(window, content)
    chosen = planned_choice(window)
    for label, typed, place, said in REFUSED[content]:
        field, fault = named(window, label), window.locator(f"#{place}-fault")
        before = field.input_value()
        field.fill(typed)
        field.press("Tab")
        expect(window.locator("#choice")).to_have_text(chosen)
        plan(window)
        expect(fault).to_contain_text(said)
        expect(fault).to_be_in_viewport(ratio=1)
        expect(field).to_be_focused()
        expect(field).to_have_attribute("aria-invalid", "true")
        check_shown(window, chosen)
        expect(window.locator("#status")).to_contain_text("Not planned: what is shown is the plan")
        field.fill(before)
        field.press("Tab")
        check_mended(window)


def test_seconds_that_are_refused_get_no_first_try_and_no_fault_once_mended(window: Page) -> None:
    open_files(window, {"stops.csv": NAMED})
    window.get_by_label("Seconds of planning").fill("100000")
    asked: list[float] = []

    def note(request: Request) -> None:
        if request.url.endswith("/front"):
            asked.append(request.post_data_json["time_limit"])

    window.on("request", note)
    plan(window)
    expect(window.locator("#time_limit-fault")).to_contain_text("must be at most 60")
    window.remove_listener("request", note)
    assert asked == [100_000]
    window.get_by_label("Seconds of planning").fill("3")
    expect(window.locator("#time_limit-fault")).to_be_empty()


def test_a_layer_is_named_as_another_was_once_that_name_is_free(window: Page) -> None:
    open_files(window, {"map.json": LAYERED})
    write(window, "Name of cost layer 2", "noise")
    expect(window.locator("#cost_layers-fault")).to_contain_text("name of its own, got “noise”")
    write(window, "Name of cost layer 1", "sound")
    expect(window.locator("#cost_layers-fault")).to_be_empty()
    layers = curl_body(window, "coverage")["cost_layers"]
    assert [each["name"] for each in layers] == ["sound", "noise"]
    write(window, "Name of cost layer 1", "noise")
    open_files(window, {"map.json": LAYERED})
    expect(window.get_by_label("Name of cost layer 1")).to_have_value("noise")
    expect(window.get_by_label("Name of cost layer 2")).to_have_value("dust")


@pytest.mark.parametrize(
    ("content", "label", "typed", "said", "name"),
    [
        (PLANES, "x₂ of 2", "6o", "X₂ of stop 2 must be a number.", "curl"),
        (ON_EARTH, "Latitude of shop", "95", "Latitude of shop must be a number.", "Python"),
        (FLEET, "Count of van", "two", "Count of van cannot be “two”: write a whole", "Python"),
        (DAY, "Leaves at, or from", "7.3o", "Leaves at must be a time, as 7:30.", "curl"),
        (PLANES, "End elsewhere", "shop", "End elsewhere must be the number of a stop.", "curl"),
        (MAP, RADIUS, "0,1o", f"{RADIUS} must be a number.", "Python"),
    ],
)
def test_no_request_is_copied_before_what_was_typed_is_mended(
    window: Page, content: str, label: str, typed: str, said: str, name: str
) -> None:
    open_text(window, content)
    window.evaluate("navigator.clipboard.writeText('before')")
    field = named(window, label)
    before = field.input_value()
    field.fill(typed)
    button = window.get_by_role("button", name=f"Copy as {name}")
    button.click()
    expect(window.locator("#link-help")).to_contain_text(f"Mend this first, to copy it: {said}")
    expect(button).to_have_text(name)
    expect(field).to_be_focused()
    expect(field).to_have_attribute("aria-invalid", "true")
    assert window.evaluate("navigator.clipboard.readText()") == "before"
    field.fill(before)
    assert copied(window, f"as {name}").startswith(("curl ", "from paretour"))
    expect(window.locator("#link-help")).to_be_empty()


def test_a_name_that_was_taken_is_taken_over_once_it_is_free(window: Page) -> None:
    open_files(window, {"stops.json": FLEET})
    write(window, "Name of stop 3", "shop")
    expect(window.locator("#stops-fault")).to_contain_text("Each stop needs a name of its own")
    write(window, "Name of stop 1", "yard")
    expect(window.locator("#stops-fault")).to_contain_text("Each stop needs a name of its own")
    write(window, "Name of stop 2", "store")
    expect(window.locator("#stops-fault")).to_be_empty()
    stops = curl_body(window, "fleet")["stops"]
    assert [each["id"] for each in stops] == ["yard", "store", "shop"]
    write(window, "Name of stop 3", "store")
    window.get_by_label("Service of shop").focus()  # at the end of the row
    open_files(window, {"stops.json": FLEET})
    expect(window.get_by_label("Name of stop 3")).to_have_value("school")
    assert window.locator("#stops").evaluate("table => table.scrollLeft") == 0


@pytest.mark.parametrize(
    ("width", "table", "button"),
    [(PHONE, "#request", "Plan"), (DESK, "#vehicles + * ~ .row", "Add")],
)
def test_a_click_is_not_lost_where_what_was_typed_makes_the_page_shorter(
    window: Page, width: int, table: str, button: str
) -> None:
    window.set_viewport_size({"width": width, "height": 1700})
    open_files(window, {"stops.json": FLEET})
    write(window, "Count of van", "two")
    fault = window.locator("#vehicles-fault")
    expect(fault).not_to_be_empty()
    window.get_by_label("Count of van").fill("3")
    pressed = window.locator(table).get_by_role("button", name=button, exact=True)
    pressed.scroll_into_view_if_needed()
    box = pressed.bounding_box()
    assert box is not None
    window.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    window.mouse.down()
    wait_for_next_frame(window)
    window.mouse.up()
    expect(fault).to_be_empty()
    if button == "Plan":
        wait_until_planned(window)
    else:
        expect(window.get_by_label("Name of vehicle 2")).to_be_focused()


def test_a_plan_that_a_typo_follows_can_be_replanned_and_linked(window: Page, other: Page) -> None:
    open_files(window, {"stops.csv": PLANES})
    plan(window)
    wait_until_planned(window)
    window.get_by_label("x₁ of 1", exact=True).fill("o")
    plan(window)
    expect(window.locator("#stops-fault")).not_to_be_empty()
    expect(window.locator("#replanning")).to_be_visible()
    open_link(other, copied(window, "link"))
    expect(other.get_by_label("x₁ of 1", exact=True)).to_have_value("0")
    assert json.loads(saved(other, "JSON")) == shown_front(window)
    # The first of the three is still on the map: the stop that is moved is the second.
    window.locator("#plane-1").press("Enter")
    window.keyboard.press("Enter")
    window.keyboard.press("ArrowRight")
    expect(window.get_by_label("x₁ of 2", exact=True)).not_to_have_value("3")
    expect(window.get_by_label("x₁ of 1", exact=True)).to_have_value("o")
