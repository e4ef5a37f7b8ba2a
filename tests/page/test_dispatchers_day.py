"""A dispatcher's day on the page, from two tables in the morning to new sheets at noon."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.helpers.accessibility import found_on_desk_and_phone
from tests.helpers.browsing import (
    copied,
    needs_chromium,
    open_link,
    open_page,
    paste,
    wait_until_planned,
    wait_until_read,
)

pytestmark = needs_chromium

MOST = 25  # clicks and fields in a day
# Neither has a depot, a time at the stops or a shift.
ORDERS = "order,customer,lon,lat,crates\n" + "".join(
    f"A{k},Shop {k},{24.9 + k % 5 / 50},{60.16 + k // 5 / 60:.4f},2\n" for k in range(1, 16)
)
VANS = "vehicle,capacity\nPekka,20\nAnna,20\nOlli,20\n"
NEW = "order,customer,lon,lat,crates\nB1,Bakery,24.95,60.17,1\nB2,Cinema,24.96,60.18,1\n"


class Desk:
    """Somebody at the page, whose clicks and filled fields are counted."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.count = 0

    def press(self, what: str | Locator, **options: object) -> None:
        """Click, or tick."""
        self.count += 1
        self._found(what).click(**options)  # type: ignore[arg-type]

    def fill(self, what: str, text: str) -> None:
        """Fill a field, and leave it."""
        self.count += 1
        self._found(what).fill(text)
        self._found(what).press("Tab")

    def paste(self, text: str, where: str, said: str) -> None:
        """Paste a text where the cursor is, and wait until a part of the page says so."""
        self.count += 1
        paste(self.page, text, self.page.locator(where), said)

    def open(self, folder: Path, files: dict[str, str]) -> None:
        """Choose files."""
        self.count += 1
        for name, text in files.items():
            (folder / name).write_text(text)
        self.page.locator("#file").set_input_files([folder / name for name in files])
        wait_until_read(self.page)

    def _found(self, what: str | Locator) -> Locator:
        return self.page.locator(what) if isinstance(what, str) else what


@pytest.fixture
def desk(window: Page) -> Iterator[Desk]:
    window.evaluate("window.print = () => {}")
    yield Desk(window)
    window.evaluate("localStorage.clear()")


def test_a_dispatchers_day_takes_25_clicks_and_fields(
    desk: Desk, browser: Browser, tmp_path: Path
) -> None:
    page = desk.page
    plan_in_the_morning(desk, tmp_path)
    left = at_eleven(desk)
    desk.press("#replan-fleet")
    changes = page.locator("#changes")
    expect(changes).to_be_visible()
    for said in (f"{left[0]} (Shop ", "is cancelled", "B1 (Bakery) is new: ", "out of service"):
        expect(changes).to_contain_text(said)
    expect(page.locator("#choice")).to_contain_text("The last vehicle is back at 1")
    assert found_on_desk_and_phone(page, "#changes", "#today", "#fleet") == []
    desk.press("#drive")
    sheet = on_sheets(desk)
    assert {"B1", "B2"} <= set(sheet)
    assert left[0] not in sheet
    desk.count += 1
    link = copied(page, "link")
    expect(page.locator("#link-help")).to_have_text(
        "The link leaves out customer, which you and the drivers see."
    )
    assert found_on_desk_and_phone(page, ".numbers") == []
    assert desk.count <= MOST
    shown = page.locator("#fleet-legend").text_content() or ""
    with open_page(browser, link) as other:
        wait_until_planned(other)
        expect(other.locator("#fleet-legend")).to_have_text(shown)
        expect(other.locator("#fleet-stops")).not_to_contain_text("Bakery")
        other.reload()
        wait_until_planned(other)
        expect(other.locator("#fleet-legend")).to_have_text(shown)
        open_link(other, copied(page, "a link with them"))
        expect(other.locator("#fleet-stops")).to_contain_text("B1 (Bakery)")


def plan_in_the_morning(desk: Desk, folder: Path) -> None:
    """Open two tables, say what they do not, plan, and print the drivers' sheets."""
    page = desk.page
    desk.open(folder, {"orders.csv": ORDERS, "vans.csv": VANS})
    missing = page.locator("#everyday-said")
    expect(missing).to_contain_text("No time at the stops is given: 0 min.")
    assert found_on_desk_and_phone(page, "#everyday") == []
    asked = page.get_by_text("Where do they start?")
    expect(asked).to_be_visible()
    desk.fill("#everyday-service", "40")
    desk.fill("#everyday-shift", "8:00-16:00")
    desk.press("#place-depot")
    desk.press("#plane-1", position={"x": 200, "y": 200})
    expect(asked).to_be_hidden()
    desk.press("#everyday-reload")
    expect(missing).to_be_empty()
    expect(page.get_by_label("customer of A1", exact=True)).to_have_value("Shop 1")
    desk.press(page.get_by_role("button", name="Plan", exact=True))
    wait_until_planned(page)
    page.locator("#fleet-lanes .visit").nth(1).click()
    for said in ("#plane-1 .leaflet-tooltip", "#fleet-stop"):
        expect(page.locator(said)).to_contain_text(re.compile(r"A\d+ \(Shop \d+\): "))
    assert sorted(on_sheets(desk)) == sorted(f"A{k}" for k in range(1, 16))
    expect(page.locator("#sheet section > p").last).to_contain_text("back at")


def at_eleven(desk: Desk) -> list[str]:
    """Say that a van breaks down, two orders come and one is cancelled; return what is left."""
    page = desk.page
    desk.press("#today > summary")
    desk.fill("#today-now", "11:00")
    chips = page.locator("#vans .van").filter(has=page.locator("li:not(.done)"))
    left: list[str] = chips.locator("li:not(.done) .of").evaluate_all(
        "chips => chips.map(each => each.dataset.turn)"
    )
    desk.press(chips.last.get_by_role("checkbox"))
    desk.press(page.get_by_role("button", name=f"Cancel {left[0]}", exact=True))
    desk.paste(NEW, "#orders-help", "2 rows were read.")
    return left


def on_sheets(desk: Desk) -> list[str]:
    """Print, and return the stops that drivers are told to visit."""
    desk.press(desk.page.get_by_role("button", name="Print the stops"))
    names = desk.page.locator("#sheet tbody td:nth-child(2)").all_text_contents()
    return [name for name in names if ": " not in name]


def test_what_was_said_once_is_remembered_for_the_next_file(desk: Desk, tmp_path: Path) -> None:
    page = desk.page
    desk.open(tmp_path, {"orders.csv": ORDERS, "vans.csv": VANS})
    desk.fill("#everyday-service", "soon")
    expect(page.locator("#everyday-fault")).to_contain_text("as 5 min")
    assert found_on_desk_and_phone(page, "#everyday") == []
    desk.fill("#everyday-service", "7")
    desk.fill("#everyday-depot", "A3")
    expect(page.locator("#everyday-depot")).to_have_value("depot")
    expect(page.locator("#everyday-said")).to_contain_text("The depot is where A3 is.")
    page.reload()
    expect(page.locator("#everyday-depot")).to_have_value("depot")
    desk.open(tmp_path, {"orders.csv": ORDERS})
    expect(page.locator("#everyday-said")).to_contain_text(
        "As last time: the depot, 7 min at each stop. No shifts are given"
    )
    expect(page.locator("#everyday-service")).to_have_value("7 min")
    page.get_by_role("button", name="Undo").click()
    expect(page.locator("#everyday-service")).to_have_value("")


def test_vehicles_leave_early_with_time_in_hand_that_delays_may_use_up(
    desk: Desk, tmp_path: Path
) -> None:
    page = desk.page
    desk.open(tmp_path, {"orders.csv": ORDERS, "vans.csv": VANS})
    desk.fill("#everyday-shift", "8:00-16:00")
    desk.fill("#everyday-slack", "10")
    expect(page.locator("#everyday-slack")).to_have_value("10 min")
    page.get_by_label("Vehicles set off").select_option("early")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    for row in page.locator("#fleet-legend tbody tr").all():
        expect(row.locator("td").nth(2)).to_contain_text("8:00")
    page.locator("#today > summary").click()
    desk.fill("#today-now", "8:05")
    expect(page.locator("#today-done")).to_contain_text("done by then, if all went as planned")
    page.get_by_label("Vehicles that are late may use up the 10 min to spare").check()
    assert found_on_desk_and_phone(page, "#today") == []
    with page.expect_request("**/replan") as sent:
        page.locator("#replan-fleet").click()
    assert sent.value.post_data_json["slack"] == 0
    expect(page.locator("#changes")).to_be_visible()


def test_cells_of_a_spreadsheet_fill_a_column(desk: Desk, tmp_path: Path) -> None:
    page = desk.page
    desk.open(tmp_path, {"orders.csv": ORDERS, "vans.csv": VANS})
    page.locator("#stops-column").select_option("Window")
    page.get_by_label("Window of A1", exact=True).click()
    hours = "\n".join(f"8-{k}" for k in range(10, 20))
    desk.paste(hours, "#status", "10 cells were filled. Undo takes that back.")
    expect(page.get_by_label("Window of A10", exact=True)).to_have_value("8:00-19:00")
    page.get_by_label("Window of A9", exact=True).click()
    page.get_by_role("button", name="Fill down window").click()
    expect(page.get_by_label("Window of A15", exact=True)).to_have_value("8:00-18:00")
    page.get_by_label("customer of A14", exact=True).click()
    desk.paste("Lee\nBo\nCy\n", "#status", "2 cells were filled. 1 row was left out")
    expect(page.get_by_label("customer of A15", exact=True)).to_have_value("Bo")
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_label("customer of A15", exact=True)).to_have_value("Shop 15")
