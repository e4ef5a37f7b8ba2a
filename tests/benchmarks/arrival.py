"""How soon the page is seen on a slow line, and whether it stands still once it has a front."""

from statistics import median

from playwright.sync_api import Browser, Page

from tests.helpers.browsing import DESK, PHONE, wait_until_planned
from tests.helpers.layout_shifts import shifts_after_the_first_front, watch_layout_shifts

WIDTHS = {"phone": PHONE, "desk": DESK}
BITS_PER_SECOND, ROUND_TRIP_MS = 1.6e6, 150.0  # of the line

PAINTED = """() => performance.getEntriesByName("first-contentful-paint")[0].startTime"""


def arrivals(browser: Browser, address: str, rounds: int) -> dict[str, dict[str, float]]:
    """Return, for each width, milliseconds to the first contentful paint and the layout shift.

    The paint is the median of the rounds, the shift the greatest of their sums.
    """
    rows = {}
    for name, width in WIDTHS.items():
        found = [_arrival(browser, address, width) for _ in range(rounds)]
        paints, shifts = zip(*found, strict=True)
        rows[name] = {"paint_ms": round(median(paints)), "shift": round(max(shifts), 4)}
    return rows


def _arrival(browser: Browser, address: str, width: int) -> tuple[float, float]:
    page = browser.new_page(viewport={"width": width, "height": 900})  # with an empty cache
    _slow_down(page)
    watch_layout_shifts(page)
    page.goto(address)
    wait_until_planned(page)
    page.wait_for_timeout(500)  # for what comes after the front: streets
    painted, shifts = page.evaluate(PAINTED), shifts_after_the_first_front(page)
    page.close()
    return painted, sum(value for value, _ in shifts)


def _slow_down(page: Page) -> None:
    throughput = BITS_PER_SECOND / 8
    line = {"downloadThroughput": throughput, "uploadThroughput": throughput}
    session = page.context.new_cdp_session(page)
    session.send("Network.enable")
    conditions = {"offline": False, "latency": ROUND_TRIP_MS, **line}
    session.send("Network.emulateNetworkConditions", conditions)
