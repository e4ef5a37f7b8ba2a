"""The hour of an operator: keys, limits, metrics, a backup, a restart, an upgrade, a restore."""

import subprocess
from pathlib import Path
from typing import Any

import httpx

from tests.first_hours.steps import page_of, says
from tests.guide.pages import blocks
from tests.helpers.command import paretour
from tests.helpers.processes import ServeProcess, serve_process
from tests.helpers.serving import problem, serving_settings

PRODUCTION = "run-it-in-production"
REQUEST = {
    "coordinates": [[0, 0, 5, 5], [3, 1, 9, 1], [5, 2, 2, 8], [4, 6, 7, 7]],
    "time_limit": 0,
    "repairs": 0,
}


def run_script(name: str, *arguments: object) -> None:
    """Run a script of the page on backups."""
    [text] = [block.text for block in blocks(page_of("back-it-up")) if block.title == name]
    command = ["sh", "-c", text, name, *map(str, arguments)]
    subprocess.run(command, check=True, timeout=60, capture_output=True)


def planned(service: ServeProcess, key: dict[str, str]) -> dict[str, Any]:
    answer = httpx.post(f"{service.url}/front", json=REQUEST, headers=key, timeout=300)
    front: dict[str, Any] = answer.raise_for_status().json()
    return front


def check_refusals(service: ServeProcess, key: dict[str, str]) -> None:
    """Check that strangers and too large requests are refused."""
    problem(httpx.post(f"{service.url}/front", json=REQUEST), 401, "unauthorized")
    cities = [[0, 0, 1, 1]] * 5
    over = httpx.post(f"{service.url}/front", json={"coordinates": cities}, headers=key)
    assert (over.status_code, over.json()["limit"], over.json()["actual"]) == (413, 4, 5)
    says("watch-it", "`/metrics` needs one")
    assert httpx.get(f"{service.url}/metrics").status_code == 401


def test_a_front_outlives_restart_upgrade_and_loss(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    says(PRODUCTION, "prints a key for the caller named `dispatch`, and its entry")
    secret, entry = paretour("key", "dispatch").stdout.split()
    says(PRODUCTION, "Requests send a key as `Authorization: Bearer KEY`.")
    key = {"Authorization": f"Bearer {secret}"}
    store, monday = tmp_path / "fronts.sqlite", tmp_path / "monday"
    settings = {
        "PARETOUR_API_KEYS": entry,
        "PARETOUR_STORE": str(store),
        "PARETOUR_WORKERS": "1",
        "PARETOUR_MAX_CITIES": "4",
        **quick_actors,
    }
    for name in settings:
        says(PRODUCTION, f"| `{name}` |")
    with serve_process(settings) as service:
        check_refusals(service, key)
        front = planned(service, key)
        metrics = httpx.get(f"{service.url}/metrics", headers=key).text
        assert "\nparetour_workers 1.0\n" in metrics
        run_script("back-up.sh", service.process.pid, store, monday)
        later = planned(service, key)
    says(PRODUCTION, "It ends with status 0 once the requests in progress are answered")
    assert service.process.returncode == 0

    with serving_settings(settings) as url:
        for each in (front, later):
            assert httpx.get(f"{url}/front/{each['id']}", headers=key).json() == each

    store.write_bytes(b"lost")
    run_script("restore.sh", monday, store)
    says("upgrade", "Try the new version on a copy of the store, at another port:")
    with serving_settings(settings) as url:
        says("back-it-up", "ask for a front that you know: `GET /front/{id}` answers as before.")
        assert httpx.get(f"{url}/front/{front['id']}", headers=key).json() == front
        since = httpx.get(f"{url}/front/{later['id']}", headers=key)
        assert since.status_code == 404
