"""Load the settings and the files that they name; raise UsageError if that fails."""

import os
import re
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from service.cli.errors import UsageError
from service.settings import Settings, unknown_variables, variable_of

T = TypeVar("T")
_PASSWORD = re.compile(
    r"(//)[^/]*@|((?:password|[?&][^=&\s']*)=)[^&\s']+", re.IGNORECASE
)  # of a URL
_SECRETS = ("api_keys", "webhook_secrets")  # settings whose values are never shown


def load_settings(**options: Any) -> Settings:
    """Return the settings; an option that is not None replaces its setting.

    Raises:
        UsageError: A setting has a wrong value, or a variable is not a setting.
    """
    if unknown := list(unknown_variables(os.environ)):
        raise UsageError("; ".join(unknown))
    try:
        return Settings(**{name: value for name, value in options.items() if value is not None})
    except ValidationError as error:
        raise UsageError(_sentence(error, options)) from None


def load_with(load: Callable[[Settings], T], settings: Settings) -> T:
    """Return the result of a function that loads or builds something from the settings.

    Raises:
        UsageError: A file that the settings name is missing or wrong, or they lack one.
    """
    try:
        return load(settings)
    except (OSError, ValueError) as error:
        raise UsageError(str(error)) from None


def _sentence(error: ValidationError, options: Mapping[str, Any]) -> str:
    """Return what is wrong, naming options and variables as the operator wrote them."""
    return "; ".join(
        f"{_written(fault['loc'], options)}: {fault['msg'].removeprefix('Value error, ')}"
        + ("" if fault["loc"][0] in _SECRETS else f", got {_masked(repr(fault['input']))}")
        for fault in error.errors()
    )


def _masked(text: str) -> str:
    """Return a text with *** in place of passwords in URLs and of values in their queries."""
    return _PASSWORD.sub(lambda found: "//***@" if found[1] else f"{found[2]}***", text)


def _written(location: tuple[int | str, ...], options: Mapping[str, Any]) -> str:
    name, *within = map(str, location)
    if options.get(name) is not None:
        return f"--{name}"
    return variable_of(name) + "".join(f", entry {int(each) + 1}" for each in within)
