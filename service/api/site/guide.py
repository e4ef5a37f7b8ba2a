"""Serve the guide at `/guide/`, rendered at its first request, and its outline `/llms.txt`."""

import re
from functools import cache, cached_property
from html import escape
from pathlib import Path
from string import Template

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import (
    HTMLResponse,
    JSONResponse,
    PlainTextResponse,
    RedirectResponse,
    Response,
)
from starlette.routing import BaseRoute

from service.api.responses import root_path_of
from service.api.site.markdown import Page, render
from service.api.site.routes import NamedRoute
from service.api.site.static import REVALIDATE, files

_SERVICE = Path(__file__).parents[2]
_GUIDE = _SERVICE / "guide"
_INDEX = "index"
_RENAMED = {"train-and-add-an-actor": "train-your-own-actor"}
_PAGE_LINK = re.compile(r"([a-z-]+)\.md(#.*)?")
_SERVED = re.compile(
    r"(pictures/[a-z-]+\.png)|\.\./(?:(deploy/[a-z-]+\.yaml)|(examples/[a-z-]+\.json))"
)
_GROUP = re.compile(r"^\*\*(.+)\*\*$|^- \[(.+?)\]\(([a-z-]+)\.md\) (.+)$", re.MULTILINE)


def guide_routes() -> list[BaseRoute]:
    """Return the routes of the guide, its pictures and the manifests that it links to."""
    return [
        NamedRoute("/guide", _to_the_index),
        NamedRoute("/guide/", _page),
        NamedRoute("/guide/search.json", _search),
        NamedRoute("/guide/site/{path:path}", files(_GUIDE / "site")),
        NamedRoute("/guide/pictures/{path}", files(_GUIDE / "pictures")),
        NamedRoute("/guide/deploy/{path}.yaml", files(_SERVICE / "deploy", ".yaml")),
        NamedRoute("/guide/{name}", _page),
        NamedRoute("/llms.txt", _outline),
    ]


class Guide:
    """The pages of a folder of Markdown; its `index.md` lists all others in groups."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        names = {path.stem for path in folder.glob("*.md")}
        self.pages = {name: self._render(name, names) for name in sorted(names)}
        self._entries = _GROUP.findall((folder / "index.md").read_text(encoding="utf-8"))
        self._template = Template((folder / "site/template.html").read_text(encoding="utf-8"))

    def document(self, name: str) -> str:
        """Return a page as a document of HTML."""
        page = self.pages[name]
        return self._template.substitute(
            title=page.title, navigation=self._navigation(name), content=page.html
        )

    @cached_property
    def search_index(self) -> list[dict[str, str]]:
        """The sections of all pages: address, title of the page, heading and text."""
        return [
            {
                "address": f"{_address(name)}#{section.anchor}",
                "page": page.title,
                "heading": section.heading,
                "text": section.text,
            }
            for name, page in self.pages.items()
            for section in page.sections
        ]

    def outline(self, root_path: str) -> str:
        """Return the list of all pages for language models, in the format of llmstxt.org.

        Args:
            root_path: The path under which the client sees the service.
        """
        summary = self.pages[_INDEX].sections[0].text.partition(". ")[0]
        lines = [
            *("# Paretour", "", f"> {summary}.", ""),
            f"All operations are described in [openapi.json]({root_path}/openapi.json).",
        ]
        for group, question, name, sentence in self._entries:
            if group:
                lines += ["", f"## {group}", ""]
            else:
                lines.append(f"- [{question}]({root_path}/guide/{name}): {sentence}")
        return "\n".join([*lines, ""])

    def _render(self, name: str, names: set[str]) -> Page:
        text = (self._folder / f"{name}.md").read_text(encoding="utf-8")
        return render(text, lambda target: _resolved(target, names))

    def _navigation(self, current: str) -> str:
        """Return the list of pages as HTML, in the index's groups."""
        lines = []
        for group, question, name, _ in self._entries:
            if group:
                lines.append(f"<h2>{escape(group)}</h2>")
            else:
                here = ' aria-current="page"' if name == current else ""
                lines.append(f'<a href="{_address(name)}"{here}>{escape(question)}</a>')
        return "\n".join(lines)


def _address(name: str) -> str:
    """Return the address of a page, relative to the others."""
    return "./" if name == _INDEX else name


def _resolved(target: str, names: set[str]) -> str | None:
    """Return the address in the guide of a link's target, None for files that are not served."""
    if "://" in target or target.startswith("#"):
        return target
    if (page := _PAGE_LINK.fullmatch(target)) and page[1] in names:
        return _address(page[1]) + (page[2] or "")
    if served := _SERVED.fullmatch(target):
        return served[1] or served[2] or f"../{served[3]}"
    return None


@cache
def _guide() -> Guide:
    return Guide(_GUIDE)


async def _to_the_index(_: Request) -> Response:
    return RedirectResponse("guide/", status_code=308)


def _page(request: Request) -> Response:
    """Answer with a page; in a thread, because the first request renders all pages."""
    name = request.path_params.get("name", _INDEX)
    if name in _RENAMED:
        return RedirectResponse(_RENAMED[name], status_code=308)
    if name not in _guide().pages:
        raise HTTPException(404)
    return HTMLResponse(_guide().document(name), headers=REVALIDATE)


def _outline(request: Request) -> Response:
    return PlainTextResponse(_guide().outline(root_path_of(request.scope)), headers=REVALIDATE)


def _search(_: Request) -> Response:
    return JSONResponse(_guide().search_index, headers=REVALIDATE)
