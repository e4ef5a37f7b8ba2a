"""The recipe of the guide makes an actor that is served: its commands, with far fewer steps."""

import json
import shlex
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

import export.__main__ as exporting
from export.check import compare
from models import expert, train
from tests.benchmarks import __main__ as benchmarks
from tests.benchmarks import provenance
from tests.guide.pages import GUIDE, commands
from tests.guide.sessions import run_page
from tests.helpers.serving import serving_settings
from tests.helpers.type_checks import unchecked_types

PAGE = GUIDE / "train-your-own-actor.md"
FEWER = {
    "--shards": "1",
    "--instances": "2",
    "--steps": "3",
    "--threads": "1",
    "--cities": "40",
}
COMMANDS: dict[str, Callable[[list[str]], None]] = {
    "models.expert": expert.main,
    "models.train": partial(train.main, counts={20: 1}),
    "export": exporting.main,
}


def fewer(words: list[str]) -> list[str]:
    """Return a command's arguments with small numbers, each option with one value."""
    arguments: list[str] = []
    skipping = False
    for word in words:
        skipping = skipping and not word.startswith("--")
        if skipping:
            continue
        arguments.append(word)
        if word in FEWER:
            arguments.append(FEWER[word])
            skipping = True
    return arguments


@pytest.fixture
def quick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is current, and an export that compares few tours."""
    monkeypatch.chdir(tmp_path)
    few = partial(compare, sizes=(3, 20), counts=(5,), repairs=(0, 1))
    monkeypatch.setattr(exporting, "compare", few)
    monkeypatch.setattr(exporting, "COUNTS", {20: 1})
    monkeypatch.setattr(exporting, "_commit", lambda: "none")
    monkeypatch.setattr(provenance, "ANEW", tmp_path / "runs/benchmarks")
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    monkeypatch.setattr(provenance, "RUN", provenance.Run())
    return tmp_path


@pytest.mark.skipif(not shutil.which("curl"), reason="curl is not installed")
def test_the_recipe_trains_exports_and_serves_an_actor(
    quick: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [shlex.split(each.replace("\\\n", " ")) for each in commands(PAGE)]
    modules = [each[2:] for each in words if each[1:2] == ["-m"]]
    # The commands after the benchmark are other ways to train.
    measured = [module for module, *_ in modules].index("tests.benchmarks")
    with unchecked_types():  # tests/models and tests/export check the same code with them
        for module, *arguments in modules[:measured]:
            COMMANDS[module](fewer(arguments))
    assert "tours are the same" in capsys.readouterr().out
    settings = {"PARETOUR_WORKERS": "1", "PARETOUR_OWN_ACTORS": "runs/actors"}
    with serving_settings(settings) as url:
        [answer] = run_page(PAGE, quick, url)
    assert json.loads(answer)["actor"]["name"] == "my-one"
    _, *arguments = modules[measured]
    monkeypatch.setattr("sys.argv", ["benchmarks", *fewer(arguments), "--count", "1"])
    monkeypatch.setattr("tests.benchmarks.actors.ACTORS", exporting.RELEASED)
    benchmarks.main()
    printed = capsys.readouterr().out
    assert "| my-one | " in printed
    assert "| pa-one | " in printed
