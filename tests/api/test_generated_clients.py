"""Clients that generators make of the OpenAPI document: they have real types, and they work.

Each generator is installed for the tests, apart from this project: openapi-python-client allows no
typer as new as the one here, and openapi-typescript is a package of Node.
"""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

import httpx
import pytest

from tests.guide.pages import GUIDE, ROOT, blocks, commands
from tests.helpers.node import NODE
from tests.helpers.sampled import at_night
from tests.helpers.serving import app_of, serving

PYTHON_GENERATOR = ("openapi-python-client>=0.29,<0.30", "mypy>=2", "ruff>=0.15")
# Errors in the generated code itself are not ours.
CHECK_PYTHON = ("venv/bin/mypy", "--strict", "--follow-imports=silent")
FROM_TYPESCRIPT = GUIDE / "call-it-from-typescript.md"
TYPESCRIPT_GENERATOR = ("openapi-typescript@7", "typescript@5")
# Without it, a member that has a default is one that must be given.
FLAG = "--default-non-nullable=false"
IN_PYTHON = """
import sys
from generated import Client
from generated.api.fronts import get_tour, plan_front
from generated.models import DayObjectiveItem, FrontAnswer, FrontRequest, StopItem, TourAnswer
from generated.models import DayObjectiveItemFrom

places = {"depot": [24.94, 60.17], "order-17": [24.95, 60.16], "order-18": [24.93, 60.18]}
stops = [StopItem(id=name, location=place) for name, place in places.items()]
way = DayObjectiveItem(name="way", from_=DayObjectiveItemFrom.GREAT_CIRCLE)
risk = DayObjectiveItem(name="risk", unit="%", matrix=[[0, 1, 2], [1, 0, 3], [2, 3, 0]])
request = FrontRequest(stops=stops, objectives=[way, risk], start="order-18")
client = Client(base_url=sys.argv[1])
front = plan_front.sync(client=client, body=request)
assert isinstance(front, FrontAnswer), front
assert isinstance(front.front[0].stops, list)
stop: str = front.front[0].stops[0]
length: float = front.front[0].lengths[0]
tour = get_tour.sync(client=client, angle=45, front=front.id)
assert isinstance(tour, TourAnswer), tour
print(stop, length > 0)
"""
WRONG_IN_PYTHON = """
from generated.models import StopItem

StopItem(id=17)
"""
IN_TYPESCRIPT = """
import type { components, operations } from "./generated";

type Body = operations["plan_front"]["requestBody"]["content"]["application/json"];
type Front = components["schemas"]["FrontAnswer"];
export const request: Body = {
  stops: [{ id: "depot", location: [24.94, 60.17] }, { id: "order-17", location: [24.95, 60.16] }],
  objectives: [
    { name: "way", from: "great_circle" },
    { name: "risk", unit: "%", matrix: [[0, 1], [1, 0]] },
  ],
  start: "order-17",
};
export const first = (front: Front): string => (front.front[0].stops ?? [])[0];
"""
WRONG_IN_TYPESCRIPT = """
import type { components } from "./generated";

export const stop: components["schemas"]["StopItem"] = { id: 17 };
"""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="module")
def document(address: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The OpenAPI document as the service gives it, in a file."""
    path = tmp_path_factory.mktemp("document") / "openapi.json"
    path.write_bytes(httpx.get(f"{address}/openapi.json").content)
    return path


@pytest.fixture(scope="module")
def python_folder(document: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the client in Python, and the virtual environment that generated it."""
    folder = tmp_path_factory.mktemp("python")
    run([sys.executable, "-m", "venv", "--without-pip", "venv"], folder)
    pip = [sys.executable, "-m", "pip", "--python", f"{folder}/venv/bin/python"]
    install([*pip, "install", "-q", "--no-compile", *PYTHON_GENERATOR], folder)
    command = ["venv/bin/openapi-python-client", "generate", "--fail-on-warning", "--meta=none"]
    run([*command, f"--path={document}", "--output-path=generated"], folder, venv_path(folder))
    return folder


@pytest.fixture(scope="module")
def typescript_folder(document: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the types in TypeScript, and the packages that generated them."""
    if shutil.which("npm") is None:
        pytest.skip("npm is not installed")
    folder = tmp_path_factory.mktemp("typescript")
    install(["npm", "install", "--no-audit", "--no-fund", *TYPESCRIPT_GENERATOR], folder)
    run(["node_modules/.bin/openapi-typescript", str(document), "-o", "generated.ts", FLAG], folder)
    return folder


@at_night
def test_a_generated_client_in_python_plans_from_stops(python_folder: Path, address: str) -> None:
    (python_folder / "use.py").write_text(IN_PYTHON)
    assert run(["venv/bin/python", "use.py", address], python_folder) == "order-18 True\n"


@at_night
def test_its_types_are_real_ones(python_folder: Path) -> None:
    (python_folder / "use.py").write_text(IN_PYTHON)
    (python_folder / "wrong.py").write_text(WRONG_IN_PYTHON)
    with pytest.raises(subprocess.CalledProcessError) as failed:
        run([*CHECK_PYTHON, "use.py", "wrong.py"], python_folder)
    [fault] = [line for line in failed.value.stdout.splitlines() if "error:" in line]
    assert fault.startswith("wrong.py")
    assert 'Argument "id" to "StopItem" has incompatible type "int"' in fault


@at_night
def test_generated_types_in_typescript_are_those_of_stops(typescript_folder: Path) -> None:
    (typescript_folder / "use.ts").write_text(IN_TYPESCRIPT)
    (typescript_folder / "wrong.ts").write_text(WRONG_IN_TYPESCRIPT)
    with pytest.raises(subprocess.CalledProcessError) as failed:
        run(
            ["node_modules/.bin/tsc", "--noEmit", "--strict", "use.ts", "wrong.ts"],
            typescript_folder,
        )
    [fault] = [line for line in failed.value.stdout.splitlines() if "error " in line]
    assert fault.startswith("wrong.ts")
    assert "Type 'number' is not assignable to type 'string'" in fault


@at_night
def test_the_program_of_the_guide_has_the_types_of_the_service(typescript_folder: Path) -> None:
    make_types = commands(FROM_TYPESCRIPT)[:2]
    assert set(make_types[0].split()[3:]) == set(TYPESCRIPT_GENERATOR)
    assert make_types[1].endswith(f" -o paretour.ts {FLAG}")
    *_, compiling = (each for each in commands(FROM_TYPESCRIPT) if each.startswith("npx tsc "))
    options = compiling.partition(" && ")[0].split()[2:]
    [program] = [each.text for each in blocks(FROM_TYPESCRIPT) if each.title == "plan.ts"]
    (typescript_folder / "plan.ts").write_text(program)
    (typescript_folder / "paretour.ts").write_text('export type * from "./generated.js";\n')
    run(["npm", "pkg", "set", "type=module"], typescript_folder)
    compiled = typescript_folder / "plan.js"
    # The Node of the machine, that of playwright's wheel, which is newer, and 22 if there is one.
    for node in filter(None, ("node", str(NODE), shutil.which("node22"))):
        compiled.unlink(missing_ok=True)
        run([node, "node_modules/typescript/bin/tsc", *options], typescript_folder)
        assert "import" not in compiled.read_text()  # the types alone are imported
        run([node, "--check", "plan.js"], typescript_folder)


def test_generated_packages_do_not_take_the_name_of_the_client(document: Path) -> None:
    """openapi-python-client names a package after the title of the document."""
    name = json.loads(document.read_text())["info"]["title"].lower().replace(" ", "-") + "-client"
    client = tomllib.loads((ROOT / "service/client/pyproject.toml").read_text())["project"]
    assert name not in (client["name"], "paretour")


def test_every_operation_and_every_form_has_a_name_of_its_own(document: Path) -> None:
    content = json.loads(document.read_text())
    ids = [each["operationId"] for path in content["paths"].values() for each in path.values()]
    assert sorted(ids) == [
        "ask_about_front",
        "check_live",
        "check_live_head",
        "check_ready",
        "check_ready_head",
        "follow_front",
        "forget_front",
        "get_front",
        "get_metrics",
        "get_tour",
        "list_actors",
        "list_fronts",
        "offer_slots",
        "plan_coverage",
        "plan_fleet",
        "plan_front",
        "read_files",
        "replan_front",
    ]
    for path, form in (("/front", "FrontForm"), ("/coverage", "CoverageForm")):
        body = content["paths"][path]["post"]["requestBody"]["content"]["multipart/form-data"]
        assert body["schema"] == {"$ref": f"#/components/schemas/{form}"}
        assert "request" in content["components"]["schemas"][form]["properties"]


def install(command: list[str], folder: Path) -> None:
    """Run a command that installs packages; skip where they cannot be had."""
    try:
        run(command, folder)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        pytest.skip(f"{command[-1]} cannot be installed: {error}")


def run(command: list[str], folder: Path, environment: Mapping[str, str] | None = None) -> str:
    """Run a command in a folder, without this project's modules, and return what it prints."""
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(
        command,
        cwd=folder,
        env={**inherited, **(environment or {})},
        check=True,
        capture_output=True,
        text=True,
        timeout=300,
    ).stdout


def venv_path(folder: Path) -> dict[str, str]:
    """The variable by which the generator finds ruff, with which it formats."""
    return {"PATH": f"{folder}/venv/bin{os.pathsep}{os.environ['PATH']}"}
