"""The hour of a backend developer: requests over HTTP, a job, a repeat, an error, a replan."""

import json
import shutil
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.first_hours.steps import command, says, write_files
from tests.guide.sessions import REACHED, printed_by
from tests.helpers.serving import problem

pytestmark = pytest.mark.skipif(not shutil.which("curl"), reason="curl is not installed")


def ask(line: str, folder: Path, service: str) -> str:
    """Run a command of a page against a service, and return what it printed."""
    return printed_by(line.replace(REACHED, service.removeprefix("http://")), folder)


def followed(folder: Path, service: str) -> Any:
    """Submit a job, follow its events to the end, and return its front."""
    printed = ask(command("follow-a-long-job", "respond-async"), folder, service)
    head, _, job = printed.rpartition("\n")
    assert " 202 " in head
    [location] = [
        line.split()[1] for line in head.splitlines() if line.lower().startswith("location:")
    ]
    assert location == f"/front/{json.loads(job)['id']}"
    says("follow-a-long-job", "`GET /front/{id}/events` is a stream of server-sent events (SSE)")
    events = ask(f"curl {service}{location}/events", folder, service)
    *_, last = [line for line in events.splitlines() if line.startswith("data: ")]
    assert json.loads(last.removeprefix("data: "))["status"] == "done"
    return httpx.get(f"{service}{location}").json()


def check_repeats(request: dict[str, Any], service: str) -> None:
    """Check that a request is planned once under its key, and no other is taken for it."""
    says("follow-a-long-job", "such an answer has the header `Idempotent-Replayed: true`.")
    key = {"Idempotency-Key": "the-orders-of-monday"}
    first, again = (
        httpx.post(f"{service}/front", json=request, headers=key, timeout=300) for _ in range(2)
    )
    assert first.json() == again.json()
    assert again.headers["Idempotent-Replayed"] == "true"
    says("follow-a-long-job", "With another body it is answered 422.")
    other = httpx.post(f"{service}/front", json={**request, "size": 2}, headers=key, timeout=300)
    assert other.status_code == 422


def check_error(request: dict[str, Any], service: str) -> None:
    """Check that an error names the field at fault, and leads to its row in the guide."""
    says("errors", "`errors` points at each field at fault, as a JSON pointer")
    short = {**request, "coordinates": [*request["coordinates"], [5.2, 2.0]]}
    refused = httpx.post(f"{service}/front", json=short)
    document = problem(refused, 422, refused.json()["code"])
    assert document["errors"][0]["pointer"].startswith("/coordinates")
    page, _, anchor = document["type"].partition("#")
    assert f'id="{anchor}"' in httpx.get(f"{service}{page}").text


def test_a_front_is_planned_followed_repeated_and_replanned(released: str, tmp_path: Path) -> None:
    write_files("README", tmp_path, "cities.json")
    request = json.loads((tmp_path / "cities.json").read_text())
    front = json.loads(ask(command("README", "/front"), tmp_path, released))
    tour = json.loads(ask(command("README", "/tour"), tmp_path, released))["tour"]
    assert tour in [each["tour"] for each in front["front"]]
    assert followed(tmp_path, released)["front"] == front["front"]
    check_repeats(request, released)
    check_error(request, released)

    says("replan", "Over HTTP this is a `POST` to `/front/{id}/replan`")
    way = {"tour": tour, "done": tour[:2], "remove": [tour[3]]}
    rest = httpx.post(f"{released}/front/{front['id']}/replan", json=way, timeout=300).json()
    assert (rest["status"], rest["id"] != front["id"]) == ("done", True)
    assert 0 <= rest["front"][0]["kept"] <= 1
    says("replan", "The earlier front does not change.")
    kept = httpx.get(f"{released}/front/{front['id']}").json()
    assert kept["front"] == front["front"]
