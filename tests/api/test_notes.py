"""Notes on a request come with its answer, to everybody who asks for that."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from paretour import Client, front_plan

from tests.helpers.command import paretour
from tests.helpers.serving import app_of, serving

PLACES = [[24.94, 60.17], [24.96, 60.18], [24.9, 60.2], [24.97, 60.16], [25.01, 60.19], [0, 0]]
STOPS = [{"id": f"s{number}", "location": place} for number, place in enumerate(PLACES)]
WAY = {"name": "way", "from": "great_circle"}
FRONT: Any = {
    "stops": STOPS,
    "objectives": [WAY, {"name": "risk", "coordinates": [[n, n * n] for n in range(6)]}],
    "time_limit": 0.1,
}
FLEET = {
    "stops": STOPS,
    "objectives": [WAY, {**WAY, "name": "longest", "over": "max"}],
    "vehicles": [{"id": "van", "count": 2, "start": 0}],
    "time_limit": 0.1,
}
TEXT = "Stop 's5' lies at longitude 0 and latitude 0: was the address not found?"
NOTES = [{"code": "place", "text": TEXT, "pointer": "/stops/5/location"}]


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.mark.parametrize(("path", "request_"), [("/front", FRONT), ("/fleet", FLEET)])
def test_an_answer_has_notes_from_the_first_on(url: str, path: str, request_: Any) -> None:
    with httpx.Client(base_url=url, timeout=300) as client:
        answer = client.post(path, json=request_).json()
        assert answer["notes"] == NOTES
        assert client.get(f"/front/{answer['id']}").json()["notes"] == NOTES
        located = client.post(path, json=request_, headers={"Prefer": "respond-async"}).headers
        seen = []
        while not seen or seen[-1]["status"] in ("queued", "running"):
            seen.append(client.get(located["location"]).json())
            time.sleep(0.01)
        assert all(each["notes"] == NOTES for each in seen)
        stops = request_["stops"][:5]
        ordinary = {**request_, "stops": stops, "objectives": [WAY, {**WAY, "name": "other"}]}
        assert "notes" not in client.post(path, json=ordinary).json()


def test_a_rest_of_the_way_has_notes_that_point_nowhere(url: str) -> None:
    with httpx.Client(base_url=url, timeout=300) as client:
        front = client.post("/front", json=FRONT).json()["id"]
        rest = client.post(f"/front/{front}/replan", json={"done": ["s0"], "time_limit": 0.1})
        assert rest.json()["notes"] == [{"code": "place", "text": TEXT}]


def test_the_client_reads_notes(url: str) -> None:
    with Client(url) as client:
        [note] = client.plan_any(front_plan(FRONT)).notes
        assert (note.code, note.text, note.pointer) == ("place", TEXT, "/stops/5/location")


def test_the_command_says_a_note_once(url: str, tmp_path: Path) -> None:
    rows = "".join(f"{s['id']},{s['location'][1]},{s['location'][0]},1\n" for s in STOPS)
    (tmp_path / "stops.csv").write_text(f"id,lat,lon,demand\n{rows}", encoding="utf-8")
    (tmp_path / "request.json").write_text(json.dumps(FRONT), encoding="utf-8")
    for command, name in (("fleet", "stops.csv"), ("front", "request.json")):
        ended = paretour(command, tmp_path / name, "--url", url, "--time-limit", 0.1)
        assert ended.returncode == 0, ended.stderr
        assert ended.stderr.count(TEXT) == 1
