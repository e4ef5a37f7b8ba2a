"""Events go on after those that a client has: none comes twice, and the last status always."""

import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from paretour.server_sent_events import EventParser, ServerSentEvent

from tests.helpers.actors import Shuffler
from tests.helpers.engines import Clustered, Embedded, engine_of
from tests.helpers.jobs import LONG, later

Engine = Embedded | Clustered


@pytest.fixture(scope="module", params=["embedded", "cluster"])
def engine(request: pytest.FixtureRequest) -> Iterator[Engine]:
    with engine_of(request.param, request) as engine:
        yield engine


def listen(
    client: httpx.Client, path: str, last: str = "", most: int = 10**9
) -> list[ServerSentEvent]:
    """Return the events that come after one, until they end or there are enough."""
    parser, found = EventParser(), []
    headers = {"Last-Event-ID": last} if last else {}
    with client.stream("GET", f"{path}/events", headers=headers) as answer:
        assert answer.status_code in (200, 204)
        for chunk in answer.iter_raw():
            found += parser.feed(chunk)
            if len(found) >= most:
                break
    return found


def test_a_client_that_connects_again_gets_no_event_twice(engine: Engine) -> None:
    with engine.serve() as served:
        client = served.client
        path = later(client, LONG)
        came: list[ServerSentEvent] = []
        while len([event for event in came if event.type == "progress"]) < 3:
            came += listen(client, path, came[-1].id if came else "", most=1)
        client.delete(path)
        rest = listen(client, path, came[-1].id)
        assert rest[-1].data.endswith('"status":"cancelled"}')
        seen = [(event.type, event.data) for event in (*came, *rest)]
        assert len(seen) == len(set(seen))
        assert all(event.id for event in (*came, *rest))
        # Whatever it has seen before, it is told the end, and the end alone.
        for event in came:
            [end] = listen(client, path, event.id)
            assert end.data == rest[-1].data
        for unknown in ("7", "x" * 500, "running.zz.zz", "..", "done"):
            [end] = listen(client, path, unknown)
            assert end.data == rest[-1].data


def test_a_client_that_knows_the_end_is_told_to_connect_no_more(engine: Engine) -> None:
    with engine.serve() as served:
        client = served.client
        path = later(client)
        end = listen(client, path)[-1]
        answer = client.get(f"{path}/events", headers={"Last-Event-ID": end.id})
        assert (answer.status_code, answer.content) == (204, b"")


def test_the_next_service_goes_on_with_the_events(engine: Engine, tmp_path: Path) -> None:
    gated = Shuffler(tmp_path / "gate")
    gated.close()
    with engine.serve(gated, folder=tmp_path) as served:
        path = later(served.client)
        while not gated.started:
            time.sleep(0.01)
        *_, last = listen(served.client, path, most=1)
    gated.open()
    with engine.serve(gated, folder=tmp_path) as served:
        rest = listen(served.client, path, last.id)
    assert rest[-1].data.endswith('"status":"done"}')
    assert last not in rest
