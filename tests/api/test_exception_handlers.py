"""Errors of the framework become problem documents, as refusals of the service do."""

from collections.abc import Iterator

import httpx
import pytest

from tests.helpers.serving import app_of, problem, serving


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with serving(app_of(), warm=False) as address, httpx.Client(base_url=address) as client:
        yield client


def test_a_path_that_is_not_there_is_404(client: httpx.Client) -> None:
    assert "/fronts" in problem(client.get("/fronts"), 404, "no-such-path")["detail"]


def test_a_long_path_is_shown_shortened(client: httpx.Client) -> None:
    document = problem(client.get("/" + 1000 * "x"), 404, "no-such-path")
    assert len(document["detail"]) < 200


@pytest.mark.parametrize(
    ("path", "method", "allowed"),
    [("/front", "PUT", "GET, POST"), ("/front/x", "POST", "DELETE, GET")],
)
def test_a_method_that_a_path_lacks_is_405_and_names_all_others(
    client: httpx.Client, path: str, method: str, allowed: str
) -> None:
    answer = client.request(method, path)
    document = problem(answer, 405, "method-not-allowed")
    assert f"with {allowed}, got {method}" in document["detail"]
    assert answer.headers["allow"] == allowed
