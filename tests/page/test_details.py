"""What the columns of a table that are not planned tell drivers: customers, addresses, notes."""

import base64
import csv
import io
import json
import zlib
from typing import Any
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Page, Request, expect

from tests.helpers.browsing import (
    copied,
    needs_chromium,
    open_files,
    stops_as_text,
    wait_until_planned,
    wait_until_read,
)
from tests.helpers.node import Node
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


def test_details_are_in_all_lists_for_drivers_and_are_not_sent_to_be_planned(window: Page) -> None:
    sent: list[str] = []

    def note(request: Request) -> None:
        if not request.url.endswith("/files"):
            sent.append(request.url + (request.post_data or ""))

    window.on("request", note)
    open_files(window, {"orders.csv": FLEET})
    plan(window)
    assert any("/fleet" in each for each in sent)
    listed = rows(window)
    columns = ["vehicle", "position", "stop", "customer", "note", "latitude"]
    assert [*listed[0]][:6] == columns
    by_stop = {row["stop"]: (row["customer"], row["note"]) for row in listed}
    assert by_stop == {
        "depot": ("", ""),
        "A": ("Lee, Ann", "ring twice"),
        "B": ("Bo", ""),
        "C": ("Cy", "back door"),
    }
    gpx = ElementTree.fromstring(given(window, "Save the selected tour as GPX"))
    said = {
        point.findtext(f"{GPX}name"): point.findtext(f"{GPX}desc")
        for point in gpx.iter(f"{GPX}rtept")
    }
    assert (said["A"] or "").startswith("customer: Lee, Ann; note: ring twice")
    assert (said["B"] or "").startswith("customer: Bo")
    assert "note" not in (said["B"] or "")
    window.evaluate("window.print = () => {}")
    window.get_by_role("button", name="Print the stops of the selected tour").click()
    window.emulate_media(media="print")
    sheet = window.locator("#sheet table").first
    assert sheet.locator("thead td").all_text_contents()[:4] == ["", "stop", "customer", "note"]
    expect(window.locator("#sheet").get_by_role("cell", name="back door")).to_be_visible()
    window.emulate_media(media="screen")
    for link in (copied(window, "link"), copied(window, "as curl"), copied(window, "as Python")):
        assert "ring twice" not in link
    assert "details" not in asked_in(window.url)["request"]
    assert not any("ring" in each or "Lee" in each for each in sent)
    window.remove_listener("request", note)


@pytest.mark.parametrize("table", few(1, [FLEET, EARTH]), ids=few(1, ["fleet", "tour"]))
def test_details_stay_with_their_stops(window: Page, table: str) -> None:
    open_files(window, {"orders.csv": table})
    expect(window.locator("#count")).to_have_text("4 stops")
    name = window.get_by_label("Name of stop 4", exact=True)
    name.fill("Z")
    name.press("Tab")
    window.get_by_role("button", name="Delete A", exact=True).click()
    expect(window.locator("#count")).to_have_text("3 stops")
    plan(window)
    assert told(window, "customer") == {"depot": "", "B": "Bo", "Z": "Cy"}
    window.get_by_role("button", name="Undo").click()
    expect(window.locator("#count")).to_have_text("4 stops")
    plan(window)
    assert told(window, "note") == {"depot": "", "A": "ring twice", "B": "", "Z": "back door"}


def test_a_stop_that_is_added_has_no_details_of_another(window: Page) -> None:
    open_files(window, {"orders.csv": FLEET})
    window.get_by_role("button", name="Delete C", exact=True).click()
    window.locator("#add").click()
    expect(window.locator("#count")).to_have_text("4 stops")
    plan(window)
    assert told(window, "customer") == {"depot": "", "A": "Lee, Ann", "B": "Bo", "4": ""}


def test_details_of_rows_of_numbers_stay_in_their_rows(window: Page) -> None:
    open_files(window, {"rows.csv": PLANES})
    expect(window.locator("#count")).to_have_text("4 stops")
    window.get_by_role("button", name="Delete 2", exact=True).click()
    expect(window.locator("#count")).to_have_text("3 stops")
    plan(window)
    assert told(window, "who") == {"1": "a", "2": "c", "3": "d"}
    text = stops_as_text(window)
    text.fill("\n".join(text.input_value().splitlines()[:2]))
    wait_until_read(window)
    expect(window.locator("#count")).to_have_text("2 stops")
    window.locator("#add").click()
    expect(window.locator("#count")).to_have_text("3 stops")
    plan(window)
    assert told(window, "who") == {"1": "a", "2": "c", "3": ""}


def test_details_are_there_after_a_reload(window: Page) -> None:
    open_files(window, {"orders.csv": FLEET})
    plan(window)
    before = rows(window)
    window.reload()
    wait_until_planned(window)
    assert rows(window) == before


def test_a_column_that_is_not_used_is_dropped_and_the_plan_stays(window: Page) -> None:
    open_files(window, {"orders.csv": EARTH})
    plan(window)
    said = window.locator("#status").inner_text()
    window.get_by_label("note", exact=True).select_option("not used")
    expect(window.locator("#columns select.ignored")).to_have_count(1)
    expect(window.locator("#status")).to_have_text(said)
    assert "note" not in rows(window)[0]
    assert told(window, "customer")["B"] == "Bo"


NONE: dict[str, Any] = {
    "stops": [{"id": f"s{k}", "location": [24.9 + k / 100, 60.1]} for k in range(3)],
    "objectives": [{"name": name, "from": "great_circle"} for name in ("there", "back")],
}
WRONG: list[Any] = [5, [None], [{"column": "x", "texts": [1]}], [{"texts": ["a"]}]]


@pytest.mark.parametrize("wrong", WRONG, ids=json.dumps)
def test_details_of_another_form_are_dropped(node: Node, wrong: Any) -> None:
    asked = {**NONE, "details": wrong}
    assert node.call("inputs/details.js", "withSoundDetails", asked) == NONE


def test_details_of_another_form_are_not_taken_from_a_link(window: Page) -> None:
    """Links come from anywhere."""
    open_files(window, {"request.json": json.dumps({**NONE, "details": WRONG[0]})})
    expect(window.locator("#count")).to_have_text("3 stops")
    plan(window)
    assert [*rows(window)[0]] == ["position", "stop", "latitude", "longitude"]
