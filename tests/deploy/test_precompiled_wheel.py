"""A wheel that is built on request carries compiled code, which its processes load from there."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from zipfile import ZipFile

import numba
import pytest

from tests.helpers.processors import ANOTHER_NAME, WITHOUT_AVX2, of_the_level

ROOT = Path(__file__).parents[2]
BUILD = """
import sys
from hatchling.builders.wheel import WheelBuilder
print(*WheelBuilder(sys.argv[1]).build(directory=sys.argv[2], versions=["standard"]))
"""
# To compile all of the service takes a minute: this stands in for what requests need.
COMPILED_CODE = """
import numpy as np
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints

def warm_up() -> None:
    best_subset(FrontPoints(np.array([[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]]), np.full(2, 4.0)), 2)
"""
LOAD = """
import json
from service.jobs.compiled_code import warm_up
from service.search import best_subset

warm_up()
kernels = [each for each in vars(best_subset).values() if hasattr(each, "stats")]
counts = [[sum(each.stats.cache_hits.values()) for each in kernels],
          [sum(each.stats.cache_misses.values()) for each in kernels]]
print(json.dumps(dict(zip(["loaded", "compiled"], map(sum, counts)))))
"""


def wheel_of(project: Path, folder: Path, precompile: str) -> Path:
    command = [sys.executable, "-c", BUILD, str(project), str(folder)]
    environment = {**os.environ, "PARETOUR_PRECOMPILE": precompile, "NUMBA_DISABLE_JIT": "0"}
    ran = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return Path(ran.stdout.strip())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of a copy of the project, in which little is to be compiled."""
    project = tmp_path_factory.mktemp("project")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, project)
    ignored = shutil.ignore_patterns("__pycache__", "precompiled")
    shutil.copytree(ROOT / "service", project / "service", ignore=ignored)
    (project / "service/jobs/compiled_code.py").write_text(COMPILED_CODE)
    return wheel_of(project, tmp_path_factory.mktemp("dist"), "1")


@pytest.fixture
def installed(wheel: Path, tmp_path: Path) -> Path:
    with ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "installed")
    return tmp_path / "installed"


def loaded(installed: Path, cache: Path, processor: str) -> dict[str, int]:
    """How many kernels a process on a processor loads from the wheel, and compiles."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(installed),
        "NUMBA_CACHE_DIR": str(cache),
        "NUMBA_DISABLE_JIT": "0",
    }
    command = [sys.executable, "-c", processor + LOAD]
    ran = subprocess.run(
        command, cwd=cache.parent, env=environment, stdout=subprocess.PIPE, check=True
    )
    return json.loads(ran.stdout)


@of_the_level
def test_a_processor_of_another_name_compiles_nothing(installed: Path, tmp_path: Path) -> None:
    found = loaded(installed, tmp_path / "cache", ANOTHER_NAME)
    assert found["loaded"] > 0
    assert found["compiled"] == 0
    assert not (tmp_path / "cache").exists()


def test_a_processor_that_lacks_a_feature_compiles_anew_beside(
    installed: Path, tmp_path: Path
) -> None:
    found = loaded(installed, tmp_path / "cache", WITHOUT_AVX2)
    assert found["loaded"] == 0
    assert found["compiled"] > 0
    assert list((tmp_path / "cache").rglob("*.nbc"))


def test_the_wheel_is_for_this_python_and_platform_and_demands_this_numba(wheel: Path) -> None:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    assert wheel.stem.endswith(f"-{python}-{python}-{platform}")
    with ZipFile(wheel) as archive:
        [metadata] = [name for name in archive.namelist() if name.endswith("/METADATA")]
        assert f"Requires-Dist: numba=={numba.__version__}\n" in archive.read(metadata).decode()


def test_the_wheel_carries_the_graphs_of_the_released_networks(wheel: Path) -> None:
    with ZipFile(wheel) as archive:
        graphs = [Path(name) for name in archive.namelist() if name.endswith(".ort")]
    assert all(graph.is_relative_to("service/precompiled") for graph in graphs)
    names = {path.stem for path in (ROOT / "service/actors").glob("*.onnx")}
    assert {graph.stem.rpartition("-")[0] for graph in graphs} == names


def test_without_the_request_the_wheel_is_for_all_and_carries_nothing(tmp_path: Path) -> None:
    wheel = wheel_of(ROOT, tmp_path, "0")
    assert wheel.stem.endswith("-py3-none-any")
    with ZipFile(wheel) as archive:
        assert not [name for name in archive.namelist() if name.endswith((".nbi", ".nbc", ".ort"))]
