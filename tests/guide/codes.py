"""The tables of refusals, faults and remedies in `errors.md`, made of those of `service.errors`."""

import re
from collections.abc import Iterable

from service.errors.faults import REMEDIES, SENTENCES
from service.errors.problems import PROBLEMS, Problem
from tests.guide.pages import GUIDE

PAGE = GUIDE / "errors.md"
_FIELD = re.compile(r"\{(\w+)(?:![a-z])?(?::[^}]*)?\}")  # of a sentence, with how it is shown
_FIELD_ALONE = r"{\1}"


def codes() -> str:
    """Return the table of codes as Markdown, by status and code."""
    ordered = sorted(PROBLEMS.items(), key=lambda item: (item[1].status, item[0]))
    rows = [
        f"| {problem.status} | {_anchored(code)} | {_sentence(problem)} | {_operations(problem)} |"
        for code, problem in ordered
    ]
    head = ["| status | code | sentence | answered by |", "|---|---|---|---|"]
    return "\n".join([*head, *rows]) + "\n"


def faults() -> str:
    """Return the table of what can be wrong with a field as Markdown, by code."""
    return _table_of(sorted(SENTENCES.items()))


def remedies() -> str:
    """Return the table of remedies as Markdown, in the order in which they are looked for."""
    return _table_of(REMEDIES.items())


def _table_of(sentences: Iterable[tuple[str, str]]) -> str:
    rows = [f"| `{code}` | {_FIELD.sub(_FIELD_ALONE, text)} |" for code, text in sentences]
    return "\n".join(["| code | sentence |", "|---|---|", *rows]) + "\n"


def _anchored(code: str) -> str:
    """Return a code with the anchor that the `type` of its problem documents leads to."""
    return f'<a id="{code}"></a>`{code}`'


def _sentence(problem: Problem) -> str:
    if problem.sentence in ("{detail}", "{reason}"):
        return "says what is wrong, and where"
    return problem.sentence.replace(":g}", "}").replace("|", "\\|")


def _operations(problem: Problem) -> str:
    if problem.operations == ("*",):
        return "several paths, as `/docs` says"
    if not problem.operations:
        return "any path"
    return ", ".join(f"`{operation}`" for operation in problem.operations)
