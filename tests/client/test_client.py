"""The client, awaiting or not, against a service and against answers that a service might give."""

import asyncio
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from io import BytesIO
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import AsyncClient, Client, Refused
from paretour.calls import Calls
from paretour.errors import pause_before_next
from PIL import Image

from tests.helpers.serving import LIMITS, app_of, serving
from tests.helpers.waiting import Waiting

CITIES = np.random.default_rng(3).random((12, 4))
MANY = np.random.default_rng(4).random((300, 4))
FRONT = {
    "id": "f",
    "status": "done",
    "cities": 3,
    "front": [
        {"angle": 60.0, "lengths": [1.0, 2.0], "tour": [0, 1, 2]},
        {"angle": 30.0, "lengths": [2.0, 1.0], "tour": [0, 2, 1]},
    ],
    "points": 2,
    "hypervolume": 0.5,
    "hypervolume_bound": None,
    "reference_point": [3.0, 3.0],
    "scale": [1.0, 1.0],
    "actor": {"name": "pa-one", "digest": "0"},
    "timings_ms": {},
    "terminated": "converged",
}
EMPTY = FRONT | {"status": "running", "front": [], "points": 0, "terminated": None}
Connect = Callable[..., Any]


@pytest.fixture(params=[Client, AsyncClient])
def connect(request: pytest.FixtureRequest) -> Iterator[Connect]:
    """How a client of either kind is made, to be called as if it waited."""
    with asyncio.Runner() as runner:
        opened = []

        def make(url: str = "http://service", **options: Any) -> Any:
            made = request.param(url, **options)
            opened.append(made if isinstance(made, Client) else Waiting(made, runner))
            return opened[-1]

        yield make
        for client in opened:
            client.close()


class Answers(httpx.MockTransport):
    """A service that gives these answers, one after the other, and remembers the questions."""

    def __init__(self, *answers: httpx.Response | Exception) -> None:
        super().__init__(self._answer)
        self._answers = iter(answers)
        self.asked: list[httpx.Request] = []

    def _answer(self, request: httpx.Request) -> httpx.Response:
        self.asked.append(request)
        answer = next(self._answers)
        if isinstance(answer, Exception):
            raise answer
        return answer


def front(**changed: Any) -> httpx.Response:
    return httpx.Response(200, json=FRONT | changed)


def problem(status: int, code: str, **headers: str) -> httpx.Response:
    document = {"status": status, "code": code, "detail": "it is so", "request_id": "r"}
    headers["Content-Type"] = "application/problem+json"
    return httpx.Response(status, content=json.dumps(document), headers=headers)


def events(*items: tuple[str, dict[str, Any]]) -> httpx.Response:
    text = ": heartbeat\n\n" + "".join(
        f"event: {kind}\ndata: {json.dumps(data)}\n\n" for kind, data in items
    )
    return httpx.Response(200, text=text, headers={"Content-Type": "text/event-stream"})


def status(name: str) -> tuple[str, dict[str, Any]]:
    return "status", {"id": "f", "status": name}


def progress(hypervolume: float) -> tuple[str, dict[str, Any]]:
    return "progress", {"seconds": 0.1, "hypervolume": hypervolume, "points": 3}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="module")
def patient_url() -> Iterator[str]:
    """Of a service with which a search may take a minute."""
    with serving(app_of(limits=replace(LIMITS, seconds=60, cities=300))) as address:
        yield address


def test_a_job_of_the_service_is_followed_to_its_end(patient_url: str, connect: Connect) -> None:
    job = connect(patient_url).submit(coordinates=MANY, time_limit=1.5)
    heard = list(job.progress())
    found = job.result()
    assert heard
    assert (np.diff([progress.hypervolume for progress in heard]) >= 0).all()
    assert (found.id, found.status) == (job.id, "done")
    assert found.points >= heard[0].points > 0


def test_a_job_of_the_service_is_cancelled_and_forgotten(
    patient_url: str, connect: Connect
) -> None:
    job = connect(patient_url).submit(coordinates=MANY, time_limit=60)
    for progress in job.progress():
        assert progress.points > 0
        break
    found = job.cancel()
    assert (found.status, found.terminated) == ("cancelled", "cancelled")
    assert len(found.tours) > 0
    assert job.result().hypervolume == found.hypervolume
    job.forget()
    with pytest.raises(Refused, match="unknown-front"):
        job.front()


def test_a_front_is_what_the_service_answers(url: str, connect: Connect) -> None:
    found = connect(url).front(coordinates=CITIES, time_limit=0, preferences=20)
    request = {"coordinates": CITIES.tolist(), "time_limit": 0, "preferences": 20}
    answer = httpx.post(f"{url}/front", json=request).json()
    np.testing.assert_array_equal(found.tours, [item["tour"] for item in answer["front"]])
    np.testing.assert_array_equal(found.lengths, [item["lengths"] for item in answer["front"]])
    np.testing.assert_array_equal(found.angles, [item["angle"] for item in answer["front"]])
    np.testing.assert_array_equal(found.scale, answer["scale"])
    np.testing.assert_array_equal(found.reference_point, answer["reference_point"])
    assert found.hypervolume == answer["hypervolume"]
    assert (found.status, found.actor, found.points) == ("done", "pa-one", answer["points"])
    assert found.document.keys() == answer.keys()


def test_matrices_that_are_an_array_are_planned_as_those_that_are_rows(
    url: str, connect: Connect
) -> None:
    matrices = np.random.default_rng(4).random((2, 9, 9))
    client = connect(url)
    as_array = client.front(matrices=matrices, time_limit=0)
    as_rows = client.front(matrices=matrices.tolist(), time_limit=0)
    assert as_array.actor == "pa-one-matrix"
    np.testing.assert_array_equal(as_array.tours, as_rows.tours)
    np.testing.assert_array_equal(as_array.lengths, as_rows.lengths)


def test_places_on_a_map_become_a_front_with_paths(url: str, connect: Connect) -> None:
    grid = np.zeros((6, 8))
    grid[2, :5] = 1
    picture = BytesIO()
    Image.fromarray((255 * (1 - grid)).astype(np.uint8)).save(picture, "PNG")
    layer = np.random.default_rng(0).random((6, 8))
    asked = {"cell_size": 0.5, "spacing": 1.0, "cost_layer": layer, "paths": True, "time_limit": 0}
    found = connect(url).coverage(grid=grid, **asked)
    assert found.tours.shape[1] == len(found.places)
    for index, path in enumerate(found.paths):
        assert path.metres == pytest.approx(found.lengths[index, 0])
        assert set(map(tuple, found.places)) <= set(map(tuple, path.cells))
    assert found.nearest(45).path in found.paths
    of_picture = connect(url).coverage(picture.getvalue(), **asked)
    np.testing.assert_array_equal(of_picture.tours, found.tours)
    tour = connect(url).tour(45, front=of_picture.id)
    np.testing.assert_array_equal(tour.path.cells, of_picture.nearest(45).path.cells)


def test_the_tour_at_an_angle_is_that_of_the_front(url: str, connect: Connect) -> None:
    client = connect(url)
    found = client.front(coordinates=CITIES)
    for asked in (client.tour(30), client.tour(angle=30, front=found.id)):
        nearest = found.nearest(30)
        assert (asked.front, asked.angle) == (found.id, nearest.angle)
        np.testing.assert_array_equal(asked.tour, nearest.tour)
        np.testing.assert_array_equal(asked.lengths, nearest.lengths)


def test_the_actors_are_named(url: str, connect: Connect) -> None:
    named = {actor.name: actor.inputs for actor in connect(url).actors()}
    assert named["pa-one"] == "coordinates"
    assert list(named) == [item["name"] for item in httpx.get(f"{url}/actors").json()["actors"]]


def test_a_refusal_says_what_the_problem_document_says(url: str, connect: Connect) -> None:
    with pytest.raises(Refused, match=r"start must be a city.* \(invalid-request\)") as refused:
        connect(url).front(coordinates=CITIES, start=12)
    assert (refused.value.status, refused.value.code) == (422, "invalid-request")
    assert refused.value.errors[0]["pointer"] == "/start"
    assert refused.value.request_id


def test_a_limit_is_named_in_the_refusal(url: str, connect: Connect) -> None:
    with pytest.raises(Refused) as refused:
        connect(url).front(coordinates=np.zeros((51, 4)))
    assert (refused.value.limit, refused.value.actual) == (50, 51)


def test_what_is_no_problem_document_is_refused_all_the_same(connect: Connect) -> None:
    page = httpx.Response(502, text="<html>", headers={"Content-Type": "text/html"})
    with pytest.raises(Refused, match="502 Bad Gateway") as refused:
        connect(transport=Answers(page)).actors()
    assert refused.value.code == "unknown"


def test_without_a_service_there_is_an_error_of_transport(connect: Connect) -> None:
    with pytest.raises(httpx.TransportError):
        connect("http://127.0.0.1:1").actors()


def test_an_api_key_is_shown_with_every_request(connect: Connect) -> None:
    service = Answers(front(), front())
    client = connect(api_key="secret", transport=service)
    client.front(coordinates=CITIES)
    client.job("f").front()
    assert [asked.headers["authorization"] for asked in service.asked] == ["Bearer secret"] * 2


def test_arrays_travel_as_numbers(connect: Connect) -> None:
    service = Answers(front())
    connect(transport=service).front(
        coordinates=CITIES[:2], preferences=np.array([1.5]), seed=np.int64(3)
    )
    sent = json.loads(service.asked[0].content)
    assert sent == {"coordinates": CITIES[:2].tolist(), "preferences": [1.5], "seed": 3}


def test_arrays_cannot_be_written_to(connect: Connect) -> None:
    found = connect(transport=Answers(front())).front(coordinates=CITIES)
    with pytest.raises(ValueError, match="read-only"):
        found.tours[0, 0] = 1


@pytest.mark.parametrize(
    ("request_", "seconds"),
    [({}, 31), ({"time_limit": 60}, 90), ({"time_limit": 2, "bound": True}, 37)],
)
def test_it_waits_for_as_long_as_the_search_may_take(
    connect: Connect, request_: dict[str, Any], seconds: float
) -> None:
    service = Answers(front())
    connect(transport=service).front(coordinates=CITIES, **request_)
    assert service.asked[0].extensions["timeout"]["read"] == seconds


@pytest.mark.parametrize(("code", "kind"), [(503, "queue-full"), (429, "rate-limited")])
def test_it_asks_again_when_the_service_says_later(connect: Connect, code: int, kind: str) -> None:
    service = Answers(problem(code, kind, **{"Retry-After": "1"}), front())
    began = time.monotonic()
    assert connect(transport=service).front(coordinates=CITIES).id == "f"
    assert time.monotonic() - began >= 1
    assert service.asked[0].content == service.asked[1].content


def test_its_patience_ends(connect: Connect) -> None:
    service = Answers(*[problem(503, "queue-full", **{"Retry-After": "0"})] * 9)
    with pytest.raises(Refused) as refused:
        connect(transport=service, patience=0.45).front(coordinates=CITIES)
    assert refused.value.code == "queue-full"
    assert len(service.asked) == 5


def test_what_is_refused_for_good_is_not_asked_again(connect: Connect) -> None:
    service = Answers(problem(422, "invalid-request", **{"Retry-After": "1"}))
    with pytest.raises(Refused):
        connect(transport=service).front(coordinates=CITIES)
    assert len(service.asked) == 1


def test_pauses_are_those_that_the_service_asks_for() -> None:
    call = Calls(timeout=30, patience=60).actors()
    assert next(call).after == 0
    assert call.send(problem(503, "busy", **{"Retry-After": "7"})).after == 7
    assert call.send(problem(503, "busy", **{"Retry-After": "50"})).after == 50
    with pytest.raises(Refused):
        call.send(problem(503, "busy", **{"Retry-After": "4"}))


@pytest.mark.parametrize(
    ("written", "least", "most"),
    [
        (format_datetime(datetime.now(UTC) + timedelta(hours=1), usegmt=True), 3000, 3600),
        (format_datetime(datetime.now(UTC) - timedelta(hours=1), usegmt=True), 0.1, 0.1),
        ("soon", 1, 1),
    ],
)
def test_a_pause_may_be_written_as_a_date(written: str, least: float, most: float) -> None:
    assert least <= pause_before_next(problem(503, "busy", **{"Retry-After": written})) <= most


def test_a_job_is_submitted_followed_and_fetched(connect: Connect) -> None:
    accepted = httpx.Response(202, json={"id": "f", "status": "queued"})
    service = Answers(
        accepted,
        events(status("queued"), status("running"), progress(0.3), progress(0.4), status("done")),
        events(status("done")),
        front(),
    )
    job = connect(transport=service).submit(coordinates=CITIES, time_limit=20)
    assert job.id == "f"
    assert [item.hypervolume for item in job.progress()] == [0.3, 0.4]
    assert job.result().status == "done"
    post, first, _, last = service.asked
    assert post.headers["prefer"] == "respond-async"
    assert post.extensions["timeout"]["read"] == 30
    assert (first.url.path, last.url.path) == ("/front/f/events", "/front/f")


def test_a_job_has_a_best_front_so_far_even_an_empty_one(connect: Connect) -> None:
    job = connect(transport=Answers(httpx.Response(200, json=EMPTY))).job("f")
    found = job.front()
    assert (found.status, found.tours.shape, found.lengths.shape) == ("running", (0, 3), (0, 2))


def test_a_job_that_failed_raises_its_problem(connect: Connect) -> None:
    why = {"status": 500, "code": "internal-error", "detail": "a fault", "request_id": "r"}
    service = Answers(events(status("failed")), front(status="failed", problem=why))
    with pytest.raises(Refused) as refused:
        connect(transport=service).job("f").result()
    assert refused.value.code == "internal-error"


def test_progress_outlives_connections_that_break(connect: Connect) -> None:
    service = Answers(
        events(status("running"), progress(0.3)),
        httpx.ReadError("reset"),
        problem(503, "queue-full", **{"Retry-After": "0"}),
        events(progress(0.4), status("done")),
    )
    job = connect(transport=service).job("f")
    assert [item.hypervolume for item in job.progress()] == [0.3, 0.4]


def test_progress_of_what_is_gone_for_good_is_refused(connect: Connect) -> None:
    with pytest.raises(Refused):
        list(connect(transport=Answers(problem(404, "unknown-front"))).job("f").progress())


def test_progress_is_not_waited_for_without_end(connect: Connect) -> None:
    service = Answers(*[httpx.ReadError("reset")] * 9)
    with pytest.raises(httpx.ReadError):
        list(connect(transport=service, patience=1).job("f").progress())
    assert len(service.asked) == 2


def test_a_job_that_is_cancelled_keeps_what_it_has_found(connect: Connect) -> None:
    service = Answers(httpx.Response(200, json=EMPTY), front(status="cancelled"))
    assert connect(transport=service).job("f").cancel().status == "cancelled"
    assert [asked.method for asked in service.asked] == ["GET", "DELETE"]


def test_cancelling_does_not_forget_a_job_that_has_ended(connect: Connect) -> None:
    service = Answers(front())
    assert connect(transport=service).job("f").cancel().status == "done"
    assert [asked.method for asked in service.asked] == ["GET"]


def test_cancelling_keeps_the_front_of_a_job_that_ends_meanwhile(connect: Connect) -> None:
    service = Answers(front(status="running"), httpx.Response(204))
    assert len(connect(transport=service).job("f").cancel().tours) == 2


def test_a_front_can_be_forgotten(connect: Connect) -> None:
    service = Answers(httpx.Response(204))
    connect(transport=service).job("f").forget()
    assert (service.asked[0].method, service.asked[0].url.path) == ("DELETE", "/front/f")


def test_the_client_needs_neither_compiler_nor_network() -> None:
    code = (
        "import sys, service.client;"
        "sys.exit(len({'numba', 'onnxruntime', 'fastapi', 'pydantic'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
