"""The page, used as people use it: in Debian's Chromium, against the service as it is shipped."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Locator, Page, Route, expect

from service.cli.tsplib import matrix
from service.settings import Settings
from tests.helpers.browsing import (
    DESK,
    PHONE,
    needs_chromium,
    open_page,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.serving import app_of, serving

SERVICE = Path(__file__).parents[2] / "service"
CITIES = "0, 0, 5, 5\n3.1, 0.4, 9, 1\n5.2, 2, 2, 8\n4, 5.5, 7, 7\n1, 4.2, 1, 2\n2.5, 2.5, 6, 0"

at_both_widths = pytest.mark.parametrize("width", [DESK, PHONE])


@pytest.fixture
def width() -> int:
    """Of the window; a test that is made for several names them."""
    return DESK


@pytest.fixture
def page(width: int, browser: Browser, released: str) -> Iterator[Page]:
    """The page with its first example planned."""
    with open_page(browser, released, width) as page:
        wait_until_planned(page)
        yield page


@needs_chromium
@at_both_widths
def test_the_page_opens_with_an_example_and_its_front(page: Page) -> None:
    expect(page.get_by_label("A front of 100 tours: distance from")).to_be_visible()
    expect(page.locator("#count")).to_have_text("61 cities")
    expect(page.locator("#figures")).to_contain_text("Network alone")


@needs_chromium
@at_both_widths
def test_the_slider_and_the_chart_select_the_tour_that_is_shown(page: Page) -> None:
    slider = page.get_by_role("slider", name="Angle")
    slider.press("Home")
    shortest = figure(page, "Distance")
    slider.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("tour 100 of 100"))
    assert figure(page, "Distance") > shortest
    slider.press("ArrowLeft")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("tour 99 of 100"))
    marker = page.locator("#front-chart .marker.selected").bounding_box()
    slider.press("Home")
    page.mouse.click(marker["x"] + marker["width"] / 2, marker["y"] + marker["height"] / 2)
    expect(slider).to_have_attribute("aria-valuetext", re.compile("tour 99 of 100"))


@needs_chromium
def test_a_pinned_tour_stays_beside_the_selected_one(page: Page) -> None:
    slider = page.get_by_role("slider", name="Angle")
    slider.press("Home")
    wait_for_next_frame(page)
    page.get_by_role("button", name="Pin to compare").click()
    slider.press("End")
    wait_for_next_frame(page)
    selected, pinned, difference = page.get_by_role("row", name="Risk").get_by_role("cell").all()
    assert number(selected) < number(pinned)
    expect(difference).to_contain_text("\N{MINUS SIGN}")
    page.get_by_role("button", name="Unpin").click()
    expect(page.get_by_role("row", name="Risk").get_by_role("cell")).to_have_count(1)


@needs_chromium
def test_what_was_found_stays_when_the_search_is_stopped(page: Page) -> None:
    page.get_by_label("Seconds of search").fill("50")
    page.get_by_role("button", name="Plan").click()
    expect(page.locator("#status")).to_contain_text("improving")
    page.get_by_role("button", name="Stop").click()
    expect(page.locator("#status")).to_contain_text("Stopped: ")
    expect(page.get_by_label(re.compile("A front of [0-9]+ tours"))).to_be_visible()
    expect(page.get_by_role("button", name="Plan")).to_be_enabled()


@needs_chromium
def test_the_search_is_stopped_before_the_service_has_taken_it(page: Page) -> None:
    def hold(route: Route) -> None:
        if "prefer" not in route.request.headers:
            route.continue_()

    page.route("**/front", hold)
    page.get_by_role("button", name="Plan").click()
    expect(page.locator("#status")).to_contain_text("improving")
    page.get_by_role("button", name="Stop").click()
    expect(page.locator("#status")).to_contain_text("Stopped: ")
    expect(page.get_by_role("button", name="Plan")).to_be_enabled()


@needs_chromium
def test_a_link_opens_the_same_front_with_its_cities(page: Page, browser: Browser) -> None:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_text("Copied")).to_be_visible()
    front = page.locator("#front-chart").get_attribute("aria-label")
    other = browser.new_page()
    other.goto(page.evaluate("navigator.clipboard.readText()"))
    expect(other.locator("#count")).to_have_text("61 cities")
    expect(other.locator("#front-chart")).to_have_attribute("aria-label", front or "")
    expect(other.get_by_text("Its growth is drawn here while a search runs")).to_be_visible()
    other.goto(page.url.partition("#")[0] + "#front=none")
    expect(other.locator("#request-fault")).to_have_text("There is no front 'none'.")
    other.close()


@needs_chromium
def test_a_link_to_the_networks_front_calls_it_that(page: Page, browser: Browser) -> None:
    page.get_by_label("Seconds of search").fill("0")
    page.get_by_role("button", name="Plan").click()
    wait_until_planned(page)
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_text("Copied")).to_be_visible()
    with open_page(browser, page.evaluate("navigator.clipboard.readText()")) as other:
        wait_until_planned(other)
        for shown in (page, other):
            expect(shown.locator("#legend .alone")).to_be_visible()
            expect(shown.locator("#legend .improved")).to_be_hidden()


@needs_chromium
def test_a_link_that_would_be_too_long_opens_the_front_without_its_maps(
    page: Page, browser: Browser
) -> None:
    matrices = np.random.default_rng(0).random((2, 60, 60)).tolist()
    bring(page, {"costs.json": json.dumps({"matrices": matrices, "time_limit": 0})})
    page.get_by_role("button", name="Plan").click()
    wait_until_planned(page)
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_text("This link opens the front without its maps")).to_be_visible()
    link = page.evaluate("navigator.clipboard.readText()")
    assert len(link) < 100
    with open_page(browser, link) as other:
        wait_until_planned(other)
        expect(other.get_by_text("The link names a front alone")).to_be_visible()
        expect(other.locator("#plane-1")).to_be_hidden()
        expect(other.get_by_label("A front of")).to_be_visible()


@needs_chromium
def test_a_picture_of_a_map_is_covered(browser: Browser) -> None:
    with serving(app_of(limits=Settings().limits)) as address:
        page = browser.new_page()
        page.goto(address)
        walls = np.full((20, 30), 255, dtype=np.uint8)
        walls[5:15, 12:14] = 0
        picture = BytesIO()
        Image.fromarray(walls).save(picture, "PNG")
        given = {"name": "map.png", "mimeType": "image/png", "buffer": picture.getvalue()}
        page.get_by_label("Open files").set_input_files([given])
        expect(page.get_by_text("A grid of 20 by 30 cells")).to_be_visible()
        expect(page.get_by_label("Metres a cell")).to_have_value("0.05")
        page.get_by_label("Seconds of search").fill("0.1")
        page.get_by_role("button", name="Plan").click()
        wait_until_planned(page)
        expect(page.locator("#grid")).to_be_visible()
        expect(page.locator("#plane-1")).to_be_hidden()
        page.close()


@needs_chromium
@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("stops.csv", "x,y,u,v\n1,2,3,4\n5,6,7\n", "stops.csv must have four numbers on each line"),
        ("stops.json", '{"coordinates": [', "stops.json must be JSON"),
        ("stops.json", '{"coordinates": [1, 2]}', "coordinates of stops.json must be rows"),
        ("map.json", '{"grid": []}', "grid of map.json must have a cell or more"),
        ("kroA.tsp", "EDGE_WEIGHT_TYPE: EUC_2D\n", "open it together with the other"),
    ],
)
def test_a_bad_file_is_refused_in_a_sentence(page: Page, name: str, text: str, said: str) -> None:
    bring(page, {name: text})
    expect(page.locator("#file-fault")).to_contain_text(said, ignore_case=True)
    expect(page.locator("#count")).to_have_text("61 cities")


def tsplib(places: str) -> str:
    cities = len(places.splitlines())
    head = f"DIMENSION: {cities}\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION"
    return f"{head}\n{places}\nEOF\n"


@needs_chromium
@pytest.mark.parametrize(
    "files",
    [
        {"cities.csv": "x,y,u,v\n0,0,5,5\n3,1,9,1\n5,2,2,8\n"},
        {"cities.json": '{"coordinates": [[0, 0, 5, 5], [3, 1, 9, 1], [5, 2, 2, 8]]}'},
        {
            "a.tsp": tsplib("1 0 0\n2 3 1\n3 5 2"),
            "b.tsp": tsplib("1 5 5\n2 9 1\n3 2 8"),
        },
    ],
    ids=["csv", "json", "tsplib"],
)
def test_a_file_of_cities_is_planned(page: Page, files: dict[str, str]) -> None:
    bring(page, files)
    expect(page.get_by_label("x1, y1, x2, y2")).to_have_value("0, 0, 5, 5\n3, 1, 9, 1\n5, 2, 2, 8")
    page.get_by_role("button", name="Plan").click()
    expect(page.locator("#status")).to_have_text("Done: 1 tour found.")


@pytest.fixture
def pair(tmp_path: Path) -> list[Path]:
    """Two files of TSPLIB; halves of whole numbers, so that many distances are halves as well."""
    halves = np.random.default_rng(4).integers(0, 20, (2, 12, 2)) / 2
    files = [tmp_path / "a.tsp", tmp_path / "b.tsp"]
    for file, places in zip(files, halves, strict=True):
        file.write_text(tsplib("\n".join(f"{i} {x} {y}" for i, (x, y) in enumerate(places, 1))))
    return files


@needs_chromium
def test_two_files_of_tsplib_give_the_front_of_the_command_line(
    page: Page, pair: list[Path]
) -> None:
    command = [sys.executable, "-m", "service", "front", *pair, "--json"]
    command += ["--time-limit", "50", "--seed", "3"]
    ended = subprocess.run(command, cwd=SERVICE.parent, capture_output=True, text=True, check=True)
    expected = json.loads(ended.stdout)
    assert expected["terminated"] == "converged"
    page.get_by_label("Open files").set_input_files(pair)
    page.get_by_text("More settings").click()
    page.get_by_label("Seed").fill("3")
    page.get_by_label("Seconds of search").fill("50")
    page.get_by_role("button", name="Plan").click()
    wait_until_planned(page)
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save JSON").click()
    found = json.loads(saved.value.path().read_text())
    for name in ("front", "points", "hypervolume", "reference_point", "terminated", "actor"):
        assert found[name] == expected[name]


@needs_chromium
def test_a_link_to_rounded_distances_has_the_maps_and_curl_the_matrices(
    page: Page, browser: Browser, pair: list[Path]
) -> None:
    page.get_by_label("Open files").set_input_files(pair)
    expect(page.get_by_label("Distances rounded")).to_be_checked()
    page.get_by_role("button", name="Plan").click()
    wait_until_planned(page)
    assert asked_by_curl(page)["matrices"] == [matrix(file.read_text()).tolist() for file in pair]
    link = page.get_by_role("button", name="Copy link")
    link.click()
    expect(link).to_have_text("Copied")
    with open_page(browser, page.evaluate("navigator.clipboard.readText()")) as other:
        wait_until_planned(other)
        expect(other.get_by_label("Distances rounded")).to_be_checked()
        expect(other.locator("#plane-1 canvas.selected")).to_be_visible()
        other.get_by_label("Distances rounded").uncheck()
        expect(other.get_by_label("No front yet")).to_be_visible()
        assert len(asked_by_curl(other)["coordinates"]) == 12


@needs_chromium
def test_a_list_of_angles_in_a_file_is_asked_for(page: Page) -> None:
    bring(page, {"few.json": '{"coordinates": [[0, 0, 5, 5]], "preferences": [10, 80]}'})
    assert asked_by_curl(page)["preferences"] == [10, 80]
    page.get_by_text("More settings").click()
    page.get_by_label("Directions of the network").fill("7")
    assert asked_by_curl(page)["preferences"] == 7


@needs_chromium
def test_what_the_service_refuses_is_said_at_the_field(page: Page) -> None:
    page.get_by_label("Seconds of search").fill("soon")
    page.get_by_role("button", name="Plan").click()
    fault = page.locator("#time_limit-fault")
    expect(fault).to_have_text('Seconds of search must be a valid number, got "soon".')
    expect(page.get_by_label("Seconds of search")).to_be_focused()
    page.get_by_label("x1, y1, x2, y2").fill("1, 2, 3, 4\n1, 2, 3\n")
    page.get_by_role("button", name="Plan").click()
    expect(page.locator("#cities-fault")).to_contain_text("City 1 must have 4 items")


@needs_chromium
def test_cities_are_clicked_into_place_plane_by_plane(page: Page) -> None:
    page.get_by_role("button", name="Clear").click()
    page.get_by_role("button", name="Click into place").click()
    for x, y in [(100, 160), (190, 130), (130, 90)]:
        page.locator("#plane-1").click(position={"x": x, "y": y})
        page.locator("#plane-2").click(position={"x": y, "y": x})
    expect(page.locator("#count")).to_have_text("3 cities")
    page.get_by_role("button", name="Plan").click()
    expect(page.locator("#status")).to_have_text("Done: 1 tour found.")


@needs_chromium
@at_both_widths
def test_the_keyboard_is_enough(page: Page) -> None:
    page.get_by_label("x1, y1, x2, y2").fill(CITIES)
    page.get_by_label("Seconds of search").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("0.1")
    page.keyboard.press("Enter")
    expect(page.locator("#status")).to_contain_text("Done")
    slider = page.get_by_role("slider", name="Angle")
    for _ in range(20):
        if slider.evaluate("slider => slider === document.activeElement"):
            break
        page.keyboard.press("Tab")
    page.keyboard.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("tour 5 of 5"))


@needs_chromium
def test_the_front_can_be_taken_along(page: Page, released: str) -> None:
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save JSON").click()
    answer = json.loads(saved.value.path().read_text())
    assert answer == httpx.get(f"{released}/front/{answer['id']}").json()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save CSV").click()
    head, *lines = saved.value.path().read_text().splitlines()
    assert head == "angle,length_1,length_2,tour"
    assert len(lines) == len(answer["front"])
    asked = asked_by_curl(page)
    found = httpx.post(f"{released}/front", json={**asked, "time_limit": 0}).json()
    assert found["cities"] == 61


@needs_chromium
def test_the_reference_needs_nothing_from_elsewhere(browser: Browser, released: str) -> None:
    page = browser.new_page()
    page.goto(f"{released}/docs")
    expect(
        page.get_by_role(
            "button", name="POST /front Plan the front of tours through the cities given"
        )
    ).to_be_visible()
    page.close()


def asked_by_curl(page: Page) -> Any:
    """The body of the request that the page gives as a command."""
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    curl = page.get_by_role("button", name="Copy as curl")
    curl.click()
    expect(curl).to_have_text("Copied")
    command = page.evaluate("navigator.clipboard.readText()")
    assert command.startswith(f"curl {page.url.partition('#')[0]}front ")
    return json.loads(command.splitlines()[1])


def bring(page: Page, files: dict[str, str]) -> None:
    given = [{"name": n, "mimeType": "text/plain", "buffer": t.encode()} for n, t in files.items()]
    page.get_by_label("Open files").set_input_files(given)


def figure(page: Page, name: str) -> float:
    wait_for_next_frame(page)
    return number(page.get_by_role("row", name=name).get_by_role("cell").first)


def number(cell: Locator) -> float:
    return float(cell.inner_text().replace(",", ""))


def test_what_the_page_loads_weighs_less_than_half_a_megabyte() -> None:
    files = [path for path in (SERVICE / "page").rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 500_000


def test_every_vendored_library_comes_with_its_licence() -> None:
    libraries = [*SERVICE.glob("page/vendor/*"), *SERVICE.glob("reference/vendor/*")]
    assert libraries
    assert all((library / "LICENSE").exists() for library in libraries)


def test_a_browser_may_load_nothing_from_elsewhere(released: str) -> None:
    for path in ("/", "/docs", "/actors", "/nowhere"):
        policy = httpx.get(f"{released}{path}").headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "http" not in policy
