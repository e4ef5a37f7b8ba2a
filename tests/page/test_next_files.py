"""The next file of stops: the vehicles that somebody has typed serve it as well."""

from playwright.sync_api import Page, expect

from tests.helpers.browsing import curl_body, needs_chromium, open_files

pytestmark = needs_chromium


ORDERS = (
    "id,lat,lon,demand,window\ndepot,60.1,24.9,,\n"
    "{0}-1,60.2,24.9,3,8:00-12:00\n{0}-2,60.2,25.0,2,\n"
)


def test_a_next_file_of_stops_keeps_the_vehicles_that_were_typed(window: Page) -> None:
    open_files(window, {"monday.csv": ORDERS.format("monday")})
    expect(window.locator("#file-notes")).to_contain_text("one was added")
    for label, text in {"Count": "3", "Capacity": "4", "Shift": "7:30-16:00"}.items():
        field = window.get_by_label(f"{label} of vehicle", exact=True)
        field.fill(text)
        field.press("Tab")
    open_files(window, {"tuesday.csv": ORDERS.format("tuesday")})
    expect(window.locator("#file-notes")).to_contain_text("they are those from before")
    expect(window.get_by_label("Name of stop 2")).to_have_value("tuesday-1")
    body = curl_body(window, "fleet")
    assert (body["vehicles"][0]["count"], body["vehicles"][0]["capacity"]) == (3, [4])
    other = ORDERS.replace("depot", "yard").format("wednesday")
    open_files(window, {"wednesday.csv": other})
    expect(window.locator("#file-notes")).to_contain_text("one was added")
    assert "count" not in curl_body(window, "fleet")["vehicles"][0]


def test_vehicles_of_an_example_do_not_serve_a_file(window: Page) -> None:
    window.get_by_label("Example", exact=True).select_option("Helsinki, six vans")
    expect(window.locator("#vehicle-count")).to_have_text("6 vehicles")
    start = window.get_by_label("Start of", exact=False).first.input_value()
    open_files(window, {"orders.csv": ORDERS.replace("depot", start).format("order")})
    expect(window.locator("#vehicle-count")).to_have_text("1 vehicle")


VANS = "plate,driver,capacity\nAB-1,Pekka,4\nAB-2,Anna,5\n"


def test_a_table_of_vehicles_joins_the_stops_that_are_open(window: Page) -> None:
    window.get_by_role("button", name="Clear").click()
    open_files(window, {"vans.csv": VANS})
    expect(window.locator("#file-fault")).to_contain_text("The vehicles of vans.csv wait")
    open_files(window, {"orders.csv": ORDERS.format("order")})
    expect(window.locator("#file-notes")).to_contain_text("orders.csv, vans.csv")
    expect(window.get_by_label("Name of vehicle 2")).to_have_value("Anna, AB-2")
    demand = window.get_by_label("Demand of order-2")
    demand.fill("3")
    demand.press("Tab")
    with window.expect_response("**/files") as read:  # and none that is refused before
        open_files(window, {"vans.csv": VANS.replace("Anna", "Matti")})
    assert read.value.status == 200
    expect(window.get_by_label("Name of vehicle 2")).to_have_value("Matti, AB-2")
    body = curl_body(window, "fleet")
    assert [vehicle["capacity"] for vehicle in body["vehicles"]] == [[4], [5]]
    assert [stop.get("demand") for stop in body["stops"]] == [None, [3], [3]]
