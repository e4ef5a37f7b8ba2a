"""`python -m export`: an actor of one's own, and no released one lost."""

import re
from io import StringIO
from pathlib import Path

import onnx
import pytest
import torch

import export.__main__ as command
from export.check import Comparison
from models.checkpoint import new_run, save_weights
from models.config import NetworkConfig, TrainingConfig
from service.actor import load_actors

SMALL = NetworkConfig(name="pa-one", width=8, heads=2, layers=1, feedforward=8)


class Terminal(StringIO):
    """A terminal at which somebody types."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The weights of a run that was never trained, in a folder of its own, which is current."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "to_onnx", lambda _: onnx.load(command.RELEASED / "pa-one.onnx"))
    monkeypatch.setattr(command, "compare", lambda *_, **__: Comparison(tours=3))
    monkeypatch.setattr(command, "_hypervolumes", lambda *_: {"40": 0.5})
    monkeypatch.setattr(command, "_commit", lambda: "none")
    path = tmp_path / "weights.pt"
    save_weights(new_run(TrainingConfig(network=SMALL), torch.device("cpu")), path)
    return path


def test_each_step_is_printed_as_it_begins(
    weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command.main([str(weights), "--name", "my-one"])
    lines = capsys.readouterr().out.splitlines()
    size = Path("runs/actors/my-one.onnx").stat().st_size
    steps = [
        f"reading {weights}",
        "tracing a pa-one network of 0 steps",
        "comparing the graph's tours with PyTorch's",
        "all 3 tours are the same; measuring the hypervolume on validation instances",
        f"writing runs/actors/my-one.onnx, {size / 1000:.0f} kB, and my-one.md",
        'done: hypervolume {"40": 0.5} by number of cities',
    ]
    assert [re.sub(r"^ +\d+\.\d s  ", "", line) for line in lines] == steps


def test_an_actor_of_ones_own_is_served_beside_those_released(weights: Path) -> None:
    command.main([str(weights), "--name", "my-one"])
    loaded = load_actors(command.RELEASED, 1, Path("runs/actors"))
    assert {"my-one", "pa-one", "pa-one-matrix"} <= loaded.keys()
    assert loaded["my-one"].info.digest != loaded["pa-one"].info.digest
    card = Path("runs/actors/my-one.md").read_text()
    assert '`"actor": "my-one"`' in card
    assert "| 40 | 50.00 |" in card


REFUSED = [
    ([], "pa-one is a released actor"),
    (["--name", "pa-at"], "pa-at is a released actor"),
    (["--name", "../x"], "--name must be 1 to 64 letters"),
    (["--name", "my-one"], "runs/actors/my-one.onnx exists"),
    (["--name", "other", "--out", "runs/actors/my-one.onnx"], "runs/actors/my-one.onnx exists"),
]


@pytest.mark.parametrize(("options", "sentence"), REFUSED)
def test_nothing_is_written_over(
    weights: Path, options: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    written = Path("runs/actors/my-one.onnx")
    written.parent.mkdir(parents=True)
    written.write_bytes(b"mine")
    with pytest.raises(SystemExit) as ended:
        command.main([str(weights), *options])
    assert ended.value.code == 2
    assert sentence in capsys.readouterr().err
    assert [path.read_bytes() for path in written.parent.iterdir()] == [b"mine"]


def test_a_file_is_replaced_where_that_is_asked_for(weights: Path) -> None:
    for _ in range(2):
        command.main([str(weights), "--out", "here/one.onnx", "--replace"])
    assert list(load_actors(Path("here"), 1)) == ["pa-one"]


def test_somebody_at_a_terminal_is_asked_first(
    weights: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Terminal("\ny\n"))
    with pytest.raises(SystemExit, match="nothing was written"):
        command.main([str(weights), "--name", "my-one"])
    assert not Path("runs").exists()
    command.main([str(weights), "--name", "my-one"])
    assert Path("runs/actors/my-one.onnx").exists()


def test_the_version_is_unknown_outside_a_repository(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    assert command._commit() == "version unknown"
    monkeypatch.setenv("PATH", str(tmp_path))
    assert command._commit() == "version unknown"
