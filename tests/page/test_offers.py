"""Offer a time on the page: what is asked of the service, and how an offer is said."""

from playwright.sync_api import Page, expect

from tests.helpers.browsing import needs_chromium
from tests.helpers.node import Node
from tests.page.test_today import left_of_a_planned_day, paste_orders, replan

ASKED = {
    "clock": "time",
    "objectives": [{"name": "distance", "unit": "m"}, {"name": "time", "unit": "min"}],
    "vehicles": [{"id": "van", "shift": [480, 1020]}, {"id": "bike", "shifts": [[540, 1080]]}],
}
BODY = """async ([body, asked]) => {
  const { offersBody } = await import("./page/today/offers.js");
  return offersBody(body, asked);
}"""
SAID = """async ([offers, objectives]) => {
  const { offersSaid } = await import("./page/today/offers.js");
  return offersSaid(offers, objectives, { said: (time) => `${time / 60}:00` });
}"""


def test_the_last_order_without_a_time_is_asked_about_every_hour_until_all_are_back(
    node: Node,
) -> None:
    orders = [{"id": "a"}, {"id": "b"}, {"id": "c", "window": [1, 2]}]
    body = {"plan": 2, "now": 615, "routes": [], "add": orders, "remove": [], "seed": 1}
    asked = node.evaluate(BODY, [{**body, "time_limit": 3}, ASKED])
    every = {"from": 600, "to": 1080, "length": 60}
    rest = {"plan": 2, "now": 615, "routes": [], "remove": []}
    assert asked == {**rest, "add": [orders[0], orders[2]], "order": orders[1], "every": every}


def test_offers_say_what_rises_in_one_unit_a_column(node: Node) -> None:
    rises = [[1234.5, -3.0], [12345.0, 0.0], [0.0, 5.0]]
    offers = [{"slot": [540, 600], "choices": [{"rise": rise}]} for rise in rises]
    hour = "9:00\u201310:00"
    said = [[hour, "+1.23 km", "\u22123 min"], [hour, "+12.3 km", "same"], [hour, "same", "+5 min"]]
    assert node.evaluate(SAID, [offers, ASKED["objectives"]]) == said
    assert node.evaluate(SAID, [offers[:1], ASKED["objectives"]])[0][1] == "+1,230 m"


@needs_chromium
def test_a_time_that_is_promised_is_the_window_of_the_order(window: Page) -> None:
    page, offers = window, window.locator("#offers button")
    left_of_a_planned_day(page)
    paste_orders(page, "id,lon,lat\nB1,24.95,60.18\n", "1 row was read.")
    page.get_by_role("button", name="Offer a time").click()
    expect(offers.first).to_be_visible()
    begin = str(offers.first.text_content()).removeprefix("Promise ").partition("\u2013")[0]
    offers.first.click()
    expect(offers).to_have_count(0)
    windows = page.locator("#orders input").evaluate_all("all => all.map((each) => each.value)")
    assert any(each.startswith(begin) for each in windows)
    replan(page)
    expect(page.locator("#changes")).to_contain_text("B1 is new")
