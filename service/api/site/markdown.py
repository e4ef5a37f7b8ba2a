"""Pages of Markdown as HTML, with anchors at headings, and the sections that a search finds."""

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from markdown_it import MarkdownIt
from markdown_it.token import Token

Resolve = Callable[[str], str | None]
_RENDERER = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"])
_PROSE = 60  # characters; a longer cell keeps room for some words on narrow screens


@dataclass(frozen=True)
class Section:
    """A heading and the text below it, down to the next heading.

    Attributes:
        anchor: The anchor of the heading, as code hosts make it.
        heading: The text of the heading.
        text: Everything below the heading, without marks.
    """

    anchor: str
    heading: str
    text: str


@dataclass(frozen=True)
class Page:
    """A page of Markdown.

    Attributes:
        title: Its first heading.
        html: The page as HTML, with its title.
        sections: The sections in order.
    """

    title: str
    html: str
    sections: tuple[Section, ...]


def render(text: str, resolve: Resolve) -> Page:
    """Return a page of Markdown that begins with a heading as HTML.

    Args:
        text: The Markdown, which is trusted: HTML in it is kept.
        resolve: Returns the address of the target of a link or picture, or None; a link without
            a target is replaced by its text.
    """
    tokens = _RENDERER.parse(text)
    uses = Counter[str]()  # of each anchor: a repeated heading gets a number
    _name_tables(tokens)
    for at, token in enumerate(tokens):
        if token.type == "heading_open":
            anchor = slug(_text(tokens[at + 1]))
            token.attrSet("id", f"{anchor}-{uses[anchor]}" if uses[anchor] else anchor)
            uses[anchor] += 1
        elif token.type == "inline" and token.children:
            token.children = list(_resolved(token.children, resolve))
        elif token.type in ("th_open", "td_open") and "style" in token.attrs:
            # The service tells browsers to ignore styles inside a document.
            token.attrs = {"class": str(token.attrs["style"]).removeprefix("text-align:")}
        if token.type == "td_open" and len(_text(tokens[at + 1])) > _PROSE:
            token.attrJoin("class", "prose")
    sections = tuple(_sections(tokens))
    html = _RENDERER.renderer.render(tokens, _RENDERER.options, {})
    return Page(sections[0].heading, _with_scrolling_tables(html), sections)


def slug(heading: str) -> str:
    """Return the anchor of a heading as code hosts make it.

    >>> slug("How is `POST /front` answered?")
    'how-is-post-front-answered'
    """
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _with_scrolling_tables(html: str) -> str:
    """Return the HTML with each table in a block of its own, which scrolls on narrow screens.

    The block has a name, and can be focused, like blocks of code, so that keys scroll it too. An
    empty heading becomes an ordinary cell, since a screen reader would announce a heading without
    text.
    """
    html = html.replace("<th></th>", "<td></td>")
    html = re.sub(
        r"<table aria-label=(\".*?\")>",
        r'<div class="wide" role="region" aria-label=\1 tabindex="0"><table>',
        html,
    )
    return html.replace("</table>", "</table></div>").replace("<pre>", '<pre tabindex="0">')


def _name_tables(tokens: list[Token]) -> None:
    """Name each table by the heading above it, with a number from the second one on."""
    heading, uses = "", Counter[str]()
    for at, token in enumerate(tokens):
        if token.type == "heading_open":
            heading = _text(tokens[at + 1])
        elif token.type == "table_open":
            uses[heading] += 1
            number = f" {uses[heading]}" if uses[heading] > 1 else ""
            token.attrSet("aria-label", f"Table{number}: {heading}")


def _resolved(tokens: list[Token], resolve: Resolve) -> Iterator[Token]:
    """Yield inline tokens with resolved addresses, and without links that lead nowhere."""
    dead = False
    for token in tokens:
        if token.type == "link_open":
            address = resolve(str(token.attrs["href"]))
            dead = address is None
            token.attrs["href"] = address or ""
        elif token.type == "image":
            token.attrs["src"] = resolve(str(token.attrs["src"])) or ""
        if not (dead and token.type in ("link_open", "link_close")):
            yield token
        if token.type == "link_close":
            dead = False


def _sections(tokens: list[Token]) -> Iterator[Section]:
    anchor, heading, words = "", "", list[str]()
    for at, token in enumerate(tokens):
        if token.type == "heading_open":
            if heading:
                yield Section(anchor, heading, " ".join(words))
            anchor, heading, words = str(token.attrs["id"]), _text(tokens[at + 1]), []
        elif token.type in ("inline", "fence") and tokens[at - 1].type != "heading_open":
            words += _text(token).split()
    yield Section(anchor, heading, " ".join(words))


def _text(token: Token) -> str:
    """Return the visible text of a block of text or code."""
    if token.children is None:
        return token.content
    return "".join(
        " " if child.type in ("softbreak", "hardbreak") else child.content
        for child in token.children
        if child.type != "html_inline"
    )
