"""Debian's Chromium, and the page in one of its windows.

The browser without a window takes a third less of the processor than the whole one.
"""

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import (
    Browser,
    ConsoleMessage,
    Error,
    Locator,
    Page,
    Route,
    expect,
    sync_playwright,
)

from tests.helpers.required import MAY_BE_MISSING
from tests.helpers.sampled import IS_WHOLE

WITHOUT_WINDOW, WHOLE = Path("/usr/bin/chromium-headless-shell"), Path("/usr/bin/chromium")
CHROMIUM = WITHOUT_WINDOW if WITHOUT_WINDOW.exists() else WHOLE
DESK, PHONE = 1440, 375  # widths of a window in pixels
# Of search: those that the page and its examples ask for, and as many as tests need.
DEFAULT_SECONDS, SHORT_SECONDS = [1, 2, 3], 0.2
SECOND = 1000.0  # in milliseconds, playwright's unit
CLIPBOARD = ["clipboard-read", "clipboard-write"]  # permissions
NOTHING = "about:blank"  # the address of a new window
SETTINGS = "page/settings.json"  # the end of the path of what the page is told of the service
FREE = "/page/icon.svg#free"  # of the site: what a window shows between tests
# Pages share a process, which keeps their modules compiled: a new one takes half a second.
ONE_PROCESS = (
    "--disable-site-isolation-trials",
    "--disable-features=site-per-process,IsolateOrigins",
)
# Few threads draw what nobody sees, and take a seventh less of the processor than many.
# --disable-threaded-compositing takes another fifth, but then no frame ever comes.
FEW_THREADS = ("--in-process-gpu", "--disable-gpu", "--num-raster-threads=1")

SVG = "{http://www.w3.org/2000/svg}"  # before the names of elements

# Chromium writes a line for each refusal of the service, which the page has shown, and for each
# request that a test aborts: one that fails by itself has a reason, as net::ERR_CONNECTION_REFUSED.
EXPECTED = ("server responded with a status of", "net::ERR_FAILED")

# In the page rather than by a route, since playwright turns the cache off where there is one,
# and a page without it takes four times as much of the processor to be loaded.
SHORTEN_SEARCH = f"""
const sent = globalThis.fetch;
globalThis.fetch = (path, options) => {{
  const known = Object.entries(JSON.parse(window.name || "{{}}"));
  const [, answer] = known.find(([end]) => String(path).endsWith(end)) ?? [];
  if (answer === null) return Promise.reject(new TypeError("Failed to fetch"));
  if (answer) return Promise.resolve(Response.json(answer));
  if (/^(front|coverage|fleet)$|\\/replan$/.test(path) && options?.body) {{
    const asked = JSON.parse(options.body);
    if ({DEFAULT_SECONDS}.includes(asked.time_limit))
      options = {{ ...options, body: JSON.stringify({{ ...asked, time_limit: {SHORT_SECONDS} }}) }};
  }}
  return sent(path, options);
}};
"""

# By night the service, files, the clipboard and what is drawn are late, as on a busy machine: what
# a test does not wait for is not there yet.
COME_LATE = """
const late = () => new Promise(done => setTimeout(done, 400));
const frames = globalThis.requestAnimationFrame;
globalThis.requestAnimationFrame = draw => setTimeout(() => frames(draw), 400);
globalThis.cancelAnimationFrame = clearTimeout;
const answered = globalThis.fetch;
globalThis.fetch = async (...asked) => {
  await late();
  const answer = await answered(...asked);
  await late();
  return answer;
};
const later = (prototype, name) => {
  const before = prototype?.[name];
  if (before) prototype[name] = async function (...given) {
    await late();
    return before.apply(this, given);
  };
};
for (const name of ["text", "arrayBuffer"]) later(Blob.prototype, name);
later(globalThis.Clipboard?.prototype, "writeText");
"""

# The colours of the canvas on which routes are drawn, as #rrggbb.
DRAWN = """canvas => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const hex = part => part.toString(16).padStart(2, "0");
  const found = new Set();
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 3] === 255) found.add("#" + [...data.slice(at, at + 3)].map(hex).join(""));
  return [...found];
}"""

# The texts in the tables of the result that reach out of their place, or of their card.
CUT_OFF = """() => {
  const within = ".numbers, .numbers *, .fleet .routes, .fleet :is(table, tr, th, td)";
  return [...document.querySelectorAll(within)].filter(each => {
    if (!each.checkVisibility() || each.closest("svg, .growth")) return false;
    const card = each.closest(".card").getBoundingClientRect();
    const isWider = each.clientWidth > 0 && each.scrollWidth > each.clientWidth;
    return isWider || each.getBoundingClientRect().right > card.right + 0.5;
  }).map(each => each.textContent.trim());
}"""

PASTE = """text => {
  const clipboardData = new DataTransfer();
  clipboardData.setData("text", text);
  const paste = { clipboardData, bubbles: true, cancelable: true };
  document.activeElement.dispatchEvent(new ClipboardEvent("paste", paste));
}"""

# What the clipboard holds, as soon as it holds anything.
CLIPBOARD_TEXT = f"""async () => {{
  const end = Date.now() + {30 * SECOND};
  for (;;) {{
    const text = await navigator.clipboard.readText();
    if (text) return text;
    if (Date.now() > end) throw new Error("nothing was copied");
  }}
}}"""

# What a tab keeps of three stops that are not planned, and has the page open them with.
DRAFT = json.dumps(
    {
        "hash": "",
        "asked": {
            "request": {"coordinates": [[0, 0, 1, 1], [1, 1, 0, 0], [2, 0, 2, 2]]},
            "objectives": [{"name": "length 1", "unit": ""}, {"name": "length 2", "unit": ""}],
        },
    }
)

# Have a page keep nothing when it is left, and a window nothing of the pages before.
KEEP_NOTHING = "Storage.prototype.setItem = () => {}"
FORGET = "sessionStorage.clear(); localStorage.clear(); name = ''"

# Have a page open a link as it is when it is loaded: nothing is said, and nothing is unfolded.
OPEN_LINK = """named => {
  for (const each of document.querySelectorAll("details")) each.open = false;
  document.getElementById("status").textContent = "";
  history.replaceState(null, "", location.pathname);
  location.hash = named;
}"""

expect.set_options(timeout=60 * SECOND)  # five seconds are too few on a busy machine

needs_chromium = pytest.mark.skipif(
    MAY_BE_MISSING and not CHROMIUM.exists(),
    reason="these need Debian's Chromium: apt-get install chromium-headless-shell",
)


@contextmanager
def chromium(*options: str) -> Iterator[Browser]:
    """Run Chromium with these options until the block ends.

    Until then an event loop is under way in this thread, so that `asyncio.run` is refused.
    """
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=[*ONE_PROCESS, *options]
        )
        browser.new_context(permissions=CLIPBOARD)  # of the windows that tests share
        yield browser


@contextmanager
def open_page(
    browser: Browser,
    address: str,
    width: int = DESK,
    scheme: Literal["light", "dark"] = "light",
) -> Iterator[Page]:
    """Open the page in a window that nobody uses, and fail if the console has an error at the end.

    Where the page asks for its default seconds of search, the service is asked for fewer.
    A window serves one test after another, with its cache and its process.
    """
    page = _free_window(browser)
    page.set_viewport_size({"width": width, "height": 900})
    page.emulate_media(color_scheme=scheme, reduced_motion="reduce")  # no colour fades
    errors: list[str] = []

    def note_error(error: Error) -> None:
        errors.append(error.stack or str(error))

    def note_line(line: ConsoleMessage) -> None:
        if line.type == "error":
            errors.append(line.text)

    page.on("pageerror", note_error)
    page.on("console", note_line)
    if page.url != address:
        page.goto(address)
    yield page
    if not page.is_closed():
        page.unroute_all()
        _free(page)
        page.remove_listener("pageerror", note_error)
        page.remove_listener("console", note_line)
    unexpected = [error for error in errors if not any(line in error for line in EXPECTED)]
    assert not unexpected, unexpected


@contextmanager
def open_unplanned(browser: Browser, address: str) -> Iterator[Page]:
    """Open the page with three stops and no plan, which takes half as long as with an example."""
    with open_page(browser, address + FREE) as page:
        show_unplanned(page, address)
        yield page


def show_unplanned(page: Page, address: str) -> None:
    """Have a window that was opened free show the page with three stops and no plan."""
    page.evaluate("draft => sessionStorage.setItem('paretour-draft', draft)", DRAFT)
    page.goto(address)
    expect(page.locator("#count")).to_have_text("3 stops")


def _free(page: Page) -> None:
    """Leave a window as if nothing had been shown in it."""
    if page.url != NOTHING and not page.url.endswith(FREE):
        page.evaluate(KEEP_NOTHING)
        page.goto(page.evaluate("location.origin") + FREE)
    if page.url != NOTHING:
        page.evaluate(FORGET)


def know(page: Page, answers: dict[str, Any]) -> None:
    """Have a window get these answers by the ends of their paths; None is no answer.

    They are its name until its test ends, or others take their place.
    """
    page.evaluate("answers => { name = JSON.stringify(answers) }", answers)


def follow(page: Page, link: str) -> None:
    """Have a page that is shown open a link, which takes a third as long as to load the page."""
    page.evaluate(OPEN_LINK, link.partition("#")[2])


def open_link(page: Page, link: str) -> None:
    """Have a page that is shown open a link, and wait until it shows the front."""
    follow(page, link)
    wait_until_planned(page)


@contextmanager
def running_first(page: Page, script: str) -> Iterator[None]:
    """Run a script before those of each page that this window opens, until the block ends."""
    devtools = page.context.new_cdp_session(page)
    devtools.send("Page.enable")
    added = devtools.send("Page.addScriptToEvaluateOnNewDocument", {"source": script})
    yield
    devtools.send("Page.removeScriptToEvaluateOnNewDocument", added)
    devtools.detach()


def _free_window(browser: Browser) -> Page:
    """Return a window of the context that tests share, with what is loaded and compiled in it."""
    for page in browser.contexts[0].pages:
        if page.url == NOTHING or page.url.endswith(FREE):
            return page
    return new_tab(browser)


def new_tab(browser: Browser) -> Page:
    """Return another window of the context that tests share."""
    page = browser.contexts[0].new_page()
    page.set_default_timeout(120 * SECOND)
    page.add_init_script(SHORTEN_SEARCH)
    if IS_WHOLE:
        page.add_init_script(COME_LATE)
    return page


def plan_by_network_alone(page: Page, path: str) -> None:
    """Have requests for such paths answered with the network's plans, whatever their time."""

    def without_time(route: Route) -> None:
        body = json.loads(route.request.post_data or "{}")
        route.continue_(post_data=json.dumps({**body, "time_limit": 0}))

    page.route(re.compile(rf"/{path}$"), without_time)


def wait_until_planned(page: Page) -> None:
    """Wait until the page shows the end of what it is planning.

    The page says that it is done in one frame, and draws what it has chosen in the next.
    """
    expect(page.locator("#status")).to_contain_text("Done", timeout=300 * SECOND)
    wait_for_next_frame(page)


def plan_city_deliveries(page: Page) -> None:
    """Have the page plan its example of two planes, and wait until it has."""
    # The example that the page opens with is left before it is planned, which takes seconds.
    page.get_by_label("Example").select_option("City deliveries")
    expect(page.locator("#count")).to_have_text("61 stops")
    wait_until_planned(page)


def copied(page: Page, name: str) -> str:
    """Return the text that the page's button "Copy", of what is copied, copies."""
    page.evaluate("navigator.clipboard.writeText('')")
    page.get_by_role("button", name=f"Copy {name}").click()
    text: str = page.evaluate(CLIPBOARD_TEXT)
    return text


def paste(page: Page, text: str, said: Locator, words: str) -> None:
    """Paste a text where the cursor is, and wait until a part of the page says that it is read."""
    page.evaluate(PASTE, text)
    expect(said).to_contain_text(words)


def to_three_digits(value: float) -> str:
    """Return a length as the page says it."""
    return f"{float(f'{value:.3g}'):,.6g}"


def metres(value: float) -> str:
    """Return a distance as the page says it, to the digits that the value has, six at most."""
    return f"{value:,.6g} m" if value < 10_000 else f"{value / 1000:,.6g} km"


def number_in(text: str) -> float:
    """Return the number that the page shows, metres where it says kilometres."""
    number, _, unit = text.replace(",", "").partition(" ")
    return float(number) * (1000 if unit == "km" else 1)


def tours_of_front(page: Page) -> int:
    """Return how many tours the front has that is shown, by what the slider says."""
    said = page.get_by_role("slider", name="Balance").get_attribute("aria-valuetext") or ""
    return int(said.partition(" of ")[2].partition(":")[0])


def wait_for_next_frame(page: Page) -> None:
    """Wait for the frame in which the page draws what was changed in this one."""
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def open_files(page: Page, files: dict[str, str]) -> None:
    """Open text files on the page, given by name and content."""
    payloads = [
        {"name": name, "mimeType": "text/plain", "buffer": text.encode()}
        for name, text in files.items()
    ]
    page.get_by_label("Open files").set_input_files(payloads)
    wait_until_read(page)


def note_texts(part: Locator) -> None:
    """Have a part of the page note the texts that it has from now on, maybe for a moment each."""
    part.evaluate("""part => {
      part.noted = [];
      const note = () => part.noted.push(part.textContent);
      new MutationObserver(note).observe(part, { childList: true, subtree: true });
    }""")


def noted_texts(part: Locator) -> list[str]:
    """Return the texts that a part of the page has had since then."""
    texts: list[str] = part.evaluate("part => part.noted")
    return texts


class Held:
    """Requests that are held back until they are released, as are all later ones."""

    def __init__(self, page: Page, pattern: str) -> None:
        self._page = page
        self._routes: list[Route] | None = []
        page.route(pattern, self._take)

    def _take(self, route: Route) -> None:
        if self._routes is None:
            route.continue_()
        else:
            self._routes.append(route)

    def wait(self) -> None:
        """Wait until there is one: what ends it before that ends a request that is not sent."""
        for _ in range(3000):
            if self._routes:
                break
            self._page.wait_for_timeout(20)
        assert self._routes

    def release(self) -> None:
        """Let them pass, once there is one."""
        self.wait()
        routes, self._routes = self._routes or [], None
        for route in routes:
            route.continue_()


def wait_until_read(page: Page) -> None:
    """Wait until files that were opened are read, or refused: until then nothing can be planned."""
    expect(page.get_by_role("button", name="Plan", exact=True)).to_be_enabled()


def stops_as_text(page: Page) -> Locator:
    """Return the box that holds the stops of two planes as text, unfolded."""
    page.locator("#typed").evaluate("details => details.open = true")
    return page.get_by_label("x1, y1, x2, y2")


def shown_front(page: Page) -> Any:
    """Return the front that is shown, as the page saves it in JSON."""
    return json.loads(saved(page, "JSON"))


def select_last(page: Page) -> Any:
    """Select the front's last item, and return it as the page saves it."""
    page.get_by_role("slider", name="Balance").press("End")
    wait_for_next_frame(page)
    return shown_front(page)["front"][-1]


def curl_body(page: Page, path: str = "front") -> Any:
    """Return the body of the request to a path that the page copies as a curl command."""
    command = copied(page, "as curl")
    assert command.startswith(f"curl {page.url.partition('#')[0]}{path} ")
    return json.loads(command.splitlines()[1])


def saved(page: Page, name: str) -> bytes:
    """Return the file that the page's button "Save", of a format's name, saves."""
    with page.expect_download() as download:
        page.get_by_role("button", name=f"Save {name}").click()
    return download.value.path().read_bytes()
