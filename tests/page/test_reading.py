"""Reading and planning on the page are two states: what is told, offered and shown in either."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.helpers.browsing import (
    FREE,
    Held,
    curl_body,
    needs_chromium,
    new_tab,
    open_files,
    open_page,
    show_unplanned,
    wait_until_planned,
    wait_until_read,
)
from tests.helpers.sampled import at_night

pytestmark = needs_chromium

GOOD = "id,lon,lat,x,y\na,24.9,60.1,0,0\nb,24.8,60.2,3,1\nc,24.7,60.1,5,2\n"
BAD = "id,lon,lat\na,east,60.1\n"


@pytest.fixture
def opened(window: Page) -> Iterator[Page]:
    """The page with three stops from a file, none of which is planned."""
    open_files(window, {"good.csv": GOOD})
    expect(window.locator("#count")).to_have_text("3 stops")
    yield window
    window.unroute_all()


def choose(page: Page, text: str, name: str = "chosen.csv") -> None:
    """Have a file read, and do not wait for that."""
    payload = {"name": name, "mimeType": "text/csv", "buffer": text.encode()}
    page.get_by_label("Open files").set_input_files([payload])  # type: ignore[list-item]


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name, exact=True)


def type_a_name(page: Page, name: str) -> None:
    field = page.get_by_label("Name of stop 1", exact=True)
    field.fill(name)
    field.press("Tab")


def test_an_edit_while_a_file_is_read_offers_no_plan(opened: Page) -> None:
    held = Held(opened, "**/files")
    choose(opened, GOOD.replace("c,", "d,"))
    type_a_name(opened, "depot")
    expect(button(opened, "Plan")).to_be_disabled()
    expect(button(opened, "Stop")).to_be_enabled()
    expect(opened.locator("#request")).to_have_attribute("aria-busy", "true")
    expect(opened.locator("#status")).to_have_text("The file is being read.")
    held.release()
    wait_until_read(opened)
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["a", "b", "d"]
    expect(opened.locator("#status")).to_be_empty()


def test_a_read_that_fails_leaves_a_plan_as_it_is(page: Page) -> None:
    held = Held(page, "**/files")
    choose(page, BAD)
    expect(button(page, "Plan")).to_be_disabled()
    replans = Held(page, "**/replan")
    page.locator("#replanning > summary").click()
    button(page, "Replan").click()
    expect(page.locator("#status")).to_have_text("The rest of the tour is being planned.")
    held.release()
    expect(page.locator("#file-fault")).to_contain_text("east")
    expect(page.locator("#status")).to_have_text("The rest of the tour is being planned.")
    expect(button(page, "Plan")).to_be_disabled()
    expect(button(page, "Stop")).to_be_enabled()
    replans.release()
    wait_until_planned(page)
    expect(button(page, "Plan")).to_be_enabled()
    expect(button(page, "Stop")).to_be_disabled()


def test_stop_ends_the_reading_of_a_file(opened: Page) -> None:
    held = Held(opened, "**/files")
    choose(opened, GOOD.replace("c,", "d,"))
    held.wait()
    with opened.expect_event("requestfailed", lambda failed: failed.url.endswith("/files")):
        button(opened, "Stop").click()
    expect(opened.locator("#status")).to_have_text("Stopped.")
    expect(button(opened, "Plan")).to_be_enabled()
    expect(button(opened, "Stop")).to_be_disabled()
    held.release()
    expect(opened.locator("#file-fault")).to_be_empty()
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["a", "b", "c"]


def test_stop_ends_the_reading_of_an_example_which_can_be_chosen_again(opened: Page) -> None:
    held = Held(opened, "**/examples/*.json")
    choice = opened.get_by_label("Example")
    choice.select_option("City deliveries")
    expect(opened.locator("#status")).to_have_text("The example is being opened.")
    held.wait()
    button(opened, "Stop").click()
    expect(opened.locator("#status")).to_have_text("Stopped.")
    expect(choice).to_have_value("")
    expect(opened.locator("#count")).to_have_text("3 stops")
    held.release()
    choice.select_option("City deliveries")
    wait_until_planned(opened)
    expect(opened.locator("#count")).to_have_text("61 stops")


def test_a_bad_file_does_not_take_the_place_of_an_example_under_way(opened: Page) -> None:
    held = Held(opened, "**/examples/*.json")
    opened.get_by_label("Example").select_option("City deliveries")
    held.wait()
    open_bad = opened.locator("#file-fault")
    choose(opened, BAD, "one.csv")
    choose(opened, BAD, "two.csv")
    expect(open_bad).to_contain_text("two.csv")
    held.release()
    wait_until_planned(opened)
    expect(opened.locator("#count")).to_have_text("61 stops")
    expect(opened.get_by_label("Example")).to_have_value("city-deliveries.json")
    expect(open_bad).to_contain_text("two.csv")


def test_a_good_file_takes_the_place_of_an_example_under_way(opened: Page) -> None:
    held = Held(opened, "**/examples/*.json")
    opened.get_by_label("Example").select_option("City deliveries")
    held.wait()
    choose(opened, GOOD.replace("c,", "d,"))
    expect(opened.locator("#file-notes p")).to_have_text("chosen.csv")
    held.release()
    expect(opened.get_by_label("Example")).to_have_value("")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["a", "b", "d"]


@pytest.mark.parametrize(
    "first", [pytest.param("the file", marks=at_night), "the list of examples"]
)
def test_nothing_is_planned_before_the_page_is_loaded_nor_does_a_bad_file_take_the_first_example(
    browser: Browser, released: str, first: str
) -> None:
    with open_page(browser, f"{released}/page/icon.svg") as page:
        script = Held(page, "**/main.js")
        examples, files = Held(page, "**/examples/index.json"), Held(page, "**/files")
        page.goto(released, wait_until="commit")
        expect(button(page, "Plan")).to_be_disabled()
        script.release()
        expect(page.locator("#front-chart svg")).to_be_attached()
        choose(page, BAD)
        if first == "the file":
            with page.expect_response("**/files"):
                files.release()
            expect(button(page, "Plan")).to_be_disabled()
            examples.release()
        else:
            examples.release()
            expect(page.get_by_label("Example").get_by_role("option")).not_to_have_count(1)
            files.release()
        wait_until_planned(page)
        expect(button(page, "Plan")).to_be_enabled()
        expect(page.locator("#count")).to_have_text("60 stops")
        expect(page.locator("#file-fault")).to_contain_text("east")


def test_a_fault_of_the_page_itself_is_none_of_the_file(browser: Browser, released: str) -> None:
    page = new_tab(browser)
    page.goto(released + FREE)
    show_unplanned(page, released)
    answer: dict[str, Any] = {"kind": "front", "request": None, "notes": [], "name": "a.csv"}
    page.route("**/files", lambda route: route.fulfill(json=answer))
    with page.expect_event("pageerror") as told:
        open_files(page, {"a.csv": GOOD})
    assert "TypeError" in (told.value.stack or "")
    expect(page.locator("#file-fault")).to_be_empty()
    expect(page.locator("#status")).to_be_empty()
    expect(button(page, "Plan")).to_be_enabled()
    page.close()


@pytest.mark.parametrize("body", ["<html>sign in</html>", '{"kind": "fr'])
def test_an_answer_that_is_not_the_services_is_a_sentence(opened: Page, body: str) -> None:
    opened.route("**/files", lambda route: route.fulfill(body=body))
    open_files(opened, {"a.csv": GOOD})
    said = "Not opened: the service answered 200 without saying why."
    expect(opened.locator("#file-fault")).to_have_text(said)


def drop(page: Page, path: Path) -> None:
    """Drop something from the disk on the page, as a file manager does."""
    data = {"items": [], "files": [str(path)], "dragOperationsMask": 1}
    devtools = page.context.new_cdp_session(page)
    for kind in ("dragEnter", "dragOver", "drop"):
        event = {"type": kind, "x": 300, "y": 300, "data": data}
        devtools.send("Input.dispatchDragEvent", event)


def test_a_folder_that_is_dropped_is_called_one(opened: Page, tmp_path: Path) -> None:
    folder = tmp_path / "orders"
    folder.mkdir()
    (folder / "good.csv").write_text(GOOD)
    drop(opened, folder)
    expect(opened.locator("#file-fault")).to_have_text(
        "Not opened: orders is a folder: drop its files."
    )
    drop(opened, folder / "good.csv")
    expect(opened.locator("#file-fault")).to_be_empty()
    expect(opened.locator("#file-notes p")).to_have_text("good.csv")


def test_a_file_that_is_gone_is_not_a_silent_service(opened: Page, tmp_path: Path) -> None:
    drop(opened, tmp_path / "gone.csv")
    expect(opened.locator("#file-fault")).to_contain_text("gone.csv: the browser cannot read it")


def test_roads_that_the_service_has_not_are_told_when_a_file_is_opened(opened: Page) -> None:
    open_files(opened, {"places.csv": "id,lon,lat\na,24.9,60.1\nb,24.8,60.2\nc,24.7,60.1\n"})
    notes = opened.locator("#file-notes")
    expect(notes).to_contain_text("no routing engine")
    expect(notes).to_contain_text("straight lines")
    expect(notes).not_to_contain_text("time by road")
    button(opened, "Plan").click()
    expect(opened.locator("#status")).to_have_text("Done: 1 tour found.")
    request = {
        "stops": [{"id": name, "location": [24 + at, 60]} for at, name in enumerate("abc")],
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "driving", "from": "road_time"},
        ],
    }
    open_files(opened, {"request.json": json.dumps(request)})
    expect(notes).to_contain_text("no routing engine")
    expect(notes).to_contain_text("“driving”")
    assert curl_body(opened)["objectives"][1]["from"] == "road_time"
