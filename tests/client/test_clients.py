"""Both clients, synchronous and asynchronous, against a service."""

import asyncio
from inspect import signature
from io import BytesIO
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import AsyncClient, Client, Refused
from PIL import Image

from tests.helpers.answers import FRONT, Connect

CITIES = np.random.default_rng(3).random((12, 4))
MANY = np.random.default_rng(4).random((300, 4))


def test_a_job_of_the_service_is_followed_to_its_end(
    long_search_url: str, connect: Connect
) -> None:
    job = connect(long_search_url).submit(coordinates=MANY, time_limit=1.5)
    heard = list(job.progress())
    found = job.result()
    assert heard
    assert (np.diff([progress.hypervolume for progress in heard]) >= 0).all()
    assert (found.id, found.status) == (job.id, "done")
    assert found.points >= heard[0].points > 0


def test_a_job_of_the_service_is_cancelled_and_forgotten(
    long_search_url: str, connect: Connect
) -> None:
    job = connect(long_search_url).submit(coordinates=MANY, time_limit=60)
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


def test_the_service_asks_the_questions_that_the_front_asks(url: str, connect: Connect) -> None:
    client = connect(url)
    found = client.front(coordinates=CITIES)
    first = client.ask(found.id, questions=1, options=4)
    assert [each.point.tolist() for each in first.options] == [
        each.point.tolist() for each in found.ask(questions=1, options=4).options
    ]
    end = client.ask(found.id, [2], questions=1, options=4)
    assert end.chosen == found.ask([2], questions=1, options=4).chosen
    assert end.document["tour"]["tour"] == found[end.chosen].tour.tolist()


def test_a_front_of_stops_is_given_as_geojson(url: str, connect: Connect) -> None:
    client = connect(url)
    stops = [{"id": name, "location": [24.9 + k, 60.2]} for k, name in enumerate("ab")]
    objectives = [{"name": name, "from": "great_circle"} for name in ("way", "again")]
    found = client.front(stops=stops, objectives=objectives, time_limit=0)
    [line, *points] = client.geojson(found.id)["features"]
    assert line["geometry"]["coordinates"] == [[24.9, 60.2], [25.9, 60.2], [24.9, 60.2]]
    assert [point["id"] for point in points] == ["a", "b"]
    with pytest.raises(Refused, match="no-router"):
        client.geojson(found.id, geometry="roads")


def test_the_newest_fronts_are_listed(url: str, connect: Connect) -> None:
    client = connect(url)
    made = [client.front(coordinates=CITIES, time_limit=0).id for _ in range(3)]
    newest, older = client.fronts(most=2)
    assert [newest.id, older.id] == made[:0:-1]
    assert (newest.kind, newest.status, newest.cities) == ("front", "done", len(CITIES))
    assert newest.stored_at >= older.stored_at


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


def test_without_a_service_there_is_an_error_of_transport(connect: Connect) -> None:
    with pytest.raises(httpx.TransportError):
        connect("http://127.0.0.1:1").actors()


def test_the_rest_of_a_front_is_replanned_at_once_and_as_a_job(url: str, connect: Connect) -> None:
    client = connect(url)
    front = client.front(coordinates=CITIES, time_limit=0, preferences=20)
    driven = front.choose(balance=0.5)
    changes = {"done": driven.tour[:4].tolist(), "tour": driven.tour.tolist(), "time_limit": 0}
    rest = client.replan(front, **changes)
    assert {tour[0] for tour in rest.stops} == {str(driven.tour[3])}
    assert rest.kept is not None
    assert [item["kept"] for item in rest.document["front"]] == rest.kept.tolist()
    assert rest.choose(balance=0).kept == rest.kept[0] == client.tour(balance=0, front=rest.id).kept
    assert client.submit_replan(front.id, **changes).result().lengths.tolist() == (
        rest.lengths.tolist()
    )
    assert (front.kept, driven.kept) == (None, None)


def test_hundreds_of_calls_gathered_wait_for_their_turns_and_all_are_answered(url: str) -> None:
    async def plan_all() -> list[int]:
        # Patience for no more than one refusal: waiting for a turn uses none of it.
        async with AsyncClient(url, patience=1, timeout=300) as client:
            calls = [
                client.front(coordinates=CITIES[: 3 + n % 9], time_limit=0, preferences=1)
                for n in range(300)
            ]
            return [front.tours.shape[1] for front in await asyncio.gather(*calls)]

    assert asyncio.run(plan_all()) == [3 + n % 9 for n in range(300)]


def test_a_question_about_a_job_does_not_wait_for_calls_that_plan() -> None:
    async def ask() -> list[Any]:
        answered = asyncio.Event()

        async def service(request: httpx.Request) -> httpx.Response:
            if request.method == "POST":
                await answered.wait()
            return httpx.Response(200, json=FRONT)

        async with AsyncClient("service", transport=httpx.MockTransport(service)) as client:
            planned = [asyncio.create_task(client.front(coordinates=CITIES)) for _ in range(20)]
            await asyncio.sleep(0)  # they take their turns
            found = await client.job("f").front()
            answered.set()
            return [found, *await asyncio.gather(*planned)]

    assert [front.id for front in asyncio.run(ask())] == 21 * ["f"]


def test_both_clients_have_the_same_methods_with_the_same_parameters_and_help() -> None:
    names = [name for name in vars(Client) if not name.startswith("_")]
    assert names == [name for name in vars(AsyncClient) if not name.startswith("_")]
    for name in names:
        method, same = getattr(Client, name), getattr(AsyncClient, name)
        assert signature(method).parameters == signature(same).parameters
        assert method.__doc__ == same.__doc__
