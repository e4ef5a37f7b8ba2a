"""`python -m tests.helpers.screenshot`: write tests/page.png, the page as the README shows it."""

from io import BytesIO
from pathlib import Path

from PIL import Image

from tests.helpers.browsing import chromium, open_page, wait_for_next_frame, wait_until_planned
from tests.helpers.serving import serving_released

PICTURE = Path(__file__).parents[1] / "page.png"
COLOURS = 128  # enough for a page, in a third of the bytes


def main() -> None:
    """Plan the first example, pin a tour of its front, select another, and take the picture."""
    with serving_released() as address, chromium() as browser, open_page(browser, address) as page:
        wait_until_planned(page)
        slider = page.get_by_role("slider", name="Balance")
        slider.press("Home")
        page.get_by_role("button", name="Pin to compare").click()
        for _ in range(5):
            slider.press("PageUp")
        slider.blur()
        page.mouse.move(0, 0)
        wait_for_next_frame(page)
        picture = Image.open(BytesIO(page.screenshot(full_page=True)))
        picture.convert("RGB").quantize(COLOURS).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
