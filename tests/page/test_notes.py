"""Notes on a request stand beside what the page has planned, and those on its file once."""

import json

from playwright.sync_api import Page, expect

from tests.helpers.browsing import needs_chromium, open_files

pytestmark = needs_chromium

COSTS = [[abs(3 * i - 2 * j) + 1 for j in range(6)] for i in range(6)]
BIG = [[10**7 if (i, j) in ((1, 2), (4, 3)) else COSTS[i][j] for j in range(6)] for i in range(6)]
PLACES = "id,lat,lon,x,y\n" + "".join(f"s{n},60.1{n},24.9{n},{n},{n * n}\n" for n in range(5))


def test_a_note_on_costs_is_said_with_the_result(window: Page) -> None:
    open_files(window, {"costs.json": json.dumps({"matrices": [COSTS, BIG], "time_limit": 0.1})})
    window.get_by_role("button", name="Plan", exact=True).click()
    status = window.locator("#status")
    expect(status).to_contain_text("2 costs of matrix 1 are 10000000")
    expect(status).to_contain_text("found")


def test_a_note_on_a_file_is_said_beside_its_name_alone(window: Page) -> None:
    open_files(window, {"stops.csv": f"{PLACES}lost,0,0,3,4\n"})
    window.get_by_role("button", name="Plan", exact=True).click()
    expect(window.locator("#file-notes")).to_contain_text("was the address not found?")
    expect(window.locator("#status")).to_contain_text("found")
    expect(window.locator("#status")).not_to_contain_text("address")
