"""Who may call and how often, against a live server."""

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from service.api.app import Edge
from service.api.auth import Access, Rates
from service.api.keys import KeyHash, new_key
from tests.helpers.command import paretour
from tests.helpers.redis_server import redis_server
from tests.helpers.serving import app_of, problem, serving

FRONT = {"coordinates": [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2]], "time_limit": 0}
OPEN = {"/health/live", "/health/ready"}
DISPATCH, DISPATCH_HASH = new_key()
DISPATCH_NEXT, DISPATCH_NEXT_HASH = new_key()
LAB, LAB_HASH = new_key()
HASHES = [
    KeyHash(caller="dispatch", digest=DISPATCH_HASH),
    KeyHash(caller="dispatch", digest=DISPATCH_NEXT_HASH),
    KeyHash(caller="lab", digest=LAB_HASH),
]


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of(edge=Edge(access=Access(HASHES)))) as address:
        yield address


@pytest.fixture
def limited() -> Iterator[str]:
    edge = Edge(access=Access(HASHES, Rates("3/hour")))
    with serving(app_of(edge=edge), warm=False) as address:
        yield address


def quota(answer: httpx.Response) -> tuple[int, int]:
    """Return the requests left and the seconds that the answer's headers say, of a rate of 3."""
    assert answer.headers["ratelimit-policy"] == '"default";q=3;w=3600'
    said = re.fullmatch(r'"default";r=(\d+);t=(\d+)', answer.headers["ratelimit"])
    assert said is not None
    return int(said[1]), int(said[2])


def bearing(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


@pytest.mark.parametrize("key", [DISPATCH, DISPATCH_NEXT, LAB], ids=["one", "its next", "other"])
def test_a_key_lets_its_caller_in(url: str, key: str) -> None:
    answer = httpx.post(f"{url}/front", json=FRONT, headers=bearing(key))
    assert answer.status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Authorization": ""},
        {"Authorization": "Bearer"},
        bearing("nobody's"),
        bearing(DISPATCH_HASH),
        bearing(DISPATCH + "x"),
        {"Authorization": f"Basic {DISPATCH}"},
        {"Authorization": DISPATCH},
        {"X-API-Key": DISPATCH},
    ],
)
def test_a_caller_without_a_key_is_refused(url: str, headers: dict[str, str]) -> None:
    answer = httpx.post(f"{url}/front", json=FRONT, headers=headers)
    problem(answer, 401, "unauthorized")
    assert answer.headers["www-authenticate"] == "Bearer"


def test_a_key_is_never_said_again(url: str) -> None:
    assert "secret" not in httpx.get(f"{url}/actors", headers=bearing("secret")).text


def test_every_path_needs_a_key_but_the_open_ones(url: str) -> None:
    document = httpx.get(f"{url}/openapi.json").json()
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            asked = httpx.request(method, url + re.sub(r"\{.*?\}", "x", path))
            assert (asked.status_code == 401) == (path not in OPEN), (method, path)
            assert ({"401", "429"} <= set(operation["responses"])) == (path not in OPEN)
            assert bool(operation["security"]) == (path not in OPEN)


def test_without_keys_the_document_asks_for_none() -> None:
    with serving(app_of(), warm=False) as url:
        document = httpx.get(f"{url}/openapi.json").json()
    operations = [each for path in document["paths"].values() for each in path.values()]
    assert not any(operation.get("security") for operation in operations)


def test_a_caller_over_its_rate_is_told_when_to_come_back_and_others_are_not(limited: str) -> None:
    for key in (DISPATCH, DISPATCH_NEXT, DISPATCH):
        assert httpx.get(f"{limited}/actors", headers=bearing(key)).status_code == 200
    refused = httpx.get(f"{limited}/actors", headers=bearing(DISPATCH))
    document = problem(refused, 429, "rate-limited")
    assert document["limit"] == 3
    assert 3500 < int(refused.headers["retry-after"]) <= 3600
    assert quota(refused) == (0, int(refused.headers["retry-after"]))
    assert httpx.get(f"{limited}/actors", headers=bearing(LAB)).status_code == 200
    assert httpx.get(f"{limited}/health/live").status_code == 200


def test_every_answer_that_is_counted_says_what_is_left(limited: str) -> None:
    with httpx.Client(base_url=limited, headers=bearing(LAB)) as client:
        accepted = client.post("/front", json=FRONT, headers={"Prefer": "respond-async"})
        malformed = client.post("/fleet", json=[])
        unknown = client.get("/front/x")
    assert [accepted.status_code, malformed.status_code, unknown.status_code] == [202, 422, 404]
    assert [quota(answer)[0] for answer in (accepted, malformed, unknown)] == [2, 1, 0]
    assert all(3500 < quota(answer)[1] <= 3600 for answer in (accepted, malformed, unknown))


def test_answers_that_are_not_counted_name_no_rate(url: str, limited: str) -> None:
    for answer in (
        httpx.get(f"{url}/actors", headers=bearing(LAB)),  # of a service without a rate
        httpx.get(f"{limited}/actors", headers=bearing("nobody's")),
        httpx.get(f"{limited}/health/live"),
        httpx.get(f"{limited}/guide/"),
    ):
        assert not [name for name in answer.headers if name.startswith("ratelimit")]


def test_without_keys_each_address_has_a_rate_and_a_latest_front() -> None:
    edge = Edge(access=Access((), Rates("3/hour")))
    with serving(app_of(edge=edge)) as url:
        # uvicorn trusts the header where the proxy is at 127.0.0.1.
        one, other = ({"X-Forwarded-For": f"203.0.113.{last}"} for last in (1, 2))
        planned = httpx.post(f"{url}/front", json=FRONT, headers=one)
        assert (planned.status_code, quota(planned)[0]) == (200, 2)
        assert httpx.get(f"{url}/tour?angle=30", headers=one).status_code == 200
        assert quota(httpx.get(f"{url}/front/x", headers=one))[0] == 0
        refused = httpx.get(f"{url}/actors", headers=one)
        assert "203.0.113.1" in problem(refused, 429, "rate-limited")["detail"]
        assert 0 < int(refused.headers["retry-after"]) <= 7200
        assert quota(refused) == (0, int(refused.headers["retry-after"]))
        problem(httpx.get(f"{url}/tour?angle=30", headers=other), 404, "no-front")
        assert httpx.get(f"{url}/health/live", headers=one).status_code == 200


@pytest.mark.parametrize(
    ("addresses", "allowed"),
    [
        (["2001:db8::1", "2001:db8::2", "2001:db8::3"], [200, 200, 429]),
        (["2001:db8:0:1::1", "2001:db8:0:2::1", "2001:db8:0:3::1"], [200, 200, 200]),
        (["not an address"] * 3, [200, 200, 429]),
    ],
    ids=["one network", "three networks", "no address"],
)
def test_an_address_of_ipv6_is_the_network_that_a_client_has(
    addresses: list[str], allowed: list[int]
) -> None:
    edge = Edge(access=Access((), Rates("2/day")))
    with serving(app_of(edge=edge), warm=False) as url:
        answers = [
            httpx.get(f"{url}/actors", headers={"X-Forwarded-For": address})
            for address in addresses
        ]
    assert [answer.status_code for answer in answers] == allowed


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("dispatch", "the hash after CALLER: must be 64 hexadecimal digits"),
        (f"dispatch:{DISPATCH}", "the hash after CALLER: must be 64 hexadecimal digits"),
        (f"dispatch:{DISPATCH_HASH.upper()}x", "the hash after CALLER"),
        (f"two words:{DISPATCH_HASH}", "a caller must be named"),
        (f":{DISPATCH_HASH}", "a caller must be named"),
    ],
    ids=["no hash", "the key itself", "65 digits", "a name with a space", "no name"],
)
def test_an_entry_without_a_hash_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        KeyHash.read(text)


def test_a_hash_is_read_as_it_is_written() -> None:
    assert KeyHash.read(f"lab:{LAB_HASH}") == HASHES[2]


def test_the_command_makes_no_key_for_a_name_that_no_entry_can_hold() -> None:
    made = paretour("key", "the lab")
    assert (made.returncode, made.stdout) == (2, "")
    assert "a caller must be named by 1 to 64 letters, digits, dots, dashes" in made.stderr


def test_replicas_count_together_in_redis_and_go_on_without_it(tmp_path: Path) -> None:
    with redis_server(tmp_path) as redis:
        edges = [Edge(access=Access(HASHES, Rates("3/hour", redis.url))) for _ in range(2)]
        one_app, other_app = (app_of(edge=edge) for edge in edges)
        with serving(one_app, warm=False) as one, serving(other_app, warm=False) as other:
            counted = [httpx.get(f"{url}/actors", headers=bearing(LAB)) for url in (one, other) * 2]
            assert [answer.status_code for answer in counted] == [200, 200, 200, 429]
            assert 3500 < int(counted[3].headers["retry-after"]) <= 3600
            assert [quota(answer)[0] for answer in counted] == [2, 1, 0, 0]
            redis.end()
            uncounted = httpx.get(f"{one}/actors", headers=bearing(LAB))
            assert uncounted.status_code == 200
            assert "ratelimit" not in uncounted.headers
