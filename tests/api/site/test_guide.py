"""The guide, against a live server."""

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from urllib.parse import urljoin

import httpx
import pytest

from service.api.app import Edge
from service.api.auth import Access, KeyHash
from service.api.openapi import example_refusal
from service.errors import PROBLEMS
from tests.guide.pages import GUIDE, anchors
from tests.helpers.serving import app_of, problem, serving

PAGES = sorted(path.stem for path in Path("service/guide").glob("*.md"))
_LINK = re.compile(r'(?:href|src)="([^"]+)"')
_ID = re.compile(r'id="([^"]+)"')


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with (
        serving(app_of(), warm=False) as address,
        httpx.Client(base_url=address, follow_redirects=True) as client,
    ):
        yield client


def test_the_guide_begins_with_its_index(client: httpx.Client) -> None:
    answer = client.get("/guide")
    assert answer.url.path == "/guide/"
    assert "<title>The guide of Paretour" in answer.text


def test_the_old_address_of_a_page_leads_to_it(client: httpx.Client) -> None:
    answer = client.get("/guide/train-and-add-an-actor")
    assert answer.status_code == 200
    assert answer.url.path == "/guide/train-your-own-actor"


@pytest.fixture(scope="module")
def ids_at(client: httpx.Client) -> Callable[[str], Sequence[str]]:
    """The ids behind an address that must lead to something, and is asked for once."""

    @cache
    def found(address: str) -> Sequence[str]:
        answer = client.get(address)
        assert answer.status_code == 200, address
        return _ID.findall(answer.text)

    return found


@pytest.mark.parametrize("name", PAGES)
def test_every_link_of_a_page_leads_to_something(
    client: httpx.Client, ids_at: Callable[[str], Sequence[str]], name: str
) -> None:
    page = client.get(f"/guide/{name}")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    targets = {urljoin(str(page.url), link) for link in _LINK.findall(page.text)}
    inside = {target for target in targets if target.startswith(str(client.base_url))}
    assert len(inside) > len(PAGES)
    for target in inside:
        address, _, anchor = target.partition("#")
        ids = ids_at(address)
        assert not anchor or anchor in ids, target


def test_the_type_of_every_problem_leads_to_its_code(client: httpx.Client) -> None:
    shown = _ID.findall(client.get("/guide/errors").text)
    assert len(shown) == len(set(shown))
    for code in PROBLEMS:
        page, _, anchor = example_refusal(code).document("")["type"].partition("#")
        assert (page, anchor) == ("/guide/errors", code)
        assert code in shown
        assert code in anchors(GUIDE / "errors.md")


def test_the_type_of_an_answer_is_an_address_of_the_guide(client: httpx.Client) -> None:
    refused = client.get("/nothing")
    page = client.get(urljoin(str(refused.url), problem(refused, 404, "no-such-path")["type"]))
    assert page.status_code == 200
    assert '<a id="no-such-path"></a>' in page.text


def test_every_page_lists_all_others(client: httpx.Client) -> None:
    for name in PAGES:
        navigation = client.get(f"/guide/{name}").text.partition("<main")[0]
        listed = re.findall(r'^<a href="([a-z-]+)"', navigation, re.MULTILINE)
        assert sorted(listed) == [page for page in PAGES if page != "index"]


def test_an_outline_lists_every_page_with_a_sentence_for_programs(client: httpx.Client) -> None:
    answer = client.get("/llms.txt")
    assert answer.headers["content-type"] == "text/plain; charset=utf-8"
    assert answer.headers["cache-control"] == client.get("/guide/").headers["cache-control"]
    title, summary, operations, *lists = answer.text.strip().split("\n\n")
    assert title == "# Paretour"
    assert re.fullmatch(r"> Paretour plans [^\n]+\.", summary)
    assert client.get(re.findall(r"\((.+)\)", operations)[0]).json()["openapi"]
    groups, pages = lists[::2], "\n".join(lists[1::2]).splitlines()
    assert all(re.fullmatch(r"## \w[^\n]+", group) for group in groups)
    listed = [re.fullmatch(r"- \[.+\?\]\(/guide/([a-z-]+)\): .+\.", line) for line in pages]
    assert sorted(each[1] for each in listed if each) == [name for name in PAGES if name != "index"]
    assert len(listed) == len(PAGES) - 1


def test_the_outline_is_open_without_a_key_and_knows_its_path() -> None:
    edge = Edge(access=Access([KeyHash(caller="robot", digest="0" * 64)]))
    with serving(app_of(edge=edge), warm=False, root_path="/tours") as address:
        problem(httpx.get(f"{address}/actors"), 401, "unauthorized", "/tours")
        assert "(/tours/guide/plan-a-front): " in httpx.get(f"{address}/llms.txt").text


def test_the_reference_begins_with_what_links_lead_to(client: httpx.Client) -> None:
    description = client.get("/openapi.json").json()["info"]["description"]
    links = re.findall(r"\]\(([^)]+)\)", description)
    assert links
    assert all(client.get(urljoin("/docs", link)).status_code == 200 for link in links)


def test_a_search_finds_sections_by_an_address_that_leads_to_them(client: httpx.Client) -> None:
    sections = client.get("/guide/search.json").json()
    found = [each for each in sections if "Idempotency-Key" in each["text"]]
    assert found
    page, _, anchor = found[0]["address"].partition("#")
    assert f'id="{anchor}"' in client.get(f"/guide/{page}").text


@pytest.mark.parametrize("path", ["none", "INDEX", "index.md", "../settings", "site/none.js"])
def test_a_path_without_a_page_is_404(client: httpx.Client, path: str) -> None:
    problem(client.get(f"/guide/{path}"), 404, "no-such-path")


@pytest.mark.parametrize("word", ["webhook", "geocode"])
def test_a_search_finds_what_callers_look_for(client: httpx.Client, word: str) -> None:
    sections = client.get("/guide/search.json").json()
    assert any(word in section["heading"].lower() for section in sections)
