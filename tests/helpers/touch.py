"""Screens that fingers touch, in windows that tests share."""

from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Page

Place = tuple[float, float]  # pixels from the window's upper left


@contextmanager
def touched(page: Page, *, is_phone: bool = False) -> Iterator[None]:
    """Have a window be on a screen that is touched, maybe a phone's, until the block ends.

    A page notices when it is loaded.
    """
    devtools = page.context.new_cdp_session(page)
    devtools.send("Emulation.setTouchEmulationEnabled", {"enabled": True})
    if is_phone:
        size = {**(page.viewport_size or {}), "deviceScaleFactor": 1, "mobile": True}
        devtools.send("Emulation.setDeviceMetricsOverride", size)
    yield
    if is_phone:
        devtools.send("Emulation.clearDeviceMetricsOverride")
    devtools.send("Emulation.setTouchEmulationEnabled", {"enabled": False})
    devtools.detach()


def tap(page: Page, place: Place) -> None:
    """Touch the screen at a place."""
    _touch(page, place)


def slide_finger(page: Page, start: Place, end: Place) -> None:
    """Touch the screen at a place, slide to another, and let go."""
    shares = (0, 0.4, 0.7, 1)
    x, y = start
    _touch(page, *((x + share * (end[0] - x), y + share * (end[1] - y)) for share in shares))


def _touch(page: Page, *places: Place) -> None:
    devtools = page.context.new_cdp_session(page)
    for at, (x, y) in enumerate(places):
        kind = "touchMove" if at else "touchStart"
        points = [{"x": x, "y": y}]
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    devtools.detach()
