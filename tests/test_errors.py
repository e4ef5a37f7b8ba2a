"""The table of refusals holds every code that the service raises, and no other."""

import ast
import pickle
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.errors import PROBLEMS, Fault, InvalidCoverage, Refusal, TooManyPlaces, WorkerLost

SERVICE = Path(__file__).parents[1] / "service"


def codes_in(tree: ast.AST) -> Iterator[str]:
    """The literal codes in calls of Refusal and in the attribute `code` of its classes."""
    for node in ast.walk(tree):
        match node:
            case (
                ast.Call(func=ast.Name("Refusal"), args=[ast.Constant(str(code)), *_])
                | ast.Assign(targets=[ast.Name("code")], value=ast.Constant(str(code)))
                | ast.Call(func=ast.Attribute(attr="__init__"), args=[ast.Constant(str(code)), *_])
            ):
                yield code


def test_every_code_of_the_table_is_raised_and_every_code_raised_is_in_it() -> None:
    raised = {
        code
        for path in SERVICE.rglob("*.py")
        if "client" not in path.parts
        for code in codes_in(ast.parse(path.read_text()))
    }
    assert raised == set(PROBLEMS)


def test_no_code_is_raised_that_is_not_written_out() -> None:
    """The test above sees literal codes alone."""
    for path in SERVICE.rglob("*.py"):
        if path.parent.name == "errors" or path.name == "openapi.py" or "client" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            match node:
                case ast.Call(func=ast.Name("Refusal"), args=arguments):
                    assert isinstance(arguments[0], ast.Constant), (path, node.lineno)


@pytest.mark.parametrize(
    "refusal",
    [
        Refusal("over-limit", name="size", pointer="/size", limit=9, actual=10),
        WorkerLost(),
        TooManyPlaces(limit=50, actual=60),
        InvalidCoverage(
            Fault.of("places/0", "obstacle", given="[0, 1]"),
            Fault.of("places/1", "unreachable", other="/places/0"),
        ),
    ],
)
def test_a_refusal_travels_between_processes(refusal: Refusal) -> None:
    copy = pickle.loads(pickle.dumps(refusal))
    assert type(copy) is type(refusal)
    assert str(copy) == str(refusal)
    assert copy.document("id") == refusal.document("id")
