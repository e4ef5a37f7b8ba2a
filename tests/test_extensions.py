"""Constructors and searches of other packages: only what is named is used, and it is checked."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import httpx
import numpy as np
import pytest

from service.actor import load_actors
from service.actor_info import RELEASED
from service.errors import Refusal
from service.extensions.constructors import (
    ExternalConstructor,
    constructor_infos,
    load_constructors,
)
from service.extensions.entry_points import CONSTRUCTORS, SEARCHES
from service.extensions.searches import load_search
from service.front import PlanOptions
from service.instance import Instance
from service.planner import plan
from service.preferences import fan, from_angles
from tests.guide.pages import GUIDE, blocks
from tests.guide.sessions import run_page
from tests.helpers.command import paretour
from tests.helpers.serving import serving_settings

PAGE = GUIDE / "use-your-own-constructor-or-search.md"
FILES = {block.title: block.text for block in blocks(PAGE) if block.title}
SQUARE = Instance(coordinates=np.random.default_rng(0).random((6, 4)))
ROUTE = Instance(coordinates=SQUARE.coordinates, closed=False, start=2, end=4)
REQUEST = json.loads(FILES["my-request.json"])


def install(folder: Path, module: str, code: str, points: dict[str, dict[str, str]]) -> None:
    """Write a module and the record of its installation, as pip would."""
    (folder / f"{module}.py").write_text(code)
    record = folder / f"{module}-1.0.dist-info"
    record.mkdir()
    (record / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    lines = [
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in named.items())
        for group, named in points.items()
    ]
    (record / "entry_points.txt").write_text("\n".join(lines))


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of installed packages, without any."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        if name.startswith("own_"):
            del sys.modules[name]


def own(packages: Path, module: str, returned: str) -> None:
    """Install a package whose constructor and search return an expression."""
    code = (
        "import numpy as np\n"
        f"def build(instance, preferences): return {returned}\n"
        f"def search(instance, tours, seconds, stop): return {returned}\n"
    )
    points = {CONSTRUCTORS: {module: f"{module}:build"}, SEARCHES: {module: f"{module}:search"}}
    install(packages, module, code, points)


@contextmanager
def guide_package(packages: Path) -> Iterator[dict[str, str]]:
    """The package of the guide, and the settings that name what it registers."""
    project = tomllib.loads(FILES["pyproject.toml"])["project"]
    install(packages, "my_tours", FILES["my_tours.py"], project["entry-points"])
    yield {"PARETOUR_CONSTRUCTORS": "my-nearest", "PARETOUR_SEARCH": "my-search"}
    sys.modules.pop("my_tours", None)


@pytest.mark.skipif(not shutil.which("curl"), reason="curl is not installed")
def test_the_package_of_the_guide_plans_in_a_service(
    packages: Path, quick_actors: dict[str, str]
) -> None:
    with (
        guide_package(packages) as named,
        serving_settings({"PARETOUR_WORKERS": "1", **quick_actors, **named}) as url,
    ):
        [answer] = run_page(PAGE, packages, url)
        front = json.loads(answer)
        assert front["actor"]["name"] == "my-nearest"
        alone = httpx.post(f"{url}/front", json={**REQUEST, "time_limit": 0}, timeout=300).json()
        assert front["hypervolume"] >= alone["hypervolume"] > 0
        [listed] = [
            each
            for each in httpx.get(f"{url}/actors").json()["actors"]
            if each["name"] == "my-nearest"
        ]
    assert listed["commit"] == "my_tours 1.0"


def test_the_package_of_the_guide_plans_routes_matrices_and_several_objectives(
    packages: Path,
) -> None:
    rng = np.random.default_rng(1)
    instances = [
        SQUARE,
        ROUTE,
        Instance(matrices=rng.random((2, 9, 9))),
        Instance(coordinates=rng.random((9, 6))),
        Instance(coordinates=rng.random((2, 4))),
        Instance(coordinates=rng.random((1, 4))),
    ]
    with guide_package(packages):
        constructor, search = ExternalConstructor("my-nearest"), load_search("my-search")
        assert search is not None
        for instance in instances:
            directions = np.full((3, instance.objectives), instance.objectives**-0.5)
            options = PlanOptions(directions=directions, size=10)
            built = plan(constructor, instance, options)
            timed = PlanOptions(directions=directions, size=10, time_limit=0.1)
            found = plan(constructor, instance, timed, search=search)
            assert found.hypervolume >= built.hypervolume


def test_the_command_plans_with_what_is_named(packages: Path) -> None:
    (packages / "cities.json").write_text(json.dumps({**REQUEST, "time_limit": 0}))
    with guide_package(packages) as named:
        answer = paretour("front", packages / "cities.json", "--json", **named)
        unnamed = paretour("front", packages / "cities.json", "--json")
    assert json.loads(answer.stdout)["actor"]["name"] == "my-nearest"
    assert "actor must be one of" in unnamed.stderr


def test_a_package_that_is_not_named_is_not_imported(packages: Path) -> None:
    points = {
        CONSTRUCTORS: {"own-loud": "own_loud:build"},
        SEARCHES: {"own-loud": "own_loud:search"},
    }
    code = "raise SystemExit('imported')"
    install(packages, "own_loud", code, points)
    assert constructor_infos(["own-loud"])["own-loud"].commit == "own_loud 1.0"
    assert load_search(None) is None
    assert load_constructors(()) == {}
    assert "own_loud" not in sys.modules


RETURNED = [
    ("np.zeros((len(preferences), instance.n), int)", "must visit each of 6 cities once"),
    ("np.tile(np.arange(instance.n) + 1, (len(preferences), 1))", "must visit each of 6 cities"),
    ("np.tile(np.arange(instance.n) - 1, (len(preferences), 1))", "must visit each of 6 cities"),
    ("np.tile(np.arange(instance.n) * 1.0, (len(preferences), 1))", "of whole numbers, got float"),
    ("np.full((len(preferences), instance.n), np.nan)", "of whole numbers, got float64"),
    ("[[0, 1], [0]]", "got rows of different lengths"),
    ("np.arange(instance.n)", "of shape (3, 6), got (6,)"),
    ("np.tile(np.arange(5), (len(preferences), 1))", "of shape (3, 6), got (3, 5)"),
    ("np.tile(np.arange(instance.n), (2, 1))", "of shape (3, 6), got (2, 6)"),
    ("None", "of whole numbers, got object"),
    ("'tours'", "of whole numbers, got <U5"),
    ("1 / 0", "must return tours, and raised ZeroDivisionError"),
]


@pytest.mark.parametrize(("returned", "fault"), RETURNED)
def test_what_is_not_a_tour_for_each_preference_is_refused(
    packages: Path, returned: str, fault: str
) -> None:
    own(packages, "own_constructor", returned)
    with pytest.raises(Refusal) as refused:
        ExternalConstructor("own_constructor").tours(SQUARE, from_angles(fan(3)))
    assert refused.value.code == "extension-failed"
    assert "constructor own_constructor of own_constructor 1.0, which the op" in str(refused.value)
    assert fault in str(refused.value)


SEARCHED = [
    (SQUARE, "np.zeros((1, instance.n), int)", "must visit each of 6 cities once"),
    (SQUARE, "np.arange(instance.n)[:5][None]", "of shape (t, 6), got (1, 5)"),
    (SQUARE, "np.tile(np.arange(instance.n), (50_001, 1))", "at most 50000 tours, got 50001"),
    (SQUARE, "seconds", "of whole numbers, got float64"),
    (ROUTE, "np.array([[0, 1, 2, 3, 5, 4]])", "must start each route at city 2"),
    (ROUTE, "np.array([[2, 1, 0, 4, 5, 3]])", "must end each route at city 4"),
]


@pytest.mark.parametrize(("instance", "returned", "fault"), SEARCHED)
def test_what_a_search_returns_is_checked(
    packages: Path, instance: Instance, returned: str, fault: str
) -> None:
    own(packages, "own_search", returned)
    search = load_search("own_search")
    assert search is not None
    options = PlanOptions(directions=np.empty((0, 2)), size=5, time_limit=0.1)
    none = partial(plan, load_actors(RELEASED, 1)["pa-one"], instance, options)
    with pytest.raises(Refusal) as refused:
        none(search=search)
    assert refused.value.code == "extension-failed"
    assert fault in str(refused.value)


def test_the_service_says_whose_fault_it_is(packages: Path, quick_actors: dict[str, str]) -> None:
    own(packages, "own_fault", "None")
    settings = {"PARETOUR_WORKERS": "1", "PARETOUR_CONSTRUCTORS": "own_fault", **quick_actors}
    with serving_settings(settings) as url:
        request = {**REQUEST, "actor": "own_fault", "time_limit": 0}
        refused = httpx.post(f"{url}/front", json=request, timeout=300)
        again = httpx.post(f"{url}/front", json={**request, "actor": "pa-one"}, timeout=300)
    assert refused.status_code == 500
    assert refused.json()["code"] == "extension-failed"
    assert again.status_code == 200


UNLOADABLE = [
    ({}, "", "PARETOUR_CONSTRUCTORS must name entry points of the group paretour.constructors"),
    ({"own_x": "own_x:build"}, "import no_such", "must be importable: ModuleNotFoundError"),
    ({"own_x": "own_x:build"}, "", "must be importable: AttributeError"),
    ({"own_x": "own_x:build"}, "build = 3", "must be a function, got 3"),
]


@pytest.mark.parametrize(("points", "code", "sentence"), UNLOADABLE)
def test_what_cannot_be_loaded_is_refused_with_the_cause(
    packages: Path, points: dict[str, str], code: str, sentence: str
) -> None:
    install(packages, "own_x", code, {CONSTRUCTORS: points})
    with pytest.raises(ValueError, match=re.escape(sentence)):
        load_constructors(["own_x"], {})


def test_a_service_does_not_start_with_what_cannot_be_loaded(packages: Path) -> None:
    points, code, sentence = UNLOADABLE[-1]
    install(packages, "own_x", code, {CONSTRUCTORS: points})
    environment = {**os.environ, "PARETOUR_CONSTRUCTORS": "own_x"}
    command = [sys.executable, "-m", "service", "serve", "--port", "0"]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert ended.returncode == 2
    assert sentence in ended.stderr


def test_a_constructor_does_not_take_the_name_of_a_network(packages: Path) -> None:
    install(packages, "own_x", "", {CONSTRUCTORS: {"pa-one": "own_x:build"}})
    with pytest.raises(ValueError, match="must not have the name of a network, got pa-one"):
        load_constructors(["pa-one"], load_actors(RELEASED, 1))
