"""Tours over the day on the page: their hours beside the stops, and what is asked for."""

import re

from playwright.sync_api import Browser, expect

from tests.helpers.browsing import curl_body, needs_chromium, open_page, wait_until_planned

pytestmark = needs_chromium


def test_the_hours_of_a_tour_stand_beside_its_stops(browser: Browser, released: str) -> None:
    with open_page(browser, released) as page:
        page.get_by_label("Example").select_option("Helsinki, rush hour")
        wait_until_planned(page)
        asked = curl_body(page)
        assert asked["departure"] == {"earliest": 25200, "latest": 30600}
        assert asked["stops"][1]["service"] == 45
        assert len(asked["objectives"][0]["over_the_day"]) == 5
        figures = page.locator("#tour-figures")
        expect(figures).to_contain_text(re.compile(r"Leaves at\s*[78]:\d\d"))
        page.locator("#order > summary").click()
        order = page.locator("#order p")
        expect(order).to_have_text(
            re.compile(r"^depot [78]:\d\d → order-\d+ .* → depot (9|10):\d\d$")
        )
        assert len((order.text_content() or "").split(" → ")) == len(asked["stops"]) + 1
