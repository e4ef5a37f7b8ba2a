"""Stored fronts over HTTP: given again, by angle, and to their caller alone."""

import httpx
import numpy as np
import pytest

from service.api.app import Edge
from service.api.auth import Access
from service.api.keys import KeyHash, new_key
from service.api.transport.connections import ConnectionLimits
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.serving import app_of, problem, serving

CITIES = np.random.default_rng(5).random((12, 4)).tolist()
FRONT = {"coordinates": CITIES, "time_limit": 0}


def test_a_front_can_be_asked_for_again(client: httpx.Client) -> None:
    answer = client.post("/front", json=FRONT).json()
    again = client.get(f"/front/{answer['id']}")
    assert (again.status_code, again.json()) == (200, answer)


def test_the_tour_at_an_angle_is_the_nearest_of_the_front(client: httpx.Client) -> None:
    front = client.post("/front", json={"coordinates": CITIES}).json()
    other = client.post("/front", json={"coordinates": CITIES[:4]}).json()
    nearest = min(front["front"], key=lambda item: abs(item["angle"] - 30))
    asked = client.get("/tour", params={"angle": 30, "front": front["id"]})
    assert asked.json() == {"front": front["id"], **nearest}
    for angle in (0, 90):
        end = client.get("/tour", params={"angle": angle, "front": front["id"]}).json()
        assert end == {"front": front["id"], **front["front"][-1 if angle == 0 else 0]}
    latest = client.get("/tour", params={"angle": 30})
    assert latest.json()["front"] == other["id"]


def test_a_tour_is_chosen_by_balance_by_budget_or_at_the_knee(client: httpx.Client) -> None:
    front = client.post("/front", json=FRONT).json()
    tours, id_ = front["front"], front["id"]

    def asked(query: str) -> httpx.Response:
        return client.get(f"/tour?{query}&front={id_}")

    firsts = [tour["lengths"][0] for tour in tours]
    middle = sorted(firsts)[len(firsts) // 2]
    within = [tour for tour in tours if tour["lengths"][0] <= middle]
    for query, tour in {
        "balance=0": tours[0],
        "balance=1": tours[-1],
        f"first_at_most={middle!r}": min(within, key=lambda tour: tour["lengths"][1]),
        f"second_at_most={tours[-1]['lengths'][1]!r}": tours[-1],
    }.items():
        assert asked(query).json() == {"front": id_, **tour}
    assert asked("knee").json() == asked("knee=true").json()
    refused = problem(asked(f"first_at_most={min(firsts) / 2}"), 404, "no-such-tour")
    assert (refused["limit"], refused["actual"]) == (min(firsts) / 2, min(firsts))


@pytest.mark.parametrize(
    ("query", "came"), [("", "none"), ("angle=1&knee", "angle and knee"), ("knee=no", "none")]
)
def test_a_tour_is_chosen_by_one_way_at_a_time(client: httpx.Client, query: str, came: str) -> None:
    document = problem(client.get(f"/tour?{query}"), 422, "invalid-request")
    assert document["detail"].endswith(f"must be given, got {came}")


@pytest.mark.parametrize(
    ("query", "parameter", "sentence"),
    [
        ("balance=1.5", "balance", 'balance must be at most 1, got "1.5"'),
        ("first_at_most=-1", "first_at_most", "first_at_most must be at least 0"),
        ("second_at_most=inf", "second_at_most", "second_at_most must be a finite number"),
        ("knee=2", "knee", "knee must be a valid boolean"),
        ("angle=-1", "angle", 'angle must be at least 0, got "-1"'),
        ("angle=90.1", "angle", 'angle must be at most 90, got "90.1"'),
        ("angle=nan", "angle", 'angle must be a finite number, got "nan"'),
        ("angle=steep", "angle", "angle must be a valid number, unable to parse"),
        ("angle=1&fronts=2", "fronts", "fronts is not a field that this request has"),
    ],
)
def test_a_wrong_query_is_named(
    client: httpx.Client, query: str, parameter: str, sentence: str
) -> None:
    document = problem(client.get(f"/tour?{query}"), 422, "invalid-request")
    assert document["errors"][0]["parameter"] == parameter
    assert document["detail"].startswith(sentence)


@pytest.mark.parametrize("path", ["/front/nowhere", "/tour?angle=30&front=nowhere"])
def test_an_unknown_front_is_404(client: httpx.Client, path: str) -> None:
    assert "'nowhere'" in problem(client.get(path), 404, "unknown-front")["detail"]


def test_a_tour_before_any_front_is_404() -> None:
    with serving(app_of(), warm=False) as url:
        problem(httpx.get(f"{url}/tour?angle=30"), 404, "no-front")


def test_a_front_that_has_made_way_is_410() -> None:
    with serving(app_of(store=SqliteStore(IN_MEMORY, entries=1, max_age=60))) as url:
        first, _ = (httpx.post(f"{url}/front", json=FRONT) for _ in range(2))
        key = first.json()["id"]
        problem(httpx.get(f"{url}/front/{key}"), 410, "front-expired")
        problem(httpx.get(f"{url}/tour?angle=3&front={key}"), 410, "front-expired")


def test_a_front_that_is_too_old_is_410() -> None:
    with serving(app_of(store=SqliteStore(IN_MEMORY, entries=1, max_age=1e-9))) as url:
        httpx.post(f"{url}/front", json=FRONT)
        problem(httpx.get(f"{url}/tour?angle=3"), 410, "front-expired")


def test_a_front_is_there_for_its_caller_alone() -> None:
    (dispatch, dispatch_hash), (lab, lab_hash) = new_key(), new_key()
    hashes = [
        KeyHash(caller="dispatch", digest=dispatch_hash),
        KeyHash(caller="lab", digest=lab_hash),
    ]
    own, other = ({"Authorization": f"Bearer {key}"} for key in (dispatch, lab))
    with serving(app_of(edge=Edge(access=Access(hashes)))) as url:
        planned = httpx.post(f"{url}/front", json=FRONT, headers=own).json()["id"]
        asked = [("GET", f"/front/{planned}"), ("GET", f"/front/{planned}/events")]
        asked += [("GET", f"/tour?angle=30&front={planned}"), ("DELETE", f"/front/{planned}")]
        for method, path in asked:
            answer = httpx.request(method, url + path, headers=other)
            problem(answer, 404, "unknown-front")
        problem(httpx.get(f"{url}/tour?angle=30", headers=other), 404, "no-front")
        for method, path in asked:
            answer = httpx.request(method, url + path, headers=own)
            assert answer.status_code in (200, 204)


def planned_by(url: str, **headers: str) -> str:
    answer = httpx.post(f"{url}/front", json=FRONT, headers=headers, timeout=300)
    planned: str = answer.json()["id"]
    return planned


def latest_of(url: str, **headers: str) -> httpx.Response:
    return httpx.get(f"{url}/tour?knee", headers=headers)


def test_the_latest_front_without_keys_is_that_of_the_address_alone() -> None:
    us, them, nobody = ({"X-Forwarded-For": f"192.0.2.{i}"} for i in range(3))
    with serving(app_of()) as url:  # the test's own address is that of a trusted proxy
        ours, theirs = planned_by(url, **us), planned_by(url, **them)
        assert latest_of(url, **us).json()["front"] == ours
        assert latest_of(url, **them).json()["front"] == theirs
        problem(latest_of(url, **nobody), 404, "no-front")
        problem(latest_of(url), 404, "no-front")
        for headers, own in ((us, [ours]), (them, [theirs]), (nobody, [])):
            listed = httpx.get(f"{url}/front", headers=headers).json()["fronts"]
            assert [each["id"] for each in listed] == own


@pytest.mark.parametrize("header", ["X-Forwarded-For", "Forwarded", "x-forwarded-for"])
def test_behind_a_proxy_that_is_not_trusted_nobody_has_a_latest_front(header: str) -> None:
    us, them = {header: "for=192.0.2.1"}, {header: "for=192.0.2.2"}
    with serving(app_of(), connections=ConnectionLimits(proxies="192.0.2.9")) as url:
        ours = planned_by(url, **us)
        for path in ("/tour?knee", "/front"):
            for headers in (us, them):
                problem(httpx.get(url + path, headers=headers), 422, "hidden-client")
        assert httpx.get(f"{url}/tour?knee&front={ours}", headers=them).status_code == 200
        # Without a proxy an address is that of its client.
        assert latest_of(url).json()["front"] == ours


def test_with_keys_the_latest_front_is_that_of_the_key_behind_any_proxy() -> None:
    (key, digest), (other, other_digest) = new_key(), new_key()
    hashes = [KeyHash(caller="us", digest=digest), KeyHash(caller="them", digest=other_digest)]
    us, them = (
        {"Authorization": f"Bearer {each}", "X-Forwarded-For": "192.0.2.1"} for each in (key, other)
    )
    limits = ConnectionLimits(proxies="192.0.2.9")
    with serving(app_of(edge=Edge(access=Access(hashes))), connections=limits) as url:
        ours = planned_by(url, **us)
        assert latest_of(url, **us).json()["front"] == ours
        problem(latest_of(url, **them), 404, "no-front")
        assert httpx.get(f"{url}/front", headers=them).json()["fronts"] == []
