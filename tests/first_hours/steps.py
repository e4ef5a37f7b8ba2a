"""Take the steps of an hour from the pages: commands, files, programs and sentences."""

from contextlib import chdir
from pathlib import Path
from typing import Any

from tests.guide.pages import GUIDE, README, blocks, commands
from tests.guide.sessions import REACHED


def page_of(name: str) -> Path:
    """Return the README, or a page of the guide by its name."""
    return README if name == "README" else GUIDE / f"{name}.md"


def says(page: str, sentence: str) -> None:
    """Fail unless a page has the sentence that a step follows, whatever its line breaks."""
    assert sentence in " ".join(page_of(page).read_text().split()), (page, sentence)


def command(page: str, *words: str) -> str:
    """Return the first command of a page that has all of these words."""
    found = [each for each in commands(page_of(page)) if all(word in each for word in words)]
    assert found, (page, words)
    return found[0]


def write_files(page: str, folder: Path, *names: str) -> None:
    """Write files of a page, by their names, into a folder."""
    texts = {block.title: block.text for block in blocks(page_of(page))}
    for name in names:
        (folder / name).write_text(texts[name])


def run_program(page: str, words: str, folder: Path, address: str = "") -> dict[str, Any]:
    """Run the first Python block of a page that has these words, and return what it defines."""
    [text, *_] = [
        block.text
        for block in blocks(page_of(page))
        if block.language == "python" and not block.title and words in block.text
    ]
    defined: dict[str, Any] = {}
    with chdir(folder):
        exec(text.replace(REACHED, address.removeprefix("http://")), defined)
    return defined
