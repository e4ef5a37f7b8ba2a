"""Questions about fronts over HTTP: of tours and plans, of two to four objectives, refused."""

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest
from paretour.questions import ask
from pydantic_core import to_json

from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.kinds.front_document import joined
from service.requests.task import KindName
from tests.helpers.serving import app_of, problem, serving
from tests.helpers.stores import job, record

KINDS: dict[KindName, str] = {
    "front": "tour",
    "coverage": "tour",
    "fleet": "plan",
    "robots": "plan",
}
OBJECTIVES = {"front": (2, 3, 4), "coverage": (2, 3, 4), "fleet": (2, 3), "robots": (2,)}
STORED = [(kind, m) for kind in KINDS for m in OBJECTIVES[kind]]


def stored(kind: KindName, objectives: int) -> Record:
    """A front of 30 tours or plans, whose routes have lengths, too."""
    directions = np.abs(np.random.default_rng(objectives).normal(size=(30, objectives)))
    lengths = 1 - directions / np.linalg.norm(directions, axis=1, keepdims=True)
    routes = [{"lengths": [0.0] * objectives}]
    lengths = np.array(sorted(lengths.tolist()))
    items = [
        {"lengths": row, **({"tour": [0, 1]} if KINDS[kind] == "tour" else {"routes": routes})}
        for row in lengths.tolist()
    ]
    tours, ends = joined(to_json({"losses": [0.0], **item}) for item in items)
    names = [{"name": f"objective {i}", "unit": None} for i in range(objectives)]
    made = record(f"{kind}-{objectives}", caller="anonymous")
    front = replace(
        made.front, kind=kind, tours=tours, ends=ends, lengths=lengths, objectives=names
    )
    return replace(made, front=front)


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    store = SqliteStore(IN_MEMORY, entries=100, max_age=600)
    fronts = [stored(*each) for each in STORED]
    empty = replace(fronts[0], id="empty", front=fronts[0].front.without_tours())
    for each in (*fronts, empty):
        asyncio.run(store.put(each))
    app = app_of(store=store)
    with serving(app, warm=False) as address, httpx.Client(base_url=address, timeout=300) as client:
        asyncio.run(store.put(job("queued", caller="anonymous")))
        yield client


def asked(client: httpx.Client, front: str, query: str = "") -> dict[str, Any]:
    answer = client.get(f"/front/{front}/questions?{query}")
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


@pytest.mark.parametrize(("kind", "objectives"), STORED)
def test_picks_lead_from_the_worst_of_all_to_a_tour_or_plan(
    client: httpx.Client, kind: KindName, objectives: int
) -> None:
    item, front = KINDS[kind], f"{kind}-{objectives}"
    found = client.get(f"/front/{front}").json()
    lengths = np.array([each["lengths"] for each in found["front"]])
    question = asked(client, front)
    assert question["point"] == lengths.max(axis=0).tolist()
    assert question["best"] == lengths.min(axis=0).tolist()
    assert question["objectives"] == found["objectives"]
    picks: list[int] = []
    while question["left"]:
        assert item not in question
        for option in question["options"]:
            assert (np.array(option["point"]) <= question["point"]).all()
            within = lengths[(lengths <= option["point"]).all(axis=1)]
            assert option["within_reach"] == len(within)
            assert option["best"] == within.min(axis=0).tolist()
        picks.append(len(question["options"]) - 1)
        question = asked(client, front, f"picks={','.join(map(str, picks))}")
    assert len(picks) <= 3
    assert question["number"] == ask(lengths, picks).chosen
    assert question[item] == found["front"][question["number"]]
    assert question["options"] == []


def test_as_many_questions_and_options_are_asked_as_wanted(client: httpx.Client) -> None:
    front = "front-3"
    question = asked(client, front, "questions=1&options=2")
    assert (question["left"], len(question["options"])) == (1, 2)
    end = asked(client, front, "questions=1&options=2&picks=1")
    assert end["tour"]["lengths"] == question["options"][1]["point"]
    assert asked(client, front, "picks=0&picks=1") == asked(client, front, "picks=0,1")
    assert asked(client, front, "picks=") == asked(client, front)


@pytest.mark.parametrize(
    ("query", "parameter", "sentence"),
    [
        ("questions=0", "questions", 'questions must be at least 1, got "0"'),
        ("questions=11", "questions", 'questions must be at most 10, got "11"'),
        ("options=1", "options", 'options must be at least 2, got "1"'),
        ("options=7", "options", 'options must be at most 6, got "7"'),
        ("picks=6", "picks.0", "picks.0 must be less than 6"),
        ("picks=0,a", "picks.1", "picks.1 must be a valid integer"),
        ("picks=2&options=2", "picks", "picks must each be the number of an option, here from 0"),
        ("picks=0,0&questions=1", "picks", "picks must be at most 1, one a question, got 2"),
        ("pick=1", "pick", "pick is not a field that this request has"),
    ],
)
def test_a_wrong_query_is_named(
    client: httpx.Client, query: str, parameter: str, sentence: str
) -> None:
    answer = client.get(f"/front/front-2/questions?{query}")
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["parameter"] == parameter
    assert document["detail"].startswith(sentence)


@pytest.mark.parametrize(
    ("front", "status", "code"),
    [
        ("nowhere", 404, "unknown-front"),
        ("empty", 404, "no-tour"),
        ("queued", 409, "front-unfinished"),
    ],
)
def test_a_front_that_has_no_questions_yet_says_why(
    client: httpx.Client, front: str, status: int, code: str
) -> None:
    problem(client.get(f"/front/{front}/questions"), status, code)
