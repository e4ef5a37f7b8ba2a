"""`python -m tests.picture`: the picture of the page that the README shows."""

from io import BytesIO
from pathlib import Path

from PIL import Image

from tests.helpers.browsing import chromium, done, drawn, opened
from tests.helpers.serving import serving_released

PICTURE = Path(__file__).parents[1] / "page.png"
COLOURS = 128  # enough for a page, in a third of the bytes


def main() -> None:
    """Plans the first example, and shows a tour of its front beside a pinned one."""
    with serving_released() as address, chromium() as browser, opened(browser, address) as page:
        done(page)
        slider = page.get_by_role("slider", name="Angle")
        slider.press("Home")
        page.get_by_role("button", name="Pin to compare").click()
        for _ in range(5):
            slider.press("PageUp")
        slider.blur()
        page.mouse.move(0, 0)
        drawn(page)
        picture = Image.open(BytesIO(page.screenshot(full_page=True)))
        picture.convert("RGB").quantize(COLOURS).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
