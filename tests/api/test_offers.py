"""POST /front/{id}/offers against a live server."""

import asyncio
from collections.abc import Iterator

import httpx
import pytest
from paretour import Client

from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.offers import FIVE, HOUR, LIMITS, NEW_PLACE, NINE, fleet_request, stored_fleet
from tests.helpers.serving import app_of, problem, serving
from tests.helpers.stores import job

ASKED = {
    "order": {"id": "new", "location": NEW_PLACE, "demand": [1]},
    "every": {"from": NINE, "to": FIVE, "length": HOUR},
    "time_limit": 30,
}


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    store = SqliteStore(IN_MEMORY, entries=100, max_age=600)
    asyncio.run(store.put(stored_fleet(fleet_request())))
    app = app_of(store=store, limits=LIMITS)
    with serving(app, warm=False) as address, httpx.Client(base_url=address, timeout=300) as client:
        asyncio.run(store.put(job("queued", caller="anonymous")))
        yield client


def test_slots_are_offered_and_nothing_is_changed(client: httpx.Client) -> None:
    before = client.get("/front/the-front").json(), client.get("/front").json()
    with Client(str(client.base_url), timeout=300) as caller:
        found = caller.offers("the-front", **ASKED)
    assert found.front == "the-front"
    assert [each.slot for each in found.offers] == [
        (NINE + i * HOUR, NINE + (i + 1) * HOUR) for i in range(8)
    ]
    assert found.possible
    for offer, item in zip(found.offers, found.document["offers"], strict=True):
        assert offer.possible == item["possible"]
        assert [choice.vehicle for choice in offer.choices] == ["van"] * len(
            item.get("choices", [])
        )
        assert offer.replan == item.get("replan")
    assert (client.get("/front/the-front").json(), client.get("/front").json()) == before


@pytest.mark.parametrize(
    ("front", "status", "code"),
    [("none", 404, "unknown-front"), ("queued", 409, "not-replannable")],
)
def test_other_fronts_have_no_offers(
    client: httpx.Client, front: str, status: int, code: str
) -> None:
    problem(client.post(f"/front/{front}/offers", json=ASKED), status, code)
