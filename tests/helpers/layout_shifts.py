"""Layout shifts of the page: what moves by itself while somebody looks at it."""

from playwright.sync_api import Page

# Notes each shift that no input caused, and when the first front is drawn, from the page's start.
WATCH = """
globalThis.shifts = [];
globalThis.firstFront = null;
new PerformanceObserver((list) => {
  const named = ({ node }) => node?.id || node?.className || node?.nodeName;
  for (const { value, startTime, hadRecentInput, sources } of list.getEntries())
    if (!hadRecentInput) shifts.push({ value, startTime, moved: sources.map(named) });
}).observe({ type: "layout-shift", buffered: true });
const look = () => {
  const drawn = document.querySelector('#front-chart[aria-label^="A choice of"]');
  if (drawn) firstFront = performance.now();
  else requestAnimationFrame(look);
};
requestAnimationFrame(look);
"""


def watch_layout_shifts(page: Page) -> None:
    """Have every page that is opened from now on note its layout shifts."""
    page.add_init_script(WATCH)


def shifts_after_the_first_front(page: Page) -> list[tuple[float, list[str]]]:
    """Return each shift since: its score as CLS has it, and the elements that moved."""
    found = page.evaluate("shifts.filter(({ startTime }) => startTime > firstFront)")
    return [(shift["value"], shift["moved"]) for shift in found]
