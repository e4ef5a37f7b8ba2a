"""The budget lines of the chart: at most so much of one objective, by the mouse and by keys."""

import re
from xml.etree import ElementTree

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect

from tests.helpers.browsing import (
    SVG,
    copied,
    metres,
    needs_chromium,
    open_link,
    saved,
    shown_front,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium


@pytest.mark.parametrize(("objective", "name"), [(0, "distance"), (1, "risk")])
def test_a_dragged_line_selects_the_tour_that_the_service_finds_within_the_budget(
    planned: Page, released: str, objective: int, name: str
) -> None:
    line = planned.get_by_role("slider", name=f"At most this much {name}")
    expect(line).to_have_attribute("aria-valuetext", "no limit")
    assert not limits_in_picture(planned)
    box = line.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    planned.mouse.move(x, y)
    planned.mouse.down()
    planned.mouse.move(x - 150 * (objective == 0), y + 100 * (objective == 1))
    planned.mouse.up()
    expect(planned.locator("#budget")).to_contain_text(f"of {name}")
    most = float(line.get_attribute("aria-valuenow") or "")
    asked = {"front": shown_front(planned)["id"], ("first", "second")[objective] + "_at_most": most}
    found = httpx.get(f"{released}/tour", params=asked).json()["lengths"]
    limit = line.locator("span").inner_text()
    assert limits_in_picture(planned) == [limit]
    chosen = planned.get_by_role("slider", name="Balance")
    said = f"distance {metres(found[0])}, risk {found[1]:,.6g}"
    expect(chosen).to_have_attribute("aria-valuetext", re.compile(re.escape(said) + "$"))
    chosen.press("Home" if objective else "End")
    expect(line).to_have_attribute("aria-valuetext", "no limit")


def limits_in_picture(page: Page) -> list[str | None]:
    """Return what the saved picture says of limits, and check that it has a line for each."""
    wait_for_next_frame(page)
    drawing = ElementTree.fromstring(saved(page, "SVG"))
    said = [text.text for text in drawing.iter(f"{SVG}text") if "≤" in (text.text or "")]
    assert len(said) == len(list(drawing.iter(f"{SVG}line")))
    return said


def test_keys_move_a_budget_from_tour_to_tour(planned: Page) -> None:
    front = [item["lengths"] for item in shown_front(planned)["front"]]
    for objective, name, tightest, next_to_none in [
        (0, "distance", front[0], front[-2]),
        (1, "risk", front[-1], front[1]),
    ]:
        line = planned.get_by_role("slider", name=f"At most this much {name}")
        line.press("ArrowLeft")
        wait_for_next_frame(planned)
        assert float(line.get_attribute("aria-valuenow") or "") == next_to_none[objective]
        line.press("Home")
        assert float(line.get_attribute("aria-valuenow") or "") == tightest[objective]
        line.press("Escape")
        expect(line).to_have_attribute("aria-valuetext", "no limit")


def test_a_limit_is_there_after_undo_after_a_reload_and_in_a_link(page: Page, other: Page) -> None:
    def limit(shown: Page) -> Locator:
        return shown.get_by_role("slider", name="At most this much distance")

    for _ in range(3):
        limit(page).press("ArrowLeft")
    wait_for_next_frame(page)
    chosen = page.locator("#choice").inner_text()
    most = limit(page).get_attribute("aria-valuetext") or ""
    assert most.startswith("at most")
    page.get_by_role("button", name="Delete ").first.click()
    expect(page.locator("#status")).to_be_empty()
    page.get_by_role("button", name="Undo").click()
    expect(limit(page)).to_have_attribute("aria-valuetext", most)
    expect(page.locator("#choice")).to_have_text(chosen)
    page.reload()
    wait_until_planned(page)
    expect(limit(page)).to_have_attribute("aria-valuetext", most)
    expect(page.locator("#choice")).to_have_text(chosen)
    open_link(other, copied(page, "link"))
    expect(limit(other)).to_have_attribute("aria-valuetext", most)
    expect(other.locator("#choice")).to_have_text(chosen)
