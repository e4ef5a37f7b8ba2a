"""Sessions from graphs that are kept build the tours of the files."""

import os
from pathlib import Path

import numpy as np
import pytest

from service import jit
from service.actor import OnnxActor, Tours
from service.actor_info import RELEASED
from service.instance import Instance
from service.preferences import fan, from_angles
from tests.helpers.artifacts import by_coordinates

NAMES = [path.stem for path in sorted(RELEASED.glob("*.onnx"))]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(jit, "folder", lambda: tmp_path)
    return tmp_path


def tours(name: str) -> list[Tours]:
    """Return the tours of a network for a few instances, with repairs where it has them."""
    actor = OnnxActor(RELEASED / f"{name}.onnx", threads=1)
    random = np.random.default_rng(1)
    instances = [Instance(coordinates=random.random((n, 4))) for n in (3, 20, 70)]
    if actor.info.inputs == "matrices":
        instances = [Instance(matrices=each.scaled_matrices) for each in instances]
    repairs = 5 if actor.info.repairs else 0
    return [actor.tours(each, from_angles(fan(9)), repairs) for each in instances]


@pytest.mark.parametrize("name", NAMES)
def test_a_kept_graph_builds_the_tours_of_the_file(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = tours(name)
    assert [kept.name.rpartition("-")[0] for kept in folder.iterdir()] == [name]
    kept = tours(name)
    monkeypatch.setattr(jit, "folder", lambda: None)
    of_file = tours(name)
    for each in (first, kept):
        assert all(map(np.array_equal, each, of_file))


@pytest.mark.parametrize("left", [0, 10, 1000])
def test_a_graph_that_was_not_wholly_written_is_kept_anew(folder: Path, left: int) -> None:
    expected = tours("pa-ad")
    [kept] = folder.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[:left])
    assert all(map(np.array_equal, tours("pa-ad"), expected))
    assert len(kept.read_bytes()) == len(whole)


def test_a_network_opens_where_nothing_can_be_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr(jit, "folder", lambda: tmp_path / "file/folder")
    assert [each.shape for each in tours("pa-at")] == [(9, 3), (9, 20), (9, 70)]
    assert os.listdir(tmp_path) == ["file"]
    [line] = caplog.messages
    assert line.startswith("the optimised pa-at.onnx cannot be kept: ")


def test_networks_of_the_user_are_not_kept(folder: Path, tmp_path: Path) -> None:
    own = by_coordinates(tmp_path / "own.onnx", "own")
    OnnxActor(own, threads=1).load()
    assert list(folder.glob("*.ort")) == []
