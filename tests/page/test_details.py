"""What the columns of a table that are not planned tell drivers: customers, addresses, notes."""

import base64
import csv
import io
import json
import zlib
from collections.abc import Iterator
from typing import Any
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Browser, Page, Request, expect

from tests.helpers.browsing import (
    copied,
    needs_chromium,
    open_files,
    open_unplanned,
    stops_as_text,
    wait_until_planned,
    wait_until_read,
)
from tests.helpers.sampled import few

pytestmark = needs_chromium

GPX = "{http://www.topografix.com/GPX/1/1}"
FLEET = """id,lat,lon,qty,customer,note
depot,60.17,24.94,0,,
A,60.18,24.95,3,"Lee, Ann",ring twice
B,60.16,24.93,2,Bo,
C,60.15,24.92,1,Cy,back door
"""
EARTH = FLEET.replace("qty", "cost")
PLANES = "x,y,u,v,who\n" + "".join(f"{k},{k % 2},{k % 3},{k},{w}\n" for k, w in enumerate("abcd"))


@pytest.fixture
def page(browser: Browser, released: str) -> Iterator[Page]:
    with open_unplanned(browser, released) as page:
        yield page


def plan(page: Page) -> None:
    page.get_by_label("Seconds of planning").fill("0")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)


def given(page: Page, name: str) -> str:
    """Return the text of the file that a button saves."""
    with page.expect_download() as download:
        page.get_by_role("button", name=name).click()
    return download.value.path().read_text()


def rows(page: Page) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(given(page, "Save the stops of the selected tour"))))


def told(page: Page, column: str) -> dict[str, str]:
    """What the list of stops says in a column, by stop."""
    return {row["stop"]: row[column] for row in rows(page)}


def asked_in(link: str) -> Any:
    """The request and the selected plan in a link."""
    [packed] = [part[6:] for part in link.split("&") if part.startswith("asked=")]
    deflated = base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4))
    return json.loads(zlib.decompress(deflated, -15))


def test_details_are_in_all_lists_for_drivers_and_are_not_sent_to_be_planned(page: Page) -> None:
    sent: list[str] = []

    def note(request: Request) -> None:
        if not request.url.endswith("/files"):
            sent.append(request.url + (request.post_data or ""))

    page.on("request", note)
    open_files(page, {"orders.csv": FLEET})
    plan(page)
    assert any("/fleet" in each for each in sent)
    listed = rows(page)
    columns = ["vehicle", "position", "stop", "customer", "note", "latitude"]
    assert [*listed[0]][:6] == columns
    by_stop = {row["stop"]: (row["customer"], row["note"]) for row in listed}
    assert by_stop == {
        "depot": ("", ""),
        "A": ("Lee, Ann", "ring twice"),
        "B": ("Bo", ""),
        "C": ("Cy", "back door"),
    }
    gpx = ElementTree.fromstring(given(page, "Save the selected tour as GPX"))
    said = {
        point.findtext(f"{GPX}name"): point.findtext(f"{GPX}desc")
        for point in gpx.iter(f"{GPX}rtept")
    }
    assert (said["A"] or "").startswith("customer: Lee, Ann; note: ring twice")
    assert (said["B"] or "").startswith("customer: Bo")
    assert "note" not in (said["B"] or "")
    page.evaluate("window.print = () => {}")
    page.get_by_role("button", name="Print the stops of the selected tour").click()
    page.emulate_media(media="print")
    sheet = page.locator("#sheet table").first
    assert sheet.locator("thead td").all_text_contents()[:4] == ["", "stop", "customer", "note"]
    expect(page.locator("#sheet").get_by_role("cell", name="back door")).to_be_visible()
    page.emulate_media(media="screen")
    for link in (copied(page, "link"), copied(page, "as curl"), copied(page, "as Python")):
        assert "ring twice" not in link
    assert "details" not in asked_in(page.url)["request"]
    assert not any("ring" in each or "Lee" in each for each in sent)


@pytest.mark.parametrize("table", few(1, [FLEET, EARTH]), ids=few(1, ["fleet", "tour"]))
def test_details_stay_with_their_stops(page: Page, table: str) -> None:
    open_files(page, {"orders.csv": table})
    expect(page.locator("#count")).to_have_text("4 stops")
    name = page.get_by_label("Name of stop 4", exact=True)
    name.fill("Z")
    name.press("Tab")
    page.get_by_role("button", name="Delete A", exact=True).click()
    expect(page.locator("#count")).to_have_text("3 stops")
    plan(page)
    assert told(page, "customer") == {"depot": "", "B": "Bo", "Z": "Cy"}
    page.get_by_role("button", name="Undo").click()
    expect(page.locator("#count")).to_have_text("4 stops")
    plan(page)
    assert told(page, "note") == {"depot": "", "A": "ring twice", "B": "", "Z": "back door"}


def test_a_stop_that_is_added_has_no_details_of_another(page: Page) -> None:
    open_files(page, {"orders.csv": FLEET})
    page.get_by_role("button", name="Delete C", exact=True).click()
    page.locator("#add").click()
    expect(page.locator("#count")).to_have_text("4 stops")
    plan(page)
    assert told(page, "customer") == {"depot": "", "A": "Lee, Ann", "B": "Bo", "4": ""}


def test_details_of_rows_of_numbers_stay_in_their_rows(page: Page) -> None:
    open_files(page, {"rows.csv": PLANES})
    expect(page.locator("#count")).to_have_text("4 stops")
    page.get_by_role("button", name="Delete 2", exact=True).click()
    expect(page.locator("#count")).to_have_text("3 stops")
    plan(page)
    assert told(page, "who") == {"1": "a", "2": "c", "3": "d"}
    text = stops_as_text(page)
    text.fill("\n".join(text.input_value().splitlines()[:2]))
    wait_until_read(page)
    expect(page.locator("#count")).to_have_text("2 stops")
    page.locator("#add").click()
    expect(page.locator("#count")).to_have_text("3 stops")
    plan(page)
    assert told(page, "who") == {"1": "a", "2": "c", "3": ""}


def test_details_are_there_after_a_reload(page: Page) -> None:
    open_files(page, {"orders.csv": FLEET})
    plan(page)
    before = rows(page)
    page.reload()
    wait_until_planned(page)
    assert rows(page) == before


def test_a_column_that_is_not_used_is_dropped_and_the_plan_stays(page: Page) -> None:
    open_files(page, {"orders.csv": EARTH})
    plan(page)
    said = page.locator("#status").inner_text()
    page.get_by_label("note", exact=True).select_option("not used")
    expect(page.locator("#columns select.ignored")).to_have_count(1)
    expect(page.locator("#status")).to_have_text(said)
    assert "note" not in rows(page)[0]
    assert told(page, "customer")["B"] == "Bo"


def test_details_of_another_form_are_not_taken_from_a_link(page: Page) -> None:
    """Links come from anywhere."""
    stops = [{"id": f"s{k}", "location": [24.9 + k / 100, 60.1]} for k in range(3)]
    objectives = [{"name": name, "from": "great_circle"} for name in ("there", "back")]
    for wrong in (5, [None], [{"column": "x", "texts": [1]}], [{"texts": ["a"]}]):
        request = {"stops": stops, "objectives": objectives, "details": wrong}
        open_files(page, {"request.json": json.dumps(request)})
        expect(page.locator("#count")).to_have_text("3 stops")
        plan(page)
        assert [*rows(page)[0]] == ["position", "stop", "latitude", "longitude"]
