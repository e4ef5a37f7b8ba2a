"""Tasks that people have: the ones for which no other module has a test.

Plan own CSV, name objectives: test_inputs. End elsewhere, compare two tours: test_page. Drop a stop
and replan: test_replanning. Save GeoJSON, share the tour: test_exports. Cover a map: test_files.
"""

import re

from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    needs_chromium,
    shown_front,
    to_three_digits,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium


def test_find_the_least_risk_within_five_per_cent_more_distance(planned: Page) -> None:
    front = [item["lengths"] for item in shown_front(planned)["front"]]
    line = planned.get_by_role("slider", name="At most this much distance")
    line.press("Home")
    expect(planned.locator("#choice")).to_contain_text("The least distance.")
    while more_distance(planned) <= 5:
        line.press("ArrowRight")
    line.press("ArrowLeft")
    assert 0 < more_distance(planned) <= 5
    within = [lengths for lengths in front if round(100 * (lengths[0] / front[0][0] - 1), 1) <= 5]
    risk = planned.locator("#comparison").get_by_role("row", name="Risk")
    expect(risk).to_contain_text(to_three_digits(within[-1][1]))


def more_distance(page: Page) -> float:
    """Return how many per cent more distance the selected tour has, as the sentence says."""
    wait_for_next_frame(page)
    share = re.match(r"([0-9.]+) % more distance", page.locator("#choice").inner_text())
    return float(share[1]) if share else 0.0


def test_see_how_far_from_optimal_the_front_may_be(page: Page) -> None:
    page.get_by_text("More settings").click()
    page.get_by_label("Say how far from the best possible").check()
    page.get_by_label("Seconds of planning").fill("0.3")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    page.get_by_text("Details", exact=True).click()
    front = shown_front(page)
    short = 100 * (1 - front["hypervolume"] / front["hypervolume_bound"])
    expect(page.locator("#figures")).to_contain_text(f"Short of optimal by at most{short:.2f} %")
