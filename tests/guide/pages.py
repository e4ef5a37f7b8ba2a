"""Read the README and the pages of the guide: their fenced blocks, links and headings."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
GUIDE = ROOT / "service/guide"
PAGES = (README, *sorted(GUIDE.glob("*.md")))

_FENCE = re.compile(r"^```(\w+)(?: +(\S+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
_ANCHOR = re.compile(r'<a id="([^"]+)"></a>')


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, the title behind it ("answer", a file's name) and its text."""

    language: str
    title: str
    text: str


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page, in their order."""
    return [Block(*found) for found in _FENCE.findall(page.read_text())]


def links(page: Path) -> list[str]:
    """Return the targets of a page's links and pictures that lie in the repository."""
    found = _LINK.findall(_FENCE.sub("", page.read_text()))
    return [target for target in found if "://" not in target]


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as GitHub makes them, and those in its text."""
    text = _FENCE.sub("", page.read_text())
    headings = _HEADING.findall(text)
    made = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
    return made.union(_ANCHOR.findall(text))


def commands(page: Path) -> list[str]:
    """Return the commands of a page's sh blocks, without those that are files."""
    shell = [each.text for each in blocks(page) if each.language == "sh" and not each.title]
    return [command for text in shell for command in split_commands(text)]


def split_commands(text: str) -> list[str]:
    """Return the commands of a sh block; a command may go over several lines."""
    found: list[str] = []
    unfinished = ""
    for line in text.splitlines(keepends=True):
        unfinished += line
        if unfinished.endswith("\\\n") or unfinished.count("'") % 2:
            continue
        found.append(unfinished.strip())
        unfinished = ""
    return found


def made_part(page: Path, name: str) -> str:
    """Return the part of a page between its marks `begin: name` and `end: name`."""
    [part] = re.findall(_marks(name), page.read_text(), re.DOTALL)
    return part


def with_part(page: Path, name: str, part: str) -> str:
    """Return the page with another part between these marks."""
    begin, end = f"<!-- begin: {name} -->\n", f"<!-- end: {name} -->"
    return re.sub(_marks(name), lambda _: f"{begin}{part}{end}", page.read_text(), flags=re.DOTALL)


def _marks(name: str) -> str:
    return rf"<!-- begin: {name} -->\n(.*?)<!-- end: {name} -->"
