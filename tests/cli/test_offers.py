"""The command `paretour offers`: what it prints, and what it refuses."""

import asyncio
import json
from pathlib import Path

import httpx

from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.command import paretour
from tests.helpers.offers import FIVE, HOUR, LIMITS, NEW_PLACE, NINE, fleet_request, stored_fleet
from tests.helpers.serving import app_of, serving

SLOTS = [[NINE + HOUR, NINE + 2 * HOUR], [FIVE + HOUR, FIVE + 2 * HOUR]]
ASKED = {
    "order": {"id": "new", "location": NEW_PLACE, "demand": [1]},
    "slots": SLOTS,
    "time_limit": 30,
}


def test_slots_are_printed_with_their_price_and_why_others_are_not_possible(tmp_path: Path) -> None:
    file = tmp_path / "asked.json"
    file.write_text(json.dumps(ASKED))
    store = SqliteStore(IN_MEMORY, entries=100, max_age=600)
    asyncio.run(store.put(stored_fleet(fleet_request())))
    with serving(app_of(store=store, limits=LIMITS), warm=False) as url:
        printed = paretour("offers", "the-front", file, "--url", url, COLUMNS="200")
        assert printed.returncode == 0, printed.stderr
        [row] = [line for line in printed.stdout.splitlines() if "10:00" in line]
        assert "van" in row
        assert "18:00 to 19:00: not possible. van: " in printed.stdout
        as_json = paretour("offers", "the-front", file, "--url", url, "--json")
        answer = httpx.post(f"{url}/front/the-front/offers", json=ASKED, timeout=300).json()
        assert json.loads(as_json.stdout)["offers"] == answer["offers"]
        refused = paretour("offers", "none", file, "--url", url)
    assert refused.returncode == 2
    assert "there is no front 'none'" in refused.stderr
