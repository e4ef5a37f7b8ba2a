"""`python -m tests.benchmarks page`: how soon the page is seen, and how long its frames take.

First contentful paint is measured on a line of 1.6 Mbit/s with a round trip of 150 ms, and with it
the layout shift after the first front, which is to be none.

Then the slider goes over a front of 100 tours and back, a step in each frame, in Debian's Chromium
without a window. Beside that, what Chromium makes of frames in which nothing is drawn, and of two
bare canvases as large as the maps, with nothing but the tour on them, in lines of one and two
pixels. A browser makes at most 60 frames a second, one in 16.7 ms; the milliseconds of processor
that a frame takes it, all its processes together, say how much of that is left. Prints tables and
stores `results/page.json`.
"""

import argparse
import os
from typing import Any

import numpy as np
import psutil
from playwright.sync_api import Browser, Page, expect
from tqdm import tqdm

from tests.benchmarks.arrival import arrivals
from tests.benchmarks.instances import SIZES, paper_instances
from tests.benchmarks.provenance import provenance, store
from tests.helpers.browsing import chromium, open_files, open_page, wait_until_planned
from tests.helpers.processes import serve_process

FRAMES = 240  # of each measurement
LATE = 25.0  # milliseconds: the frame that a browser had planned was missed
BARE = 500  # cities on the bare canvases
MANY = 10_000  # cities, beyond those of the paper
PLANNING = "10"  # seconds, in which a front of 100 tours is found at every size
SETTINGS = {"PARETOUR_WORKERS": "1", "PARETOUR_MAX_CITIES": str(MANY)}

# Draws once in each frame, and gives the times at which the frames began.
IN_FRAMES = """async (draw, count) => {
  const times = [];
  for (let frame = 0; frame <= count; frame++) {
    times.push(await new Promise(requestAnimationFrame));
    draw(0.5 - 0.5 * Math.cos((2 * Math.PI * frame) / count));
  }
  return times;
}"""
SLIDER = """() => {
  const slider = document.getElementById("balance");
  const [least, most] = [Number(slider.min), Number(slider.max)];
  return (share) => {
    slider.value = least + share * (most - least);
    slider.dispatchEvent(new Event("input"));
  };
}"""
CANVASES = """([cities, width]) => {
  const maps = [0, 1].map((plane) => {
    const canvas = Object.assign(document.createElement("canvas"), { width: 496, height: 280 });
    document.body.append(canvas);
    return [canvas.getContext("2d"), cities.map((row) => row.slice(2 * plane, 2 * plane + 2))];
  });
  return (share) => {
    for (const [context, places] of maps) {
      context.clearRect(0, 0, 496, 280);
      context.lineWidth = width;
      context.lineJoin = "round";
      context.beginPath();
      for (const [x, y] of places) context.lineTo(100 + 280 * x + share, 280 * y);
      context.stroke();
    }
  };
}"""
NOTHING = "() => () => {}"


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks page", description=__doc__)
    parser.add_argument("--rounds", type=int, default=2, help="of each row")
    options = parser.parse_args(arguments)
    cores = len(os.sched_getaffinity(0))
    arrived, rows = measure(options.rounds)
    frames = FRAMES * options.rounds
    store("page", {**provenance(cores), "arrivals": arrived, "frames": frames, "rows": rows})
    _print_arrivals(arrived)
    _print_table(rows)


def measure(rounds: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return how the page arrives, and how long frames take.

    Of each row of frames: their milliseconds, how many were late, and those of the processor.
    """
    # Two searches at once would take turns on one core with the frames that are timed.
    with serve_process(SETTINGS, ready=True) as service, chromium() as browser:
        arrived = arrivals(browser, service.url, rounds)
        rows = {"an empty page": _measured(browser.new_page(), NOTHING, None, rounds)}
        cities = paper_instances(BARE, 1)[0].tolist()
        for width in (1, 2):
            name = f"two bare canvases, {BARE} cities, lines of {width} px"
            rows[name] = _measured(browser.new_page(), CANVASES, [cities, width], rounds)
        for n in tqdm((*SIZES, MANY), leave=False):
            rows[f"the page, {n} cities"] = _page_row(browser, service.url, n, rounds)
    return arrived, rows


def _page_row(browser: Browser, address: str, n: int, rounds: int) -> dict[str, float]:
    rows = "\n".join(", ".join(f"{each:.4f}" for each in row) for row in paper_instances(n, 1)[0])
    with open_page(browser, address) as page:
        wait_until_planned(page)
        open_files(page, {"cities.csv": rows})
        expect(page.locator("#count")).to_have_text(f"{n:,} stops")
        page.get_by_label("Seconds of planning").fill(PLANNING)
        page.get_by_role("button", name="Plan", exact=True).click()
        wait_until_planned(page)
        page.get_by_label("A choice of 100 tours").wait_for()
        return _measured(page, SLIDER, None, rounds)


def _measured(page: Page, drawing: str, given: Any, rounds: int) -> dict[str, float]:
    script = f"async ([given, count]) => ({IN_FRAMES})(({drawing})(given), count)"
    page.bring_to_front()
    page.evaluate(script, [given, FRAMES // 4])  # compiles
    before = _processor()
    times = [page.evaluate(script, [given, FRAMES]) for _ in range(rounds)]
    frames = np.concatenate([np.diff(each) for each in times])
    return {
        "mean_ms": round(float(frames.mean()), 2),
        "p95_ms": round(float(np.quantile(frames, 0.95)), 2),
        "late": round(float((frames > LATE).mean()), 4),
        "processor_ms": round(1000 * (_processor() - before) / len(frames), 2),
    }


def _processor() -> float:
    """Seconds that the browser has had of the processor, all its processes together."""
    children = psutil.Process().children(recursive=True)
    spent = [each.cpu_times() for each in children if "chrom" in each.name()]
    return sum(each.user + each.system for each in spent)


def _print_arrivals(rows: dict[str, Any]) -> None:
    print("| | first contentful paint, ms | layout shift after the first front |\n|---|---|---|")
    for name, row in rows.items():
        print(f"| {name} | {row['paint_ms']} | {row['shift']} |")
    print()


def _print_table(rows: dict[str, Any]) -> None:
    print("| | ms a frame | p95 | late | of the processor, ms |\n|---|---|---|---|---|")
    for name, row in rows.items():
        late = f"{100 * row['late']:.1f} %"
        print(f"| {name} | {row['mean_ms']} | {row['p95_ms']} | {late} | {row['processor_ms']} |")
