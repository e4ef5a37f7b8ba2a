"""The tables of refusals and of faults in `errors.md`, made of those of `service.errors`."""

import re

from service.errors.faults import SENTENCES
from service.errors.problems import PROBLEMS, Problem
from tests.guide.pages import GUIDE

PAGE = GUIDE / "errors.md"


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
    rows = [
        f"| `{code}` | {re.sub(r'(?:![a-z])?(?::[^}]*)?}', '}', sentence)} |"
        for code, sentence in sorted(SENTENCES.items())
    ]
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
