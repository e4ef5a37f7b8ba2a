"""The files that the page is made of: their weight, their licences, and what they may load."""

import os
import re
from pathlib import Path

import httpx
import pytest

SERVICE = Path(__file__).parents[2] / "service"


PAGE = SERVICE / "page"
WORLD = PAGE / "map/world.bin"
COMMENT = re.compile(r"\s*(//|/\*|\*(?! \{))")  # a line of one; "* {" is a rule for all elements


def test_all_that_the_page_can_load_is_sent_as_less_than_240_kilobytes(released: str) -> None:
    """All but licences, and the map of the world, which comes with stops of one's own."""
    with httpx.Client(base_url=released) as client:
        paths = [path for path in PAGE.rglob("*.*") if path.is_file() and path != WORLD]
        sent = [client.get(str(path.relative_to(SERVICE))) for path in paths]
    assert all(response.is_success for response in sent)
    assert sum(response.num_bytes_downloaded for response in sent) < 240_000


def test_the_map_of_the_world_has_at_most_300_kilobytes() -> None:
    assert WORLD.stat().st_size <= 300_000


@pytest.mark.parametrize("path", ["page/main.js", "page/style.css"])
def test_neither_comments_nor_indentation_are_sent_and_lines_keep_their_numbers(
    released: str, path: str
) -> None:
    source = [line.lstrip() for line in (SERVICE / path).read_text().splitlines()]
    sent = httpx.get(f"{released}/{path}").text.splitlines()
    assert sum(line.lstrip().startswith("/*") for line in source) > 5
    assert len(sent) == len(source)
    assert all(full.startswith(line) for line, full in zip(sent, source, strict=True))
    assert not any(COMMENT.match(line) for line in sent)
    pairs = zip(sent, source, strict=True)
    after_code = [full.removeprefix(line) for line, full in pairs if line not in ("", full)]
    assert all(each.lstrip().startswith(("// ", "/* ")) for each in after_code)
    assert len(after_code) > 1


def test_a_script_with_a_string_over_several_lines_keeps_its_indentation(released: str) -> None:
    sent = httpx.get(f"{released}/page/result/python.js").text
    assert any(line.startswith("  ") for line in sent.splitlines())


def test_a_first_view_sends_less_than_120_kilobytes(released: str) -> None:
    """The page, and the scripts and style sheets that it loads before charts and maps."""
    loaded = ["", *_linked((SERVICE / "page/index.html").read_text())]
    for path in loaded:
        if path.endswith(".js"):
            folder = Path(path).parent
            imported = IMPORT.findall((SERVICE / path).read_text())
            found = [os.path.normpath(folder / each) for each in imported]
            loaded += [each for each in found if each not in loaded]
    assert {"page/inputs/table.js", "page/planning/event_stream.js"} <= set(loaded)
    sent = [httpx.get(f"{released}/{path}") for path in loaded]
    assert all(response.is_success for response in sent)
    assert sum(response.num_bytes_downloaded for response in sent) < 120_000


IMPORT = re.compile(r'import (?:[^"]* from )?"(\.[^"]+)"')


def _linked(html: str) -> list[str]:
    return re.findall(r'(?:src|href)="(page/[^"]+)"', html)


def test_every_vendored_library_comes_with_its_licence() -> None:
    libraries = [*SERVICE.glob("page/vendor/*"), *SERVICE.glob("reference/vendor/*")]
    assert libraries
    assert all((library / "LICENSE").exists() for library in libraries)


def test_a_browser_may_load_nothing_from_elsewhere(released: str) -> None:
    for path in ("/", "/docs", "/actors", "/nowhere"):
        policy = httpx.get(f"{released}{path}").headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "http" not in policy
