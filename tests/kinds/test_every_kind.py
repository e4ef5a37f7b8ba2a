"""Every kind of plan with every option: it works, or it is refused for the reason in a table."""

import json
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any, Literal
from uuid import uuid4

import httpx
import pytest
from click.testing import Result
from rich.console import Console
from typer.testing import CliRunner

from service.cli import backends, progress
from service.cli.commands import app as command_line
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.kinds.table import KINDS as SERVICE
from service.requests.coverage import CoverageRequest
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from tests.helpers.sampled import IS_WHOLE
from tests.helpers.serving import LIMITS, app_of, events_of, problem, serving
from tests.kinds.requests import CITIES, Asked, as_input, requests, rest_of

Ask = Callable[[httpx.Client, Asked], httpx.Response]
LIMIT = 0.7  # seconds of search, in which it reports its progress
LONG = 60.0  # seconds of search: no test waits until they are over
LATER = {"Prefer": "respond-async"}
KINDS = (
    *("cities", "stops", "coverage", "robots", "fleet", "three", "day", "detours"),
    *("day on a map", "day of robots"),
    *("replanned stops", "replanned coverage", "replanned fleet"),
)
# The service alone has the earlier front.
HERE_NOT = ("replanned stops", "replanned coverage", "replanned fleet")
ON_MAP = {"coverage", "robots", "detours", "day on a map", "day of robots", "replanned coverage"}
OF_PLANS = {"robots", "day of robots", "fleet", "replanned fleet"}
# The command plans these as others of their kinds do: over HTTP they are searched, too.
ALIKE = ("three", "day", "detours", "day on a map", "day of robots", "replanned fleet")
UNLIKE = [kind for kind in KINDS if kind not in ALIKE]
# What requests are about. All other members are options, and have a row in the table.
SUBJECT = {
    *("coordinates", "matrices", "stops", "objectives", "closed", "start", "end"),
    *("departure", "clock", "vehicles", "shipments", "robot_speed", "over_the_day"),
    *("grid", "occupancy_grid", "cell_size", "origin", "mode", "negate", "occupied_thresh"),
    *("free_thresh", "obstacle_from", "unknown", "robot_radius", "places", "spacing"),
    *("start_pose", "end_pose", "second_matrix", "cost_layer", "cost_layers"),
    *("second_coordinates", "robots", "over"),
    *("done", "position", "add", "remove", "costs", "now", "tour", "pose", "blocked", "freed"),
    *("plan", "routes"),
    *("together", "apart", "before", "slack", "leave", "promised", "changes"),
}
NO_STOPS, NO_EARTH = "cities in planes lie nowhere", "a robot's map is not on the earth"
PLANS = "a plan has a tour for each vehicle: GET /front/{id} has them all"
SINGLE = "the option is about single tours, or the network that builds them"
EARLIER = "the search starts from the tours of the earlier front"
# What does not work: the option and the kind, the status and the code of the refusal, and why.
REFUSED: Mapping[tuple[str, str], tuple[int, str, str]] = {
    **{("geojson", kind): (406, "no-locations", NO_STOPS) for kind in ("cities", "three")},
    **{("geojson", kind): (406, "no-locations", NO_EARTH) for kind in ON_MAP},
    **{("tour", kind): (404, "no-tours", PLANS) for kind in OF_PLANS},
    **{
        ("replan", kind): (409, "not-replannable", "only tours and fleets are replanned")
        for kind in ("robots", "day of robots")
    },
    **{
        (option, kind): (422, "invalid-request", why)
        for option, kinds, why in (
            ("preferences", OF_PLANS, SINGLE),
            (
                "bound",
                {*OF_PLANS, "day", "day on a map", "detours"},
                f"{SINGLE}; a bound is of fixed, shortest legs",
            ),
            ("repairs", OF_PLANS, SINGLE),
            ("arrivals", OF_PLANS, SINGLE),
            ("actor", OF_PLANS, SINGLE),
            ("initial_tours", {*OF_PLANS, *HERE_NOT}, f"{SINGLE}; {EARLIER}"),
            ("augment", {*KINDS} - {"cities", "stops", "three", "day"}, "only POST /front has it"),
            ("geometry", ON_MAP, NO_EARTH),
            ("detours", {*KINDS} - {"detours"}, "they are between the costs of a layer and metres"),
            ("paths", {*KINDS} - ON_MAP, "a path is over a map"),
            ("min_kept", {*KINDS} - {"replanned stops", "replanned coverage"}, "no tour is driven"),
        )
        for kind in kinds
    },
}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    store = SqliteStore(IN_MEMORY, entries=1000, max_age=3600)
    with serving(
        app_of(store=store, limits=replace(LIMITS, cities=CITIES, seconds=LONG))
    ) as address:
        yield address


@pytest.fixture(scope="module")
def client(url: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=url, timeout=300) as client:
        yield client


@pytest.fixture(scope="module")
def asked(client: httpx.Client) -> dict[str, Asked]:
    """The request of each kind; those to replan are of fronts that the service has."""
    found = dict(requests())
    for kind in ("stops", "coverage", "fleet"):
        front = post(client, found[kind]).raise_for_status().json()
        found[f"replanned {kind}"] = rest_of(kind, front)
    assert tuple(found) == KINDS
    return found


def post(
    client: httpx.Client, asked: Asked, headers: Mapping[str, str] | None = None, **options: Any
) -> httpx.Response:
    """Ask for a front, by default for what the network finds."""
    body = {"time_limit": 0, **asked.body, **options}
    return client.post(asked.path, json=body, headers=headers)


def wait(client: httpx.Client, asked: Asked) -> httpx.Response:
    answer = post(client, asked).raise_for_status()
    document = answer.json()
    assert (document["status"], document["kind"]) == ("done", asked.kind)
    assert document["front"]
    return answer


def respond_async(client: httpx.Client, asked: Asked) -> httpx.Response:
    accepted = post(client, asked, LATER)
    assert accepted.status_code == 202
    assert accepted.headers["Preference-Applied"] == "respond-async"
    last = dict(events_of(client, accepted.json()["id"]))
    assert last["status"]["status"] == "done"
    answer = client.get(accepted.headers["Location"])
    assert answer.json()["kind"] == asked.kind
    assert answer.json()["front"]
    return accepted


def kind_while_queued(client: httpx.Client, asked: Asked) -> httpx.Response:
    """The kind is known, and stays, from the first moment on."""
    front = post(client, asked, LATER).json()["id"]
    answer = client.get(f"/front/{front}")
    assert answer.json()["kind"] == asked.kind
    client.delete(f"/front/{front}")
    return answer


def events(client: httpx.Client, asked: Asked) -> httpx.Response:
    accepted = post(client, asked, LATER, time_limit=LONG)
    front = accepted.json()["id"]
    told = events_of(client, front)
    progress = next(data for name, data in told if name == "progress" and data["points"])
    assert progress["hypervolume"] > 0
    client.delete(f"/front/{front}")
    assert list(told)[-1] == ("status", {"id": front, "status": "cancelled"})
    return accepted


def repeated_key(client: httpx.Client, asked: Asked) -> httpx.Response:
    key = {"Idempotency-Key": uuid4().hex}
    first, again = (post(client, asked, key) for _ in range(2))
    assert first.json() == again.json()
    assert first.json()["front"]
    problem(post(client, asked, key, seed=1), 422, "idempotency-mismatch")
    return again


def geojson(client: httpx.Client, asked: Asked) -> httpx.Response:
    answer = post(client, asked, {"Accept": "application/geo+json"})
    if answer.is_success:
        shapes = [each["geometry"]["type"] for each in answer.json()["features"]]
        assert {"LineString", "Point"} <= set(shapes)
    return answer


def default_reference_point(client: httpx.Client, asked: Asked) -> httpx.Response:
    answer = post(client, asked)
    assert answer.json()["hypervolume"] > 0
    assert all(number > 0 for number in answer.json()["reference_point"])
    return answer


def own_reference_point(client: httpx.Client, asked: Asked) -> httpx.Response:
    point = [1e6, 1e7, 1e8][: asked.objectives]
    answer = post(client, asked, reference_point=point)
    assert answer.json()["reference_point"] == point
    assert answer.json()["hypervolume"] > 0
    return answer


def time_limit(client: httpx.Client, asked: Asked) -> httpx.Response:
    answer = post(client, asked, time_limit=0.2)
    assert answer.json()["terminated"] == "time_limit"
    return answer


def size(client: httpx.Client, asked: Asked) -> httpx.Response:
    answer = post(client, asked, size=1)
    assert len(answer.json()["front"]) == 1
    return answer


def cancel(client: httpx.Client, asked: Asked) -> httpx.Response:
    front = post(client, asked, LATER, time_limit=LONG).json()["id"]
    next(data for name, data in events_of(client, front) if data.get("points"))
    ended = client.delete(f"/front/{front}")
    document = client.get(f"/front/{front}").json()
    assert (document["status"], document["terminated"]) == ("cancelled", "cancelled")
    assert document["front"]
    assert ended.json() == document
    return ended


def tour(client: httpx.Client, asked: Asked) -> httpx.Response:
    front = post(client, asked).json()
    answer = client.get("/tour", params={"front": front["id"], "knee": True})
    if answer.is_success:
        assert answer.json() in [{"front": front["id"], **each} for each in front["front"]]
    return answer


def replan(client: httpx.Client, asked: Asked) -> httpx.Response:
    front = post(client, asked).json()
    first = front["front"][0]
    done = first.get("stops", first.get("tour", [0]))[:1]
    changes: dict[str, Any] = {"done": done}
    if "departure" in asked.body:
        changes["now"] = asked.body["departure"]
    if asked.kind == "fleet":
        changes = {"plan": 0, "routes": [{"route": 0, "done": first["routes"][0]["stops"][1:2]}]}
    answer = client.post(f"/front/{front['id']}/replan", json={**changes, "time_limit": 0})
    if answer.is_success:
        assert all("kept" in each for each in answer.json()["front"])
    return answer


def member(name: str, value: object, client: httpx.Client, asked: Asked) -> httpx.Response:
    """Ask with one more member of the request."""
    return post(client, asked, **{name: value})


HTTP: Mapping[str, Ask] = {
    "wait": wait,
    "respond-async": respond_async,
    "kind while it is planned": kind_while_queued,
    "events": events,
    "repeated key": repeated_key,
    "geojson": geojson,
    "default reference point": default_reference_point,
    "reference_point": own_reference_point,
    "time_limit": time_limit,
    "size": size,
    "cancel": cancel,
    "tour": tour,
    "replan": replan,
    "preferences": partial(member, "preferences", 3),
    "bound": partial(member, "bound", True),
    "repairs": partial(member, "repairs", 0),
    "arrivals": partial(member, "arrivals", True),
    "initial_tours": partial(member, "initial_tours", [list(range(CITIES))]),
    "seed": partial(member, "seed", 7),
    "actor": partial(member, "actor", "pa-one-matrix"),
    "augment": partial(member, "augment", 8),
    "geometry": partial(member, "geometry", "straight"),
    "detours": partial(member, "detours", True),
    "paths": partial(member, "paths", True),
    "min_kept": partial(member, "min_kept", 0.5),
}


def test_the_tables_have_every_option_and_every_kind() -> None:
    forms = (FrontRequest, CoverageRequest, FleetRequest, ReplanRequest, ReplanFleetRequest)
    members = {name for form in forms for name in form.model_fields}
    assert members - SUBJECT <= HTTP.keys()
    assert members >= SUBJECT
    assert {asked.kind for _, asked in requests()} == SERVICE.keys()
    assert all(option in HTTP and kind in KINDS for option, kind in REFUSED)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("option", HTTP)
def test_over_http(option: str, kind: str, client: httpx.Client, asked: dict[str, Asked]) -> None:
    answer = HTTP[option](client, asked[kind])
    if (option, kind) in REFUSED:
        status, code, _ = REFUSED[option, kind]
        problem(answer, status, code)
    else:
        assert answer.is_success, answer.text


def planned(asked: Asked, url: str | None, *formats: str, limit: float = 0) -> Result:
    """Have the command plan what is on its standard input."""
    where = [] if url is None else ["--url", url]
    arguments = [*asked.command, "-", "--time-limit", str(limit), *formats, *where]
    return CliRunner().invoke(command_line, arguments, input=as_input(asked))


def here_or_by_url(kinds: Sequence[str], first: Literal["here", "url"]) -> pytest.MarkDecorator:
    """Plan kinds in this process and by a service: by day in turn, and by night each by both.

    Tests that begin with another place have another one for each kind.
    """
    cases = [
        (kind, place)
        for kind in kinds
        for place in ("here", "url")
        if IS_WHOLE or (KINDS.index(kind) % 2 == 0) == (place == first)
    ]
    return pytest.mark.parametrize(("kind", "place"), cases, indirect=["place"])


@pytest.fixture
def place(
    request: pytest.FixtureRequest,
    url: str,
    quick_actors: Mapping[str, str],
    monkeypatch: pytest.MonkeyPatch,
) -> str | None:
    """The service that shall plan; None where this process shall."""
    # The quick networks are of two objectives.
    if request.node.callspec.params["kind"] != "three":
        for name, value in quick_actors.items():
            monkeypatch.setenv(name, value)
    return url if request.param == "url" else None


def refused_here(kind: str, place: str | None, result: Result) -> bool:
    """Return whether this process cannot plan a kind, after a check that the command says so."""
    if place is not None or kind not in HERE_NOT:
        return False
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--url" in result.stderr
    return True


@here_or_by_url(UNLIKE, first="here")
def test_the_command_prints_json(kind: str, place: str | None, asked: dict[str, Asked]) -> None:
    result = planned(asked[kind], place, "--json", limit=LIMIT)
    if refused_here(kind, place, result):
        return
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert (answer["kind"], answer["status"]) == (asked[kind].kind, "done")
    assert answer["terminated"] == "time_limit"
    assert answer["hypervolume"] > 0
    assert "found, hypervolume" in result.stderr
    assert "stopped at the time limit" in " ".join(result.stderr.split())


@here_or_by_url(KINDS, first="url")
def test_the_command_prints_csv(kind: str, place: str | None, asked: dict[str, Asked]) -> None:
    result = planned(asked[kind], place, "--csv")
    if refused_here(kind, place, result):
        return
    assert result.exit_code == 0, result.stderr
    head, *rows = result.stdout.splitlines()
    assert head.split(",")[-1] == asked[kind].column
    assert rows
    if asked[kind].column == "tour":
        visited = CITIES - 1 if kind.startswith("replanned") else CITIES
        assert all(len(row.split(",")[-1].split()) >= visited for row in rows)


@here_or_by_url([kind for kind in KINDS if kind not in HERE_NOT], first="here")
def test_the_command_chooses_a_tour_or_names_the_command_that_plans(
    kind: str, place: str | None, asked: dict[str, Asked]
) -> None:
    command = asked[kind].command[0]
    tour = replace(asked[kind], command=("tour",))
    result = planned(tour, place, "--knee")
    if kind not in OF_PLANS:
        assert result.exit_code == 0, result.stderr
        assert len(result.stdout.split()) == CITIES
    else:
        assert (result.exit_code, result.stdout) == (2, "")
        assert result.stderr.strip().endswith(f"`paretour {command}` plans that")


@here_or_by_url(UNLIKE, first="url")
def test_the_command_prints_tables_and_draws(
    kind: str, place: str | None, asked: dict[str, Asked], tmp_path: Any
) -> None:
    result = planned(asked[kind], place, "--table", "--plot", str(tmp_path / "front.svg"))
    if refused_here(kind, place, result):
        return
    assert result.exit_code == 0, result.stderr
    assert "balance" in result.stdout
    assert "<svg" in (tmp_path / "front.svg").read_text()


@here_or_by_url(UNLIKE, first="here")
def test_ctrl_c_gives_the_best_so_far(
    kind: str, place: str | None, asked: dict[str, Asked], monkeypatch: pytest.MonkeyPatch
) -> None:
    @contextmanager
    def pressed(_: Console, __: float) -> Iterator[Callable[[object], None]]:
        presses = iter([signal.SIGINT])  # a second one would leave without a front

        def press(found: Any) -> None:
            if found.points and (signalled := next(presses, None)):
                signal.raise_signal(signalled)

        yield press

    for module in (backends, progress):  # by a service, and in this process
        monkeypatch.setattr(module, "progress_bar", pressed)
    result = planned(asked[kind], place, "--json", limit=LONG)
    if refused_here(kind, place, result):
        return
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert (answer["status"], answer["terminated"]) == ("cancelled", "cancelled")
    assert answer["front"]
    assert "stopped before its time" in " ".join(result.stderr.split())
