"""What the columns of an opened table are taken for, and what a person chooses instead."""

from playwright.sync_api import Page, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import curl_body, needs_chromium, open_files

pytestmark = needs_chromium

ORDERS = """ref,lat,lon,sacks,remarks
depot,60.17,24.94,0,
A,60.18,24.95,3,ring twice
B,60.16,24.93,2,
"""


def taken(page: Page) -> dict[str, str]:
    """What the page shows that each column is taken for."""
    rows = page.locator("#columns dl")
    names = rows.locator("label").all_text_contents()
    chosen = [
        each.evaluate("list => list.selectedOptions[0].text")
        for each in rows.locator("select").all()
    ]
    return dict(zip(names, chosen, strict=True))


def test_a_table_shows_its_columns_and_becomes_a_fleet_by_choosing(window: Page) -> None:
    open_files(window, {"orders.csv": ORDERS})
    expect(window.locator("#count")).to_have_text("3 stops")
    assert taken(window) == {
        "ref": "name",
        "lat": "latitude",
        "lon": "longitude",
        "sacks": "shown to the driver",
        "remarks": "shown to the driver",
    }
    window.get_by_label("sacks", exact=True).focus()
    window.get_by_label("sacks", exact=True).select_option("load")
    expect(window.locator("#brought")).to_have_text("A fleet: 1 vehicle and 3 stops.")
    expect(window.get_by_label("sacks", exact=True)).to_be_focused()
    assert [stop.get("demand") for stop in curl_body(window, "fleet")["stops"]] == [None, [3], [2]]
    window.get_by_label("sacks", exact=True).select_option("not used")
    expect(window.locator("#brought")).to_be_hidden()
    assert "demand" not in curl_body(window)["stops"][1]
    check_on_a_phone(window, "#columns")


def test_a_table_that_is_not_understood_can_be_explained(window: Page) -> None:
    heading = "ref,Nord,Ost-West,sacks,remarks"
    open_files(window, {"orders.csv": ORDERS.replace("ref,lat,lon,sacks,remarks", heading)})
    fault = window.locator("#file-fault")
    expect(fault).to_contain_text("'Nord', 'Ost-West', 'sacks', which may be anything")
    window.get_by_label("Ost-West", exact=True).select_option("longitude")
    expect(fault).to_contain_text("must")
    window.get_by_label("Nord", exact=True).select_option("latitude")
    expect(fault).to_be_hidden()
    expect(window.locator("#count")).to_have_text("3 stops")
    assert curl_body(window)["stops"][1] == {"id": "A", "location": [24.95, 60.18]}


def test_vehicles_that_were_edited_stay_when_another_column_is_chosen(window: Page) -> None:
    rows = "name,lat,lon,sacks,lumps,spent\nA,60.18,24.95,3,8,5\nB,60.16,24.93,2,9,7\n"
    open_files(window, {"orders.csv": rows})
    expect(window.locator("#count")).to_have_text("2 stops")
    brought = window.locator("#brought")
    expect(brought).to_be_hidden()
    window.get_by_label("sacks", exact=True).select_option("load")
    expect(brought).to_be_visible()
    unedited = curl_body(window, "fleet")["vehicles"]
    window.get_by_label("sacks", exact=True).select_option("not used")
    expect(brought).to_be_hidden()
    window.get_by_label("lumps", exact=True).select_option("load")
    expect(brought).to_be_visible()
    [vehicle] = curl_body(window, "fleet")["vehicles"]
    assert [vehicle] != unedited  # it holds lumps
    count = window.get_by_label("Count of vehicle")
    count.fill("2")
    count.press("Tab")
    window.get_by_label("spent", exact=True).select_option("time at the stop")
    expect(window.get_by_label("Service of A")).to_be_visible()
    assert curl_body(window, "fleet")["vehicles"] == [{**vehicle, "count": 2}]


def test_a_choice_that_cannot_be_is_said_and_can_be_taken_back(window: Page) -> None:
    open_files(window, {"orders.csv": ORDERS})
    window.get_by_label("remarks", exact=True).select_option("load")
    expect(window.locator("#file-fault")).to_contain_text("must be a number, got 'ring twice'")
    assert taken(window)["remarks"] == "load"
    window.get_by_label("remarks", exact=True).select_option("not used")
    expect(window.locator("#file-fault")).to_be_hidden()


def test_the_columns_go_with_what_they_are_of(window: Page) -> None:
    open_files(window, {"orders.csv": ORDERS})
    expect(window.locator("#columns")).to_be_visible()
    window.get_by_role("button", name="Clear").click()
    expect(window.locator("#columns")).to_be_hidden()


def test_measures_by_road_are_grey_without_a_routing_engine(window: Page) -> None:
    open_files(window, {"orders.csv": ORDERS})
    expect(window.locator("#count")).to_have_text("3 stops")
    measures = window.locator("#objectives").get_by_label(
        "What the second objective is measured by"
    )
    by_road = measures.locator("option[value=road_time]")
    expect(by_road).to_have_text("Time by road, s (no routing engine here)")
    expect(by_road).to_be_disabled()
    expect(measures.locator("option[value=great_circle]")).to_be_enabled()
