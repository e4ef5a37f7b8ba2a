"""The examples can be posted as they are, and are what their script makes."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from service.settings import Settings
from tests.helpers.serving import app_of, serving

EXAMPLES = Path(__file__).parent.parent / "service/examples"
INDEX: list[dict[str, Any]] = json.loads((EXAMPLES / "index.json").read_text())


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of(limits=Settings().limits)) as address:
        yield address


def test_the_index_names_every_example() -> None:
    files = {path.name for path in EXAMPLES.glob("*.json")}
    assert {"index.json"} | {example["file"] for example in INDEX} == files


@pytest.mark.parametrize("example", INDEX, ids=lambda example: example["file"])
def test_an_example_is_answered_with_a_choice_of_tours(url: str, example: dict[str, Any]) -> None:
    body = (EXAMPLES / example["file"]).read_bytes()
    headers = {"Content-Type": "application/json"}
    answer = httpx.post(url + example["path"], content=body, headers=headers, timeout=60)
    assert answer.status_code == 200, answer.text
    lengths = np.array([item["lengths"] for item in answer.json()["front"]])
    # Both objectives can be lowered by more than a tenth: there is something to choose.
    assert len(lengths) >= 10
    assert (lengths.max(axis=0) > 1.1 * lengths.min(axis=0)).all()


def test_the_script_makes_the_examples(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-m", "service.examples", str(tmp_path)], check=True)
    for example in INDEX:
        made = json.loads((tmp_path / example["file"]).read_text())
        kept = json.loads((EXAMPLES / example["file"]).read_text())
        assert made.keys() == kept.keys()
        for name, value in made.items():
            # Another processor may round the last digit otherwise.
            np.testing.assert_allclose(value, kept[name], atol=0.11)
