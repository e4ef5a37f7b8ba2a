"""Files as people have them, opened and dropped on the page: what is shown, planned and said."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.helpers.browsing import (
    Held,
    curl_body,
    needs_chromium,
    open_files,
    open_unplanned,
    stops_as_text,
    wait_until_planned,
    wait_until_read,
)
from tests.helpers.sampled import few

pytestmark = needs_chromium

EXAMPLES = Path(__file__).parents[1] / "files" / "examples"
DROP = """files => {
  const dataTransfer = new DataTransfer();
  for (const [name, text] of Object.entries(files)) dataTransfer.items.add(new File([text], name));
  document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
}"""


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all of these tests, each of which opens its own files."""
    with open_unplanned(browser, released) as page:
        yield page


def open_examples(page: Page, *names: str) -> None:
    """Open files of the folder of examples, as they are."""
    page.get_by_label("Open files").set_input_files([EXAMPLES / name for name in names])
    wait_until_read(page)


def plan(page: Page) -> None:
    page.get_by_label("Seconds of planning").fill("0")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)


@pytest.mark.parametrize(
    ("name", "ids"),
    [
        ("orders-with-hashes.csv", ["#1001", "#1002", "#1003", "#1004", "#1005", "#1006"]),
        ("excel-german.CSV", ["München", "Köln"]),
        ("qgis.geojson", None),
    ],
)
def test_a_file_is_shown_with_every_stop(opened: Page, name: str, ids: list[str] | None) -> None:
    open_examples(opened, name)
    expect(opened.locator("#file-notes p")).to_contain_text(name)
    expect(opened.locator("#file-fault")).to_be_empty()
    found = [stop["id"] for stop in curl_body(opened)["stops"]]
    assert found == ids or (ids is None and len(found) > 1)
    expect(opened.get_by_label("Name of stop 1", exact=True)).to_have_value(found[0])


def test_orders_with_hashes_and_costs_are_planned_with_every_row(opened: Page) -> None:
    rows = [f"#100{row};24,9{row};60,{row % 3 + 1};0,{row}" for row in range(1, 7)]
    text = "\r\n".join(["Order ID;Längengrad;Breitengrad;Risk", *rows])
    file = {"name": "orders.csv", "mimeType": "text/csv", "buffer": text.encode("cp1252")}
    opened.get_by_label("Open files").set_input_files([file])  # type: ignore[list-item]
    wait_until_read(opened)
    plan(opened)
    expect(opened.locator("#order li").first).to_have_text("#1001")
    assert len(curl_body(opened)["stops"]) == 6


def test_a_spreadsheet_of_two_planes_is_shown_as_text(opened: Page) -> None:
    open_examples(opened, "numbers.XLSX")
    expect(stops_as_text(opened)).to_have_value("1, 2, 3, 4\n5, 6.5, 7, 8")


@pytest.mark.parametrize(
    "name", few(2, ["att.TSP", "upper-row.tsp", "geo.tsp", "lower-diag-row.tsp"])
)
def test_tsplib_of_any_kind_is_planned_twice_over(opened: Page, name: str) -> None:
    text = (EXAMPLES / name).read_text()
    open_files(opened, {"a.tsp": text, "b.tsp": text})
    expect(opened.get_by_text("Two matrices of")).to_be_visible()
    plan(opened)
    expect(opened.locator("#status")).to_have_text("Done: 1 tour found.")


@pytest.mark.parametrize(
    "name",
    few(2, ["windows-as-times.csv", "solomon.txt", "orders.xlsx", "cvrp.vrp", "vroom.json"]),
)
def test_demand_and_windows_are_a_fleet_that_is_planned(opened: Page, name: str) -> None:
    open_examples(opened, name)
    expect(opened.locator("#file-notes p")).to_contain_text(name)
    expect(opened.get_by_text("A fleet:")).to_be_visible()
    assert curl_body(opened, "fleet")["vehicles"]
    plan(opened)
    expect(opened.locator("#fleet")).to_be_visible()


def test_what_was_taken_for_granted_is_said_and_dismissed(opened: Page) -> None:
    open_examples(opened, "excel-german.CSV")
    notes = opened.locator("#file-notes")
    expect(notes).to_have_attribute("role", "status")
    expect(notes.get_by_role("listitem").first).to_be_visible()
    dismiss = opened.get_by_role("button", name="Dismiss the notes on excel-german.CSV")
    expect(opened.get_by_role("status").get_by_role("button")).to_have_count(0)
    dismiss.press("Enter")
    expect(notes).to_be_empty()
    expect(dismiss).to_be_hidden()
    expect(opened.get_by_label("Open files")).to_be_focused()
    open_examples(opened, "excel-german.CSV")
    expect(notes).to_contain_text("excel-german.CSV")
    opened.get_by_label("Example").select_option("City deliveries")
    expect(notes).to_be_empty()
    wait_until_planned(opened)


def test_a_name_and_a_note_are_text(opened: Page) -> None:
    open_files(opened, {"<img src=x>.csv": "lon,lat,<b>\n0,0,<i>a</i>\n0,1,b\n"})
    expect(opened.locator("#file-notes p")).to_contain_text("<img src=x>.csv")
    expect(opened.locator("#file-notes").locator("img, b, i")).to_have_count(0)


def test_a_broken_file_is_told_until_something_else_is_opened_or_edited(opened: Page) -> None:
    fault = opened.locator("#file-fault")
    good = {"good.csv": "id,lon,lat\na,24.9,60.1\nb,24.8,60.2\nc,24.7,60.1\n"}

    def open_broken() -> None:
        open_files(opened, {"broken.csv": "id,lon,lat\nx,24.9,60.1\ny,east,60.2\n"})
        expect(fault).to_contain_text("broken.csv")
        expect(fault).to_contain_text("east")
        expect(opened.locator("#status")).to_be_empty()

    open_files(opened, good)
    open_broken()
    open_files(opened, good)
    expect(fault).to_be_empty()
    open_broken()
    expect(opened.locator("#file-notes p")).to_contain_text("good.csv")  # which is still shown
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["a", "b", "c"]
    field = opened.get_by_label("Name of stop 1", exact=True)
    field.fill("depot")
    field.press("Tab")
    expect(fault).to_be_empty()
    open_broken()
    opened.get_by_label("Example").select_option("City deliveries")
    expect(fault).to_be_empty()
    wait_until_planned(opened)
    open_broken()
    expect(opened.locator("#count")).to_have_text("61 stops")
    plan(opened)
    expect(fault).to_be_empty()


def test_all_wrong_cells_are_a_list_and_the_file_before_is_named_without_its_notes(
    opened: Page,
) -> None:
    good = "id;lon;lat\na;24,9;60,1\nb;24,8;60,2\n"
    open_files(opened, {"good.csv": good})
    notes, fault = opened.locator("#file-notes"), opened.locator("#file-fault")
    expect(notes.get_by_role("listitem").first).to_be_visible()
    rows = ["a,24.9,60.1", *(f"s{at},24.8,north" for at in range(25))]
    open_files(opened, {"many.csv": "\n".join(["id,lon,lat", *rows])})
    expect(fault).to_contain_text("Not opened: 25 cells cannot be read.")
    items = fault.get_by_role("listitem")
    expect(items).to_have_count(21)
    expect(items.first).to_have_text("many.csv: row 3, column 'lat' must be a number, got 'north'")
    expect(items.last).to_have_text("and 5 more")
    expect(notes).to_have_text("Still open: good.csv, as it was read before.")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["a", "b"]
    open_files(opened, {"few.csv": "id,lon,lat\na,<b>x</b>,60\nb,east,60.2\nc,1,1\n"})
    expect(items).to_have_count(2)
    expect(items.first).to_contain_text("got '<b>x</b>'")
    open_files(opened, {"good.csv": good})
    expect(fault).to_be_empty()
    expect(notes).not_to_contain_text("Still open")


def test_an_example_that_cannot_be_opened_is_said_to_be_that(opened: Page) -> None:
    opened.route("**/examples/*", lambda route: route.abort())
    title = "City deliveries"
    opened.get_by_label("Example", exact=True).select_option(title)
    said = opened.locator("#status")
    expect(said).to_have_text(f"The example “{title}” was not opened.")
    expect(opened.locator("#request-fault")).to_contain_text("does not answer")
    opened.unroute_all()


def test_dropped_files_are_opened(opened: Page) -> None:
    opened.evaluate(DROP, {"dropped.csv": "Order ID;lon [deg];lat [deg]\n#1;24,9;60,1\n#2;25;60\n"})
    expect(opened.locator("#file-notes p")).to_contain_text("dropped.csv")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["#1", "#2"]


def test_a_table_that_is_pasted_keeps_its_rows(opened: Page) -> None:
    text = "#1001,24.9,60.1\n#1002,24.8,60.2\n#1003,24.7,60.1\n"
    opened.evaluate("text => navigator.clipboard.writeText(text)", f"id,lon,lat\n{text}")
    opened.get_by_role("button", name="Clear").focus()
    opened.keyboard.press("Control+V")
    expect(opened.locator("#file-notes p")).to_contain_text("pasted text")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["#1001", "#1002", "#1003"]


def test_nothing_is_planned_while_a_file_is_read_and_the_last_one_opened_is_shown(
    opened: Page,
) -> None:
    held = Held(opened, "**/files")
    button = opened.get_by_role("button", name="Plan", exact=True)
    names = opened.get_by_label("Open files")
    rows = b"id,lon,lat\na,24.9,60.1\nb,24.8,60.2\n"
    for name in ("first.csv", "second.csv"):
        names.set_input_files([{"name": name, "mimeType": "text/csv", "buffer": rows}])
        expect(button).to_be_disabled()
    expect(opened.locator("#status")).to_have_text("The file is being read.")
    held.release()
    wait_until_read(opened)
    opened.unroute_all(behavior="wait")
    expect(opened.locator("#file-notes p")).to_contain_text("second.csv")


@pytest.mark.parametrize(
    ("status", "code", "detail"),
    [
        (413, "file-too-large", "a.csv: must have at most 9 stops, got 10"),
        (429, "rate-limited", "at most 5 requests a minute"),
        (503, "busy", "too many requests are being read: try again in 1 s"),
        (0, "", "the service does not answer"),
        (502, "", "the service answered 502 without saying why"),
    ],
)
def test_a_refusal_is_a_sentence(opened: Page, status: int, code: str, detail: str) -> None:
    def refuse(route: Route) -> None:
        if not status:
            return route.abort()
        kind = "application/problem+json" if code else "text/html"
        body = json.dumps({"code": code, "detail": detail}) if code else "<html>"
        return route.fulfill(status=status, content_type=kind, body=body)

    opened.route("**/files", refuse)
    open_files(opened, {"a.csv": "lon,lat\n1,2\n"})
    expect(opened.locator("#file-fault")).to_have_text(f"Not opened: {detail}.")
    opened.unroute_all()
