"""The tools over stdio and over HTTP, called as an agent calls them."""

import asyncio
import json
import os
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from mcp import Client, StdioServerParameters, stdio_client
from mcp.client.streamable_http import streamable_http_client
from mcp.shared._httpx_utils import create_mcp_http_client

from service.api.app import Edge
from service.api.auth import Access
from service.api.keys import KeyHash, new_key
from service.requests.limits import Limits
from tests.helpers.command import ROOT, paretour
from tests.helpers.engines import engine_of
from tests.helpers.serving import app_of, problem, serving

LIMITS = Limits(body_bytes=2**21, cities=2000, cells=900, preferences=20, size=100, seconds=0.2)
STOPS = [
    {"id": f"order-{i}", "location": [24.9 + i / 100, 60.1 + i * i % 7 / 100]} for i in range(9)
]
OBJECTIVES = [
    {"name": "way", "unit": "m", "from": "great_circle"},
    {"name": "hills", "matrix": [[abs(i * 3 % 5 - j * 2 % 7) for j in range(9)] for i in range(9)]},
]
FRONT = {"stops": STOPS, "objectives": OBJECTIVES, "time_limit": 0.1}
FLEET = {
    "stops": [STOPS[0], *({**stop, "demand": [1]} for stop in STOPS[1:])],
    "vehicles": [{"id": "van", "count": 3, "start": 0, "end": 0, "capacity": [4]}],
    "objectives": [
        {"name": "total", "from": "great_circle"},
        {"name": "longest", "from": "great_circle", "over": "max"},
    ],
    "time_limit": 0.1,
}
HEADERS = {"Accept": "application/json, text/event-stream", "MCP-Protocol-Version": "2025-06-18"}
LIST = {"jsonrpc": "2.0", "id": 1, "method": "tools/list"}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of(limits=LIMITS, edge=Edge(agents=True))) as address:
        yield address


@asynccontextmanager
async def agent(url: str, key: str | None = None) -> AsyncIterator[Client]:
    """An agent of the service at an address."""
    headers = None if key is None else {"Authorization": f"Bearer {key}"}
    async with (
        create_mcp_http_client(headers=headers) as http,
        Client(streamable_http_client(f"{url}/mcp", http_client=http)) as client,
    ):
        yield client


async def call(client: Client, tool: str, **arguments: Any) -> Any:
    """The answer to a call, which is not an error."""
    return json.loads(await said(client, tool, False, **arguments))


async def said(client: Client, tool: str, is_error: bool, **arguments: Any) -> str:
    """The text of an answer, which is small."""
    result = await client.call_tool(tool, arguments)
    [content] = result.content
    assert result.is_error == is_error, content
    assert len(content.text.encode()) <= 8000
    return str(content.text)


def test_an_agent_plans_explains_chooses_and_replans(url: str) -> None:
    async def talk() -> None:
        async with agent(url) as client:
            listed = {tool.name: tool for tool in (await client.list_tools()).tools}
            assert len(listed) == 8
            assert "at_most" in listed["choose_tour"].input_schema["properties"]
            planned = await call(client, "plan_front", **FRONT)
            front = planned["front"]
            assert planned["link"] == f"{url}/#front={front}"
            stored = httpx.get(f"{url}/front/{front}").json()["front"]
            lengths = np.array([tour["lengths"] for tour in stored])
            assert planned["ranges"]["hills"] == [lengths[:, 1].min(), lengths[:, 1].max()]
            assert sorted(planned["stops"]) == sorted(stop["id"] for stop in STOPS)

            lost = [*STOPS[:-1], {**STOPS[-1], "location": [0, 0]}]
            noted = await call(client, "plan_front", **{**FRONT, "stops": lost})
            assert "lies at longitude 0 and latitude 0" in noted["notes"][0]
            assert "notes" not in planned

            explained = await call(client, "explain_front", front=front)
            for sentence in explained["trades"]:
                number = int(sentence.rpartition(" ")[2])
                assert f"{lengths[number, int('less way' not in sentence)]:.6g}" in sentence

            budget = float(np.median(lengths[:, 0]))
            chosen = await call(client, "choose_tour", front=front, at_most={"way": budget})
            within = lengths[lengths[:, 0] <= budget]
            assert chosen["lengths"]["hills"] == within[:, 1].min()
            assert chosen["stops"] == stored[chosen["number"]]["stops"]
            for way in ({"knee": True}, {"balance": 0.5}, {"weights": {"way": 1, "hills": 2}}):
                assert await call(client, "choose_tour", front=front, **way)

            rest = await call(
                client, "replan", front=front, done=chosen["stops"][:3], tour=chosen["stops"]
            )
            assert chosen["stops"][1] not in rest["stops"]

    asyncio.run(talk())


def test_an_agent_plans_a_fleet_and_a_file(url: str) -> None:
    async def talk() -> None:
        async with agent(url) as client:
            fleet = await call(client, "plan_fleet", **FLEET)
            served = {stop for route in fleet["routes"] for stop in route["stops"]}
            assert served == {stop["id"] for stop in STOPS}
            assert {route["vehicle"] for route in fleet["routes"]} == {"van"}
            assert await call(client, "choose_tour", front=fleet["front"], knee=True)
            narrow = {**FLEET["vehicles"][0], "max_stops": 1}
            refused = await said(client, "plan_fleet", True, **{**FLEET, "vehicles": [narrow]})
            assert "and leave the others out" in refused
            assert '"path": "/stops/1/prize"' in refused
            table = "\n".join(f"{i},{i * i % 7},{i * 3 % 5},{i}" for i in range(9))
            planes = [
                {"name": f"{at}", "taken_for": field}
                for at, field in enumerate(("x", "y", "second x", "second y"), 1)
            ]
            asked = {"text": table, "name": "cities.csv", "time_limit": 0.1}
            file = await call(client, "plan_file", **asked, columns=planes)
            assert sorted(file["stops"]) == list(range(9))
            assert any("'3' (second x)" in note for note in file["assumed"])

    asyncio.run(talk())


def test_a_long_tour_is_read_in_parts_of_bounded_size(url: str) -> None:
    ids = [f"order-{i}-{'ü' * 60}" for i in range(2000)]
    planes = np.random.default_rng(5).random((2, 2000, 2)).tolist()
    request = {
        "stops": [{"id": each} for each in ids],
        "objectives": [
            {"name": name * 99, "coordinates": plane}
            for name, plane in zip("äö", planes, strict=True)
        ],
        "time_limit": 0,
    }

    async def talk() -> None:
        async with agent(url) as client:
            front = (await call(client, "plan_front", **request))["front"]
            await call(client, "explain_front", front=front)
            tour = httpx.get(f"{url}/front/{front}").json()["front"][0]["stops"]
            read: list[str] = []
            while len(read) < 200:
                part = await call(
                    client, "choose_tour", front=front, number=0, first_stop=len(read)
                )
                assert f"{2000 - len(part['stops'])} of 2000 stops" in part["left_out"]
                read += part["stops"]
            assert read == tour[: len(read)]
            last = await call(client, "choose_tour", front=front, number=0, first_stop=1999)
            assert last["stops"] == tour[1999:]

    asyncio.run(talk())


@pytest.mark.parametrize(
    ("tool", "arguments", "sentence"),
    [
        ("explain_front", {"front": "x"}, "there is no front 'x' (unknown-front)"),
        ("plan_front", {"stopps": []}, "stopps is not a field that this request has; did you"),
        ("plan_front", {"coordinates": [[1, 2]]}, "(invalid-"),
        ("plan_file", {"text": "?"}, "stops.csv"),
        ("plan_file", {"text": "1 40 50 0\n2 45 68 10\n"}, '"columns": {"1": "id", "2": "detail"'),
        ("dispatch", {}, "tool must be one of plan_front, "),
    ],
)
def test_an_error_is_a_sentence(
    url: str, tool: str, arguments: dict[str, Any], sentence: str
) -> None:
    async def talk() -> str:
        async with agent(url) as client:
            return await said(client, tool, True, **arguments)

    assert sentence in asyncio.run(talk())


def test_replicas_of_a_cluster_answer_an_agent_alike(
    request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    (tmp_path / "begun").touch()  # so that the second replica leaves the first one's records
    edge = Edge(agents=True)

    async def talk(first: str, second: str) -> None:
        async with agent(first) as client:
            front = (await call(client, "plan_front", **FRONT))["front"]
        async with agent(second) as client:
            assert await call(client, "explain_front", front=front)
            chosen = await call(client, "choose_tour", front=front, knee=True)
            rest = await call(client, "replan", front=front, done=chosen["stops"][:3])
            assert chosen["stops"][1] not in rest["stops"]
            fleet = await call(client, "plan_fleet", **FLEET)
            assert {route["vehicle"] for route in fleet["routes"]} == {"van"}
            assert "unknown-front" in await said(client, "explain_front", True, front="x")

    with (
        engine_of("cluster", request) as cluster,
        cluster.serve(edge=edge) as one,
        cluster.serve(edge=edge, folder=tmp_path) as other,
    ):
        asyncio.run(talk(*(str(each.client.base_url).rstrip("/") for each in (one, other))))


def test_a_key_is_required_where_keys_are_set_and_fronts_belong_to_it() -> None:
    keys = {name: new_key() for name in ("me", "you")}
    hashes = [KeyHash(caller=name, digest=digest) for name, (_, digest) in keys.items()]
    edge = Edge(agents=True, access=Access(hashes))

    async def talk(url: str) -> None:
        async with agent(url, keys["me"][0]) as client:
            front = (await call(client, "plan_front", **FRONT))["front"]
        async with agent(url, keys["you"][0]) as client:
            assert "unknown-front" in await said(client, "explain_front", True, front=front)

    with serving(app_of(limits=LIMITS, edge=edge)) as url:
        problem(httpx.post(f"{url}/mcp", json=LIST, headers=HEADERS), 401, "unauthorized")
        asyncio.run(talk(url))


def test_a_message_has_the_limits_of_a_body(url: str) -> None:
    def post(content: bytes, **headers: str) -> httpx.Response:
        sent = {**HEADERS, "Content-Type": "application/json", **headers}
        return httpx.post(f"{url}/mcp", content=content, headers=sent)

    problem(post(b" " * (2**21 + 1)), 413, "body-too-long")
    problem(post(b"{}", **{"Content-Type": "text/plain"}), 415, "not-json")
    problem(httpx.get(f"{url}/mcp", headers=HEADERS), 405, "method-not-allowed")
    for nonsense in (b"{", b"[]", b"[" * 10_000, b'{"jsonrpc": "2.0", "id": 1, "method": 3}'):
        answer = post(nonsense)
        assert answer.status_code == 400
        assert "error" in answer.json()
    assert post(json.dumps(LIST).encode()).json()["result"]["tools"]


def test_agents_are_not_served_unless_the_operator_says_so() -> None:
    code = "import sys, service.server, service.cli.commands; sys.exit('mcp' in sys.modules)"
    assert asyncio.run(_status(code)) == 0
    with serving(app_of()) as url:
        problem(httpx.post(f"{url}/mcp", json=LIST, headers=HEADERS), 404, "no-such-path")


async def _status(code: str) -> int | None:
    process = await asyncio.create_subprocess_exec(sys.executable, "-c", code, cwd=ROOT)
    return await process.wait()


@pytest.mark.parametrize("remote", [False, True])
def test_an_agent_plans_over_stdio(url: str, remote: bool) -> None:
    options = ["--url", url] if remote else []
    command = StdioServerParameters(
        command=sys.executable, args=["-m", "service", "mcp", *options], cwd=ROOT
    )

    async def talk() -> None:
        async with Client(stdio_client(command)) as client:
            planned = await call(client, "plan_front", **FRONT)
            assert ("link" in planned) == remote
            assert await call(client, "explain_front", front=planned["front"])
            assert "unknown-front" in await said(client, "explain_front", True, front="x")

    asyncio.run(talk())


def test_a_wrong_address_ends_the_command() -> None:
    ended = paretour("mcp", "--url", "ftp://x")
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "--url must be a URL" in ended.stderr


@pytest.mark.parametrize(("command", "setting"), [("mcp", "0"), ("serve", "1")])
def test_a_missing_extra_is_named_at_the_start(command: str, setting: str) -> None:
    code = "import sys; sys.modules['mcp'] = None; from service.__main__ import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", code, command],
        cwd=ROOT,
        env={**os.environ, "PARETOUR_MCP": setting},
        capture_output=True,
        text=True,
    )
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "agents need the extra paretour[mcp]" in ended.stderr
