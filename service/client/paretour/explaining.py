"""Write the help of the client's functions: what the members of a request are, and of a call."""

import json
from collections.abc import Callable
from functools import wraps
from inspect import Signature, cleandoc, signature
from pkgutil import get_data
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])
# The lines of the help on each type of request: `python -m tests.guide` writes them.
_HELP = json.loads(get_data("paretour", "members.json") or b"")["help"]


def explaining(*requests: type) -> Callable[[Function], Function]:
    """Return a decorator that adds what the members of these requests are to a function's help."""

    def decorate(function: Function) -> Function:
        sections = [cleandoc(function.__doc__ or "")]
        for request in requests:
            title = f"Members of the request ({request.__name__}):"
            sections.append("\n    ".join((title, *_HELP[request.__name__])))
        function.__doc__ = "\n\n".join(sections)
        return function

    return decorate


def described_as(call: Callable[..., Any]) -> Callable[[Function], Function]:
    """Return a decorator that gives a client's method the name, help and parameters of a call."""

    def decorate(method: Function) -> Function:
        described = wraps(call)(method)
        parameters = signature(call).replace(return_annotation=Signature.empty)
        described.__signature__ = parameters  # type: ignore[attr-defined]
        return cast(Function, described)

    return decorate
