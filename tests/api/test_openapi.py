"""The HTTP reference: examples that are true, of every path and every refusal."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.api.openapi import example_refusal
from service.api.problem import Problem
from service.api.responses import PROBLEM_JSON
from service.errors import PROBLEMS
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.actors import Shuffler, info_of
from tests.helpers.sampled import IS_WHOLE, tenth
from tests.helpers.serving import LIMITS, app_of, serving

ROOT = Path(__file__).parents[2]

# Codes of no operation: the path, the method or the service is at fault.
OF_NO_OPERATION = {name for name, problem in PROBLEMS.items() if not problem.operations}


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with _served() as address:
        yield address


def _served() -> AbstractContextManager[str]:
    # Schemathesis asks for fronts of minutes ago, which must not have made way meanwhile.
    store = SqliteStore(IN_MEMORY, entries=10_000, max_age=3600)
    # Its requests ask for repairs, too, which the schema allows whatever the actor.
    repairing = (info_of("pa-one", "coordinates", True), info_of("pa-one-matrix", "matrices", True))
    return serving(app_of(*(Shuffler(info=info) for info in repairing), store=store))


@pytest.fixture(scope="module")
def document(address: str) -> dict[str, Any]:
    return httpx.get(f"{address}/openapi.json").json()


@pytest.fixture(scope="module")
def operations(document: dict[str, Any]) -> dict[str, Any]:
    """What the document says of each, as "POST /front"."""
    paths = document["paths"]
    return {f"{m.upper()} {path}": each for path, ms in paths.items() for m, each in ms.items()}


def test_every_operation_shows_its_answer_and_every_refusal(operations: dict[str, Any]) -> None:
    for name, operation in operations.items():
        for status, response in operation["responses"].items():
            for kind, content in response.get("content", {}).items():
                shown = content.get("examples") or content.get("example")
                assert shown, f"{name} has no example of {status} as {kind}"


def test_every_code_that_the_service_knows_is_shown(operations: dict[str, Any]) -> None:
    shown = {problem["code"] for problem in problems_of(operations)}
    assert shown == set(PROBLEMS) - OF_NO_OPERATION


def test_every_refusal_shown_is_a_problem_document(operations: dict[str, Any]) -> None:
    for problem in problems_of(operations):
        Problem.model_validate(problem)


def test_every_request_shown_is_answered_as_shown(address: str, operations: dict[str, Any]) -> None:
    fronts = {}
    for kind, path in (("front", "/front/{id}/replan"), ("fleet", "/front/{id}/offers")):
        [*_, last] = requests_of(operations[f"POST /{kind}"])
        fronts[path] = httpx.post(f"{address}/{kind}", json=last, timeout=300).json()["id"]
    for name, operation in operations.items():
        method, path = name.split()
        for example in requests_of(operation):
            url = address + path.replace("{id}", fronts.get(path, ""))
            answer = httpx.request(method, url, json=example, timeout=300)
            assert answer.status_code == 200, answer.text
            shown = operation["responses"]["200"]["content"]["application/json"]["example"]
            assert set(shown) <= set(answer.json())


def test_a_schema_has_the_limits_of_the_service(document: dict[str, Any]) -> None:
    fields = document["components"]["schemas"]["FrontRequest"]["properties"]
    assert fields["stops"]["maxItems"] == LIMITS.cities
    assert fields["size"]["maximum"] == LIMITS.size


def test_every_body_refers_to_schemas_with_names(
    document: dict[str, Any], operations: dict[str, Any]
) -> None:
    named = document["components"]["schemas"]
    bodies = {
        name: schemas_of(operation["requestBody"]["content"])
        for name, operation in operations.items()
        if "application/json" in operation.get("requestBody", {}).get("content", {})
    }
    assert bodies == {
        "POST /front": ["FrontRequest"],
        "POST /coverage": ["CoverageRequest"],
        "POST /front/{id}/replan": ["ReplanRequest", "ReplanFleetRequest"],
        "POST /front/{id}/offers": ["OffersRequest"],
        "POST /fleet": ["FleetRequest"],
    }
    assert all(name in named for names in bodies.values() for name in names)


def test_operations_have_ids_that_read_well(operations: dict[str, Any]) -> None:
    ids = {name: operation["operationId"] for name, operation in operations.items()}
    assert ids["POST /front"] == "plan_front"
    assert ids["POST /coverage"] == "plan_coverage"
    assert len(set(ids.values())) == len(ids)


@pytest.mark.parametrize("code", PROBLEMS)
def test_every_code_has_an_example_for_the_guide(code: str) -> None:
    refusal = example_refusal(code)
    assert (refusal.code, refusal.status) == (code, PROBLEMS[code].status)
    assert refusal.detail
    assert "{" not in refusal.detail


@pytest.fixture
def without_fronts() -> Iterator[str]:
    """A service of its own: the latest front of another test may need what no schema can say."""
    with _served() as address:
        yield address


def test_schemathesis_finds_nothing(without_fronts: str, tmp_path: Path) -> None:
    document = f"{without_fronts}/openapi.json"
    command = [sys.executable, "-m", "schemathesis.cli", "run", document]
    # Its phase "coverage", of 3,000 requests more, takes three minutes.
    phases = f"--phases=examples,fuzzing,stateful{',coverage' * IS_WHOLE}"
    most = f"--max-examples={tenth(20)}"
    options = ["--no-color", "--generation-deterministic", "--request-timeout=300", most, phases]
    options.append("--exclude-path=/files")  # which takes forms alone
    hooks = {"SCHEMATHESIS_HOOKS": "tests.helpers.schemathesis_hooks", "PYTHONPATH": str(ROOT)}
    found = subprocess.run(
        [*command, *options],
        cwd=tmp_path,
        env={**os.environ, **hooks},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout
    assert "17 selected / 18 total" in found.stdout


def schemas_of(content: dict[str, Any]) -> list[str]:
    """The names of the schemas that bodies of JSON are of."""
    schema = content["application/json"]["schema"]
    references = schema.get("oneOf", schema.get("anyOf", [schema]))
    return [each["$ref"].removeprefix("#/components/schemas/") for each in references]


def problems_of(operations: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        example["value"]
        for operation in operations.values()
        for response in operation["responses"].values()
        for example in response.get("content", {})
        .get(PROBLEM_JSON, {})
        .get("examples", {})
        .values()
    ]


def requests_of(operation: dict[str, Any]) -> list[Any]:
    content = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
    return [example["value"] for example in content.get("examples", {}).values()]
