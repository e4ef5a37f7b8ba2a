"""The files that the page is made of: their weight, their licences, and what they may load."""

import gzip
import os
import re
from pathlib import Path

import httpx

SERVICE = Path(__file__).parents[2] / "service"


def test_all_that_the_page_can_load_is_sent_as_less_than_240_kilobytes() -> None:
    files = [path for path in (SERVICE / "page").rglob("*") if path.is_file()]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < 240_000


def test_a_first_view_sends_less_than_150_kilobytes(released: str) -> None:
    """The page, and the scripts and style sheets that it loads before charts and maps."""
    loaded = ["", *_linked((SERVICE / "page/index.html").read_text())]
    for path in loaded:
        if path.endswith(".js"):
            folder = Path(path).parent
            imported = IMPORT.findall((SERVICE / path).read_text())
            found = [os.path.normpath(folder / each) for each in imported]
            loaded += [each for each in found if each not in loaded]
    assert {"page/inputs/table.js", "page/vendor/eventsource-parser/stream.js"} <= set(loaded)
    sent = [httpx.get(f"{released}/{path}") for path in loaded]
    assert all(response.is_success for response in sent)
    assert sum(response.num_bytes_downloaded for response in sent) < 150_000


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
