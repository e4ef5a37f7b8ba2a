"""What the page gives away: pictures, programs, GeoJSON, and links to one tour."""

import csv
import io
import json
import re
from contextlib import redirect_stdout
from xml.etree import ElementTree

import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    SVG,
    copied,
    follow,
    needs_chromium,
    open_files,
    saved,
    shown_front,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium


def test_pictures_show_the_front_and_the_selected_tour(planned: Page) -> None:
    planned.get_by_role("slider", name="Balance").press("Home")
    wait_for_next_frame(planned)
    front = shown_front(planned)["front"]
    drawing = ElementTree.fromstring(saved(planned, "SVG"))
    texts = [text.text for text in drawing.iter(f"{SVG}text")]
    assert planned.locator("#choice").inner_text() in texts
    assert {"Risk", "Distance"} <= set(texts)
    dots = list(drawing.iter(f"{SVG}circle"))
    assert len(dots) == len(front) + 1 + 2 * (61 + 1)  # a ring at the selected tour, and its start
    paths = [path.get("d") or "" for path in drawing.iter(f"{SVG}path")]
    assert [path.count("L") for path in paths] == [0, 61, 61]
    picture = Image.open(io.BytesIO(saved(planned, "PNG")))
    assert picture.size == (2 * int(drawing.get("width") or 0), 2 * int(drawing.get("height") or 0))
    colours = picture.convert("RGB").getcolors(1_000_000) or []
    assert (194, 65, 12) in [colour for _, colour in colours]  # of the selected tour


def test_the_python_program_plans_the_front_that_is_on_the_screen(page: Page) -> None:
    open_files(page, {"stops.csv": "id,lon,lat,risk\n\"a '1'\",0,0,1\nb,0.1,0,0\nc,0,0.1,3\n"})
    page.get_by_label("Open route").check()
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    page.get_by_role("slider", name="Balance").press("End")
    wait_for_next_frame(page)
    output = io.StringIO()
    with redirect_stdout(output):
        exec(copied(page, "as Python"), {})
    last = shown_front(page)["front"][-1]
    assert output.getvalue().endswith(f"{tuple(last['stops'])}\n")
    collection = json.loads(saved(page, "GeoJSON"))
    kinds = [feature["geometry"]["type"] for feature in collection["features"]]
    assert kinds.count("Point") == 3


def test_files_of_the_whole_front_say_which_tour_is_selected(page: Page) -> None:
    open_files(page, {"stops.csv": "id,lon,lat,risk\na,0,0,1\nb,0.1,0,9\nc,0,0.1,3\nd,0.1,0.1,0\n"})
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    for key in ("Home", "End"):
        page.get_by_role("slider", name="Balance").press(key)
        wait_for_next_frame(page)
        front = shown_front(page)["front"]
        chosen = 0 if key == "Home" else len(front) - 1
        rows = list(csv.DictReader(saved(page, "CSV").decode().splitlines()))
        marked = [row["selected"] for row in rows]
        assert marked == ["yes" if at == chosen else "no" for at in range(len(front))]
        lines = json.loads(saved(page, "GeoJSON"))["features"][: len(front)]
        marks = [line["properties"]["selected"] for line in lines]
        assert marks == [at == chosen for at in range(len(front))]
        with page.expect_download() as download:
            page.get_by_role("button", name="Save the stops of the selected tour").click()
        visits = list(csv.DictReader(download.value.path().read_text().splitlines()))
        assert [visit["stop"] for visit in visits] == [*front[chosen]["stops"], "a"]


@pytest.mark.parametrize("expired", [False, True], ids=["stored", "expired"])
def test_a_link_opens_the_selected_tour_even_if_its_front_has_expired(
    planned: Page, other: Page, expired: bool
) -> None:
    slider = planned.get_by_role("slider", name="Balance")
    slider.press("End")
    slider.press("ArrowLeft")
    wait_for_next_frame(planned)
    said = slider.get_attribute("aria-valuetext") or ""
    link = copied(planned, "link")
    if expired:
        link = re.sub("front=[0-9a-f]+", "front=" + 32 * "0", link)
    follow(other, link)
    if expired:
        expect(other.locator("#status")).to_have_text("This is the tour of the link.")
        expect(other.locator("#choice")).to_contain_text("no longer keeps this result")
    else:
        wait_until_planned(other)
    expect(other.locator("#count")).to_have_text("61 stops")
    if not expired:
        expect(other.get_by_role("slider", name="Balance")).to_have_attribute(
            "aria-valuetext", said
        )
