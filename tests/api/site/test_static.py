"""The page, the HTTP reference and their files, against a live server."""

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.helpers.serving import app_of, problem, serving


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with serving(app_of(), warm=False) as address, httpx.Client(base_url=address) as client:
        yield client


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/", "text/html"),
        ("/docs", "text/html"),
        ("/page/main.js", "text/javascript"),
        ("/docs/docs.css", "text/css"),
        ("/examples/index.json", "application/json"),
    ],
)
def test_files_are_served_and_asked_for_anew_each_time(
    client: httpx.Client, path: str, kind: str
) -> None:
    answer = client.get(path)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith(kind)
    assert answer.headers["cache-control"] == "no-cache"
    unchanged = client.get(path, headers={"If-None-Match": answer.headers["etag"]})
    assert unchanged.status_code in (200, 304)


def test_files_of_the_page_are_kept_by_browsers_until_one_of_them_changes(
    client: httpx.Client,
) -> None:
    [script] = re.findall(r'src="(page/[^"]+/main.js)"', client.get("/").text)
    answer = client.get(f"/{script}")
    assert answer.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert answer.text == client.get("/page/main.js").text
    imported = client.get(f"/{Path(script).parent}/inputs/stops.js")
    assert imported.headers["cache-control"] == "public, max-age=31536000, immutable"


def test_a_file_of_a_version_that_another_replica_has_is_not_kept(client: httpx.Client) -> None:
    answer = client.get("/page/version-0123456789abcdef/main.js")
    assert answer.text == client.get("/page/main.js").text
    assert answer.headers["cache-control"] == "no-cache"


@pytest.mark.parametrize(
    "path",
    [
        "/page/none.js",
        "/page/version-0123456789abcdef/none.js",
        "/page/../settings.py",
        "/examples/none.json",
    ],
)
def test_a_path_without_a_file_is_404(client: httpx.Client, path: str) -> None:
    problem(client.get(path), 404, "no-such-path")


@pytest.mark.parametrize(
    ("asked", "status", "code"),
    [
        ("bytes=99999999-", 416, "unsatisfiable-range"),
        ("bytes=9-2", 400, "refused"),
        ("lines=1-2", 400, "refused"),
        ("nonsense", 400, "refused"),
    ],
)
def test_a_range_that_a_file_does_not_have_is_a_problem(
    client: httpx.Client, asked: str, status: int, code: str
) -> None:
    answer = client.get("/page/icon.svg", headers={"Range": asked})
    problem(answer, status, code)
    assert ("content-range" in answer.headers) == (status == 416)
