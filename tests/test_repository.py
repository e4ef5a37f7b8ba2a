"""Rules of the repository that can be run."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
TOP_LEVEL = {"pyproject.toml", "Dockerfile", "README.md", "LICENSE"} | {
    "service",
    "models",
    "export",
    "tests",
}


def tracked() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return listed.stdout.splitlines()


def test_the_service_starts_without_the_factory() -> None:
    code = (
        "import sys, service.api.app, service.actor, service.__main__;"
        "sys.exit(len({'torch', 'onnx', 'models', 'export'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


def test_the_top_level_holds_what_the_design_names_and_nothing_else() -> None:
    visible = {path.split("/")[0] for path in tracked() if not path.startswith(".")}
    assert visible == TOP_LEVEL


def test_the_readme_and_continuous_integration_run_the_same_test_command() -> None:
    [command] = [
        line.strip()
        for line in (ROOT / "README.md").read_text().splitlines()
        if ".venv/bin/pytest" in line and "pip install" in line
    ]
    assert command.replace("pip install", "pip install -q") in (ROOT / ".ci/run").read_text()


def test_every_released_actor_has_a_model_card_and_a_checkpoint() -> None:
    for actor in (ROOT / "service/actors").glob("*.onnx"):
        assert (ROOT / f"models/checkpoints/{actor.stem}.md").exists()
        assert (ROOT / f"models/checkpoints/{actor.stem}.pt").exists()
