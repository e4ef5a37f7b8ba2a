"""The files that the page is made of: their weight, their licences, and what they may load."""

from pathlib import Path

import httpx

SERVICE = Path(__file__).parents[2] / "service"


def test_what_the_page_loads_weighs_less_than_half_a_megabyte() -> None:
    files = [path for path in (SERVICE / "page").rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 500_000


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
