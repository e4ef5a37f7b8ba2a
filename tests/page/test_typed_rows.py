"""Rows of stops that are typed on the page: read by the service, as files are."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, Request, expect

from tests.helpers.browsing import (
    copied,
    curl_body,
    needs_chromium,
    open_files,
    stops_as_text,
)
from tests.helpers.node import Node

pytestmark = needs_chromium

ROWS = [[0, 0, 5, 5], [3.5, 1, 9, 1], [5, 2, 2, 8]]
TEXT = "0, 0, 5, 5\n3.5, 1, 9, 1\n5, 2, 2, 8"


@pytest.fixture
def opened(window: Page) -> Iterator[Page]:
    """The page with two stops, whose text is unfolded."""
    open_files(window, {"two.csv": "0,0,5,5\n3,1,9,1\n"})
    expect(window.locator("#count")).to_have_text("2 stops")
    stops_as_text(window)
    yield window
    window.unroute_all()


def press_plan(page: Page) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()


# Types faster than a busy machine lets keys be pressed one after another.
TYPE_FAST = """(box, keys) => {
  for (const key of keys) {
    box.value += key;
    box.dispatchEvent(new InputEvent("input", { bubbles: true }));
  }
}"""
# Reads typed rows as the page does, and returns what is found, or what is said of which row.
READ = """async ([address, text]) => {
  const { TypedRows } = await import("./page/inputs/typed_rows.js");
  const { Service } = await import("./page/planning/service.js");
  class Far extends Service {
    ask(path, options) {
      return super.ask(`${address}/${path}`, options);
    }
  }
  const found = [];
  const typed = new TypedRows(new Far(() => ""), (read) => found.push(read));
  typed.typed(text);
  const refused = await typed.settle().catch((error) => error);
  return refused ? [refused.message, refused.errors[0].pointer] : found[0];
}"""


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("0;0;5;5\n3,5;1;9;1\n5;2;2;8\n", ROWS),
        ("x1,y1,x2,y2\n0,0,5,5\n3.5,1,9,1\n5,2,2,8", ROWS),
        ("  0 1 2 3\n4 5 6 7", [[0, 1, 2, 3], [4, 5, 6, 7]]),
        ("-0.5, 1e3, .5, 3.", [[-0.5, 1000, 0.5, 3]]),
        ("0 0 5 5\n3.5 1 9 1\n5 2 2 8\n", ROWS),
        ("0\t0\t5\t5\r\n3.5\t1\t9\t1\r\n5\t2\t2\t8", ROWS),
        ("\n\n0,0,5,5\n\n3.5,1,9,1\n   \n5,2,2,8\n\n", ROWS),
        (
            "1, 60.171, 24.941, 5\n2, 60.169, 24.952, 5",
            [[1, 60.171, 24.941, 5], [2, 60.169, 24.952, 5]],
        ),
        ("0, 1, 2, 3\n4, 5, 6, 7", [[0, 1, 2, 3], [4, 5, 6, 7]]),
    ],
)
def test_rows_are_read_as_a_file_is(
    node: Node, released: str, text: str, rows: list[list[float]]
) -> None:
    assert node.evaluate(READ, [released, text])["coordinates"] == rows


FOUR = "each stop must have 4 items"


@pytest.mark.parametrize(
    ("text", "said", "row"),
    [
        ("1, 2, 3, 4\n5, , 7, 8", "y₁ of stop 2 must be a number, got ''", "1"),
        ("1, 2, 3\n4, 5, 6", FOUR, ""),
        ("1, 2, 3, 4, 5, 6\n6, 5, 4, 3, 2, 1", FOUR, ""),
        ("lon,lat\n1,2\n3,4", FOUR, ""),
    ],
)
def test_a_fault_in_a_row_names_the_row(
    node: Node, released: str, text: str, said: str, row: str
) -> None:
    found, pointer = node.evaluate(READ, [released, text])
    assert found.startswith(said)
    assert pointer == f"/cities/{row}"


def test_what_is_copied_at_once_has_what_was_typed(opened: Page) -> None:
    stops_as_text(opened).fill(TEXT)
    assert curl_body(opened)["coordinates"] == ROWS
    stops_as_text(opened).fill("1, 2, 3, 4")
    assert "[[1, 2, 3, 4]]" in copied(opened, "as Python")


def test_names_before_the_numbers_are_the_stops(opened: Page) -> None:
    stops_as_text(opened).fill("depot,0,0,5,5\nshop,3.5,1,9,1\nschool,5,2,2,8")
    expect(opened.get_by_label("Name of stop 2", exact=True)).to_have_value("shop")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["depot", "shop", "school"]


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("1, 2, x, 4", "X₂ of stop 2 must be a number, got 'x'"),
        ("1, 2, 3", "Stop 2 must have 4 items"),
    ],
)
def test_a_fault_in_a_row_is_told_at_its_row_when_it_is_planned(
    opened: Page, row: str, said: str
) -> None:
    text = f"1, 2, 3, 4\n\n{row}\n"
    box, fault = stops_as_text(opened), opened.locator("#cities-fault")
    with opened.expect_response("**/files"):
        box.fill(text)
    expect(fault).to_be_empty()
    press_plan(opened)
    expect(fault).to_contain_text(said)
    expect(box).to_be_focused()
    expect(box).to_have_attribute("aria-invalid", "true")
    chosen = box.evaluate("({ value, selectionStart: a, selectionEnd: b }) => value.slice(a, b)")
    assert chosen == row
    opened.get_by_role("button", name="Copy as curl").click()
    expect(fault).to_contain_text(said)
    expect(box).to_have_value(text)
    box.press_sequentially("0")
    expect(fault).to_be_empty()
    expect(opened.get_by_role("button", name="Plan", exact=True)).to_be_enabled()


def test_a_row_that_cannot_be_read_is_not_lost_by_an_edit_of_another(opened: Page) -> None:
    box = stops_as_text(opened)
    box.fill("1, 2, 3, 4\n5, 6, x, 8")
    cell = opened.get_by_label("x₁ of 1", exact=True)
    cell.fill("9")
    cell.press("Tab")
    expect(opened.locator("#cities-fault")).to_contain_text("X₂ of stop 2")
    expect(box).to_have_value("1, 2, 3, 4\n5, 6, x, 8")
    box.fill("1, 2, 3, 4\n5, 6, 7, 8")
    cell.fill("9")
    cell.press("Tab")
    expect(box).to_have_value("9, 2, 3, 4\n5, 6, 7, 8")


def test_typing_asks_once_it_pauses_and_takes_the_front_away_once_read(page: Page) -> None:
    reads: list[Request] = []
    page.on("request", lambda asked: reads.append(asked) if asked.url.endswith("/files") else None)
    box = stops_as_text(page)
    expect(page.get_by_label(re.compile("A choice of"))).to_be_visible()
    page.route("**/files", lambda route: route.abort())
    with page.expect_request("**/files"):
        box.evaluate(TYPE_FAST, "12345")
    expect(page.get_by_label(re.compile("A choice of"))).to_be_visible()
    page.unroute_all()
    box.fill(TEXT)
    expect(page.locator("#count")).to_have_text("3 stops")
    assert len(reads) == 2  # what was typed fast, and what was filled in
    expect(page.get_by_label("Nothing planned yet")).to_be_visible()
    press_plan(page)
    expect(page.locator("#status")).to_have_text("Done: 1 tour found.")


def test_rows_that_the_service_cannot_take_now_are_read_when_they_are_planned(
    opened: Page,
) -> None:
    opened.route("**/files", lambda route: route.abort())
    stops_as_text(opened).fill(TEXT)
    press_plan(opened)
    expect(opened.locator("#request-fault")).to_have_text("The service does not answer.")
    opened.unroute_all()
    press_plan(opened)
    expect(opened.locator("#status")).to_have_text("Done: 1 tour found.")
    assert curl_body(opened)["coordinates"] == ROWS


def test_no_rows_are_no_stops(opened: Page) -> None:
    stops_as_text(opened).fill(" \n")
    expect(opened.locator("#count")).to_have_text("0 stops")
    press_plan(opened)
    expect(opened.locator("#cities-fault")).to_contain_text("There must be a stop")
