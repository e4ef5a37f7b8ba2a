"""Say in the help of a function what the members of its request are."""

import json
from collections.abc import Callable
from inspect import cleandoc
from pkgutil import get_data
from typing import Any, TypeVar

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
