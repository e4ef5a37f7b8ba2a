"""The image installs versions that are named: every distribution that it has, none other."""

import re
import tomllib
from collections.abc import Iterator
from importlib.metadata import requires, version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parents[2]
LINES = (ROOT / "service/deploy/constraints.txt").read_text().splitlines()
ENTRIES = [line for line in LINES if not line.startswith("#")]
PINNED = dict(entry.split("==") for entry in ENTRIES)


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
ASKED = [
    Requirement(text)
    for texts in (
        PROJECT["dependencies"],
        *(PROJECT["optional-dependencies"][extra] for extra in ("cluster", "mcp", "tracing")),
    )
    for text in texts
]


def requirements_of(name: str, extras: frozenset[str]) -> Iterator[Requirement]:
    for text in requires(name) or ():
        marker = (requirement := Requirement(text)).marker
        if marker is None or any(marker.evaluate({"extra": each}) for each in extras or {""}):
            yield requirement


def installed() -> set[str]:
    """Return the distributions that `.[cluster,mcp,tracing]` installs, by their canonical names."""
    found: set[tuple[str, frozenset[str]]] = set()
    outstanding = list(ASKED)
    while outstanding:
        requirement = outstanding.pop()
        each = str(canonicalize_name(requirement.name)), frozenset(requirement.extras)
        if each not in found:
            found.add(each)
            outstanding += requirements_of(*each)
    return {name for name, _ in found}


def test_every_distribution_of_the_image_is_named_and_no_other() -> None:
    assert {"celery", "numpy", "opentelemetry-api", "uvicorn"} <= installed()
    assert set(PINNED) == installed()


def test_entries_are_names_and_versions_alone_in_order() -> None:
    assert all(re.fullmatch(r"[a-z0-9-]+==[0-9][0-9a-z.]*", entry) for entry in ENTRIES)
    assert sorted(ENTRIES) == ENTRIES
    assert len(PINNED) == len(ENTRIES)


def test_the_versions_are_those_that_the_project_asks_for() -> None:
    for requirement in ASKED:
        pinned = PINNED[canonicalize_name(requirement.name)]
        assert requirement.specifier.contains(pinned, prereleases=True), requirement


def test_no_version_is_later_than_what_the_tests_run_with() -> None:
    assert [name for name in PINNED if Version(PINNED[name]) > Version(version(name))] == []
