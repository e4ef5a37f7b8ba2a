"""The hour of a dispatcher: a table of orders on the page becomes a list for each driver."""

import csv
import io
from pathlib import Path

import numpy as np
from playwright.sync_api import Page, expect

from tests.first_hours.steps import says
from tests.helpers.browsing import (
    FEW_THREADS,
    chromium,
    needs_chromium,
    open_page,
    select_last,
    wait_until_planned,
    wait_until_read,
)

pytestmark = needs_chromium
ORDERS = 40
CAPACITY = 30
VANS = "vehicle;count;capacity;shift start;shift end;depot\nvan;4;30;08:00;18:00;depot\n"


def write_orders(file: Path) -> list[dict[str, str]]:
    """Write a table of orders as a German Excel does, and return its rows without the depot."""
    rng = np.random.default_rng(40)
    fields = ["Order ID", "Latitude", "Longitude", "Qty", "Open", "Close"]
    rows = [dict(zip(fields, ("depot", "60,1710", "24,9410", "", "08:00", "18:00"), strict=True))]
    for number in range(1001, 1001 + ORDERS):
        place = rng.normal((60.171, 24.941), (0.012, 0.02))
        opens = int(rng.integers(8, 13))
        window = (f"{opens:02}:00", f"{opens + 4:02}:00") if number % 2 else ("", "")
        texts = [f"{each:.4f}".replace(".", ",") for each in place]
        values = (f"#{number}", *texts, str(rng.integers(1, 4)), *window)
        rows.append(dict(zip(fields, values, strict=True)))
    with file.open("w", newline="") as table:
        writer = csv.DictWriter(table, fields, delimiter=";")
        writer.writeheader()
        writer.writerows(rows)
    return rows[1:]


def opened(page: Page, *files: Path) -> None:
    page.get_by_label("Open files").set_input_files(files)
    wait_until_read(page)


def seconds(time: str) -> int:
    hours, minutes, *rest = (int(part) for part in time.split(":"))
    return 3600 * hours + 60 * minutes + sum(rest)


def driven(page: Page) -> list[dict[str, str]]:
    """Take the driver's list of the selected plan, without the depot."""
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the stops of the selected tour").click()
    rows = csv.DictReader(io.StringIO(download.value.path().read_text()))
    return [row for row in rows if row["stop"] != "depot"]


def test_forty_orders_become_a_list_for_each_driver(released: str, tmp_path: Path) -> None:
    orders, vans = tmp_path / "orders.csv", tmp_path / "vans.csv"
    asked = write_orders(orders)
    vans.write_text(VANS)
    with chromium(*FEW_THREADS) as browser, open_page(browser, released) as page:
        says("use-the-page", "Open a file, drop it on the page, or paste its text")
        says("use-the-page", "Tables with demands or windows are fleets.")
        opened(page, orders)
        expect(page.locator("#brought")).to_contain_text("A fleet: 1 vehicle and 41 stops.")
        says("use-the-page", "Open a table of vehicles together with that of the stops")
        opened(page, orders, vans)
        expect(page.locator("#brought")).to_contain_text("A fleet: 4 vehicles and 41 stops.")
        # Windows take a search that tests do not shorten.
        page.get_by_label("Seconds of planning").fill("4")
        page.get_by_role("button", name="Plan", exact=True).click()
        wait_until_planned(page)
        says("use-the-page", "move the slider, from the least of the first objective on its left")
        plan = select_last(page)
        says("use-the-page", "a table of the selected tour or plan, with a row for each stop")
        rows = driven(page)
    assert sorted(row["stop"] for row in rows) == [order["Order ID"] for order in asked]
    arrives = {row["stop"]: seconds(row["arrives"]) for row in rows}
    for order in asked:
        # A van that is early waits, so only the end of a window bounds its arrival.
        assert arrives[order["Order ID"]] <= seconds(order["Close"] or "18:00"), order
    loads: dict[str, int] = {}
    for row in rows:
        loads[row["vehicle"]] = loads.get(row["vehicle"], 0) + int(row["load"])
    assert len(loads) == len(plan["routes"])
    assert max(loads.values()) <= CAPACITY
    assert sum(loads.values()) == sum(int(order["Qty"]) for order in asked)
