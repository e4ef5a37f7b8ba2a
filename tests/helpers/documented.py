"""The sentences below the attributes of a class, which Python does not keep."""

import ast
import inspect
from itertools import pairwise


def sentences_of(documented: type) -> dict[str, str]:
    """Return the sentence below each annotated attribute in the source of a class, by its name."""
    [definition] = ast.parse(inspect.getsource(documented)).body
    assert isinstance(definition, ast.ClassDef)
    found = {}
    for attribute, after in pairwise(definition.body):
        match attribute, after:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(sentence))),
            ):
                found[name] = sentence
    return found
