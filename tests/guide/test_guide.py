"""The README and the guide: their blocks run, their links lead somewhere, their tables are true."""

import json
import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from export import __main__ as export
from models import drl_moa, expert, train
from service.errors import PROBLEMS
from service.fleet.measures.table import TRADED, Measure
from service.settings import Settings
from tests.guide.codes import codes, faults, remedies
from tests.guide.figures import figures
from tests.guide.members import JSON, json_file, type_files
from tests.guide.page_tables import page_tables
from tests.guide.pages import (
    GUIDE,
    PAGES,
    README,
    ROOT,
    anchors,
    blocks,
    commands,
    links,
    made_part,
)
from tests.guide.sessions import RUN, run_page, write_inputs
from tests.guide.tree import PAGE as TREE_PAGE
from tests.guide.tree import named, tree
from tests.helpers.documented import sentences_of
from tests.helpers.serving import app_of

# Commands that a test of their own runs or checks: deployment, the image, set-up and linters.
NOT_RUN = (
    "docker ",
    "PARETOUR_API_KEYS= docker ",
    "kubectl ",
    "python3 -m venv ",
    ".venv/bin/",
    "npm install ",
    "npm pkg ",
    "npx tsc ",
    "npx openapi-typescript ",
    "PARETOUR_OWN_ACTORS=",
    "PARETOUR_CONSTRUCTORS=",
)
# One process for all, because each would import torch.
COMMAND_LINE = GUIDE / "use-the-command-line.md"
FILES = GUIDE / "which-files-can-i-bring.md"
FROM_PYTHON = GUIDE / "call-it-from-python.md"
RUNNABLE = [
    page
    for page in PAGES
    if any(block.language == "python" for block in blocks(page))
    or any(command.startswith(RUN) for command in commands(page))
]
FROM_TYPESCRIPT = GUIDE / "call-it-from-typescript.md"
FROM_A_SHELL = GUIDE / "call-it-from-a-shell.md"
FIRST_TOUR = GUIDE / "first-tour-in-ten-minutes.md"
TRAINING = GUIDE / "train-your-own-actor.md"
EXTENSIONS = GUIDE / "use-your-own-constructor-or-search.md"
WITH_A_TEST = (
    COMMAND_LINE,
    FILES,
    FROM_PYTHON,
    FROM_TYPESCRIPT,
    FROM_A_SHELL,
    FIRST_TOUR,
    TRAINING,
    EXTENSIONS,
)
OTHERS = [page for page in RUNNABLE if page not in WITH_A_TEST]


needs_curl = pytest.mark.skipif(not shutil.which("curl"), reason="curl is not installed")


@pytest.mark.parametrize("page", OTHERS, ids=lambda page: page.stem)
def test_the_blocks_of_every_other_page_run_from_top_to_bottom(
    page: Path, released: str, tmp_path: Path
) -> None:
    if any(command.startswith("curl ") for command in commands(page)) and not shutil.which("curl"):
        pytest.skip("curl is not installed")
    write_inputs(tmp_path)
    run_page(page, tmp_path, released)


def test_the_python_code_prints_a_hypervolume(
    released: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_page(FROM_PYTHON, tmp_path, released)
    hypervolume, *_ = capsys.readouterr().out.split()
    assert 0 < float(hypervolume) < 1


def test_the_command_line_writes_a_table_and_a_picture(released: str, tmp_path: Path) -> None:
    write_inputs(tmp_path)
    printed = run_page(COMMAND_LINE, tmp_path, released)
    assert len(printed) >= 9
    assert any(line.startswith("depot order-") for line in printed)
    assert (tmp_path / "front.csv").read_text().startswith("angle,")
    assert (tmp_path / "front.png").exists()


@needs_curl
def test_files_become_what_their_page_says(released: str, tmp_path: Path) -> None:
    [plans, *_, answer] = run_page(FILES, tmp_path, released)
    assert "vehicles" in plans
    assert json.loads(answer)["kind"] == "fleet"


@needs_curl
def test_the_first_tour_is_written_as_its_page_says(
    released: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_inputs(tmp_path)
    ready, tour = run_page(FIRST_TOUR, tmp_path, released)
    assert f"`{ready}`" in FIRST_TOUR.read_text()
    [shown] = [each.text for each in blocks(FIRST_TOUR) if each.text.startswith("17 tours")]
    assert capsys.readouterr().out == shown
    heading, *rows = (line.split(",") for line in tour.splitlines())
    assert heading == ["id", "metres", "euros"]
    assert [rows[0], rows[-1]] == [["depot", "0", "0"], ["depot", "10990", "41"]]
    assert len({row[0] for row in rows}) == len(rows) - 1 == 8


def test_the_typescript_program_plans_follows_and_chooses(released: str, tmp_path: Path) -> None:
    write_inputs(tmp_path)
    [printed] = run_page(FROM_TYPESCRIPT, tmp_path, released)
    first, *_, status, tour = printed.splitlines()
    assert first.startswith("3 tours, from 4681.3")
    assert status == "done"
    assert f"`{status}`, and a tour: `{tour}`" in FROM_TYPESCRIPT.read_text()


@needs_curl
def test_the_shell_script_prints_events_and_then_a_tour(released: str, tmp_path: Path) -> None:
    write_inputs(tmp_path)
    *_, printed = run_page(FROM_A_SHELL, tmp_path, released)
    *events, tour = (line for line in printed.splitlines() if line)
    *_, status = (line for line in events if line.startswith("data: "))
    assert json.loads(status.removeprefix("data: "))["status"] == "done"
    assert json.loads(tour)["tour"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_block_is_of_a_kind_that_a_test_knows(page: Path) -> None:
    assert {block.language for block in blocks(page)} <= {
        "json",
        "python",
        "sh",
        "text",
        "typescript",
    }
    assert all(block.title for block in blocks(page) if block.language == "json")
    assert all(command.startswith((*RUN, *NOT_RUN)) for command in commands(page))
    assert page.read_text().count("\n```") == 2 * len(blocks(page))


def test_every_option_of_the_training_commands_is_one_of_the_command(
    capsys: pytest.CaptureFixture[str],
) -> None:
    options: dict[str, set[str]] = {}
    for command in commands(TRAINING):
        words = shlex.split(command.replace("\\\n", " "))
        if words[1] == "-m" and words[2] != "tests.benchmarks":
            options.setdefault(words[2], set()).update(
                word for word in words if word.startswith("--")
            )
    mains = {
        "models.expert": expert.main,
        "models.train": train.main,
        "models.drl_moa": drl_moa.main,
        "export": export.main,
    }
    assert set(mains) == set(options)
    for module, main in mains.items():
        with pytest.raises(SystemExit):
            main(["--help"])
        shown = capsys.readouterr().out
        assert [option for option in options[module] if option not in shown] == [], module


def test_every_benchmark_that_a_page_names_is_there() -> None:
    named_ones = {
        name
        for page in PAGES
        for name in re.findall(r"`python -m tests\.benchmarks ([a-z_]+)", page.read_text())
    }
    assert named_ones
    assert all((ROOT / f"tests/benchmarks/{name}.py").exists() for name in named_ones)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_link_leads_to_a_file_and_a_heading(page: Path) -> None:
    for target in links(page):
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_file_that_a_page_names_is_there(page: Path) -> None:
    paths = re.findall(r"`((?:service|models|export|tests)/[\w./-]+)`", page.read_text())
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_every_page_is_in_the_index_and_within_reach_of_the_readme() -> None:
    pages = {page.name for page in GUIDE.glob("*.md")} - {"index.md"}
    assert pages == set(links(GUIDE / "index.md")) - {"../../README.md"}
    assert pages | {"index.md"} == {
        Path(link.partition("#")[0]).name for link in links(README) if "guide/" in link
    }


def test_the_readme_is_short_and_its_figures_are_those_of_the_results() -> None:
    text = README.read_text()
    assert len(text.splitlines()) <= 150
    results = (ROOT / "tests/benchmarks/RESULTS.md").read_text()
    guide = (GUIDE / "how-good-is-it.md").read_text()
    table = text.partition("## How good it is")[2].partition("## More")[0]
    figures = re.findall(r"\b\d\d\.\d\d(?= \()", table)
    assert len(figures) == 28
    assert [figure for figure in figures if figure not in results + guide] == []


def test_the_tree_names_every_folder_with_modules() -> None:
    paths = subprocess.run(
        ["git", "ls-files", "service", "models", "export"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    folders = {str(Path(path).parent) for path in paths if path.endswith((".py", ".js", ".lua"))}
    shown = named(made_part(TREE_PAGE, "tree"))
    hidden = {folder for folder in folders - shown if "/vendor" not in folder}
    assert hidden == set()
    assert [folder for folder in shown if not (ROOT / folder).is_dir()] == []


def test_the_tree_says_what_the_packages_say_of_themselves() -> None:
    assert made_part(TREE_PAGE, "tree") == tree(), "run python -m tests.guide"


def test_the_picture_of_the_layers_is_that_of_the_import_contracts() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    contracts = project["tool"]["importlinter"]["contracts"]
    [factory, inside] = [each["layers"] for each in contracts if each["type"] == "layers"]
    [picture, *_] = [each.text for each in blocks(TREE_PAGE)]
    drawn = re.findall(r"^ .{11}(\w+(?: \| \w+)*) {2,}\S", picture, re.MULTILINE)
    assert [*drawn, "service"] == [*factory[:-1], *inside, factory[-1]]


@pytest.mark.parametrize("name", ["weights", "times", "road-times", "day"])
def test_tables_of_figures_are_those_of_the_stored_results(name: str) -> None:
    page, made = figures()[name]
    assert made.startswith("| ")
    assert made_part(page, name) == made, "run python -m tests.guide"


def test_the_table_of_codes_is_that_of_the_service() -> None:
    table = made_part(GUIDE / "errors.md", "codes")
    assert set(re.findall(r"^\| \d+ \| <a .*></a>`([a-z-]+)`", table, re.MULTILINE)) == set(
        PROBLEMS
    )
    assert table == codes(), "run python -m tests.guide"
    assert made_part(GUIDE / "errors.md", "faults") == faults(), "run python -m tests.guide"
    assert made_part(GUIDE / "errors.md", "remedies") == remedies(), "run python -m tests.guide"


def test_the_client_and_the_page_have_what_the_service_has() -> None:
    for path, module in {**type_files(), **page_tables()}.items():
        assert path.read_text() == module, "run python -m tests.guide"
    assert JSON.read_text() == json_file(), "run python -m tests.guide"


def test_every_measure_is_an_objective_in_the_guide() -> None:
    rows = re.findall(
        r"^\| `(\w+)` \| costs against ", (GUIDE / "plan-a-fleet.md").read_text(), re.M
    )
    assert rows == list(TRADED)
    assert set(rows) == set(get_args(Measure))


def test_every_setting_is_described() -> None:
    text = (GUIDE / "run-it-in-production.md").read_text()
    sentences = sentences_of(Settings)
    for name, field in Settings.model_fields.items():
        variable = field.validation_alias or f"PARETOUR_{name.upper()}"
        assert f"| `{variable}` |" in text
        assert sentences[name] in text


def test_every_limit_names_a_setting_and_a_code_that_there_are() -> None:
    text = (GUIDE / "limits.md").read_text()
    variables = re.findall(r"`PARETOUR_(\w+)`", text)
    assert {variable.lower() for variable in variables} <= set(Settings.model_fields)
    rows = re.findall(r"\| (\d{3}) `([a-z-]+)` \|", text)
    assert len(rows) >= 10
    assert all(PROBLEMS[code].status == int(status) for status, code in rows)


def test_every_status_that_the_service_may_answer_with_is_described() -> None:
    paths = app_of().openapi()["paths"]
    promised = {
        status
        for operations in paths.values()
        for operation in operations.values()
        for status in operation["responses"]
    }
    table = (GUIDE / "errors.md").read_text().partition("| status | when |")[2].partition("\n\n")[0]
    described = set(re.findall(r"\b[45]\d\d\b", table))
    assert {status for status in promised if status >= "400"} <= described
