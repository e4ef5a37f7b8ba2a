"""What the README says is what the service does."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.settings import Settings
from tests.helpers.serving import app_of

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def test_the_request_gets_the_answer(released: str) -> None:
    blocks = re.findall(r"```json\n(.*?)```", README, re.DOTALL)
    request, answer = (json.loads(block) for block in blocks)
    found = httpx.post(f"{released}/front", json=request, timeout=60).json()
    assert lasting(found) == lasting(answer)


def test_the_python_code_runs(capsys: pytest.CaptureFixture[str], released: str) -> None:
    [code] = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(code.replace("http://localhost:8000", released), {})
    hypervolume, *_ = capsys.readouterr().out.split()
    assert 0 < float(hypervolume) < 1


def test_the_commands_run(tmp_path: Path) -> None:
    request = re.findall(r"```json\n(.*?)```", README, re.DOTALL)[0]
    (tmp_path / "cities.json").write_text(request)
    (tmp_path / "service").symlink_to(ROOT / "service")
    commands = re.findall(r"^    paretour (.*)$", README, re.MULTILINE)
    assert len(commands) >= 4
    for command in commands:
        line = f"{sys.executable} -m service {command}"
        subprocess.run(line, shell=True, cwd=tmp_path, check=True)
    assert (tmp_path / "front.csv").read_text().startswith("angle,")
    assert (tmp_path / "front.png").exists()


def lasting(answer: dict[str, Any]) -> dict[str, Any]:
    """What is the same whenever and wherever the request is made: a tour in either direction."""
    front = [
        {
            "angle": round(item["angle"], 6),
            "lengths": [round(length, 6) for length in item["lengths"]],
            "tour": min(item["tour"], item["tour"][:1] + item["tour"][:0:-1]),
        }
        for item in answer["front"]
    ]
    changed = {"front": front, "hypervolume": round(answer["hypervolume"], 6)}
    kept = {name: value for name, value in answer.items() if name not in ("id", "timings_ms")}
    return kept | changed


def test_every_setting_is_described() -> None:
    for name, field in Settings.model_fields.items():
        variable = field.validation_alias or f"PARETOUR_{name.upper()}"
        assert f"| `{variable}` |" in README
        assert field.description is not None
        assert field.description in README


def test_every_status_that_the_service_may_answer_with_is_described() -> None:
    paths = app_of().openapi()["paths"]
    promised = {
        status
        for operations in paths.values()
        for operation in operations.values()
        for status in operation["responses"]
    }
    table = README.partition("| status | when |")[2].partition("\n\n")[0]
    described = set(re.findall(r"\b[45]\d\d\b", table))
    assert {status for status in promised if status >= "400"} <= described
