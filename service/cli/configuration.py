"""Load the settings, and what they name, with a UsageError where that fails."""

from collections.abc import Callable
from typing import Any, TypeVar

from pydantic import ValidationError

from service.cli.errors import UsageError
from service.settings import Settings

T = TypeVar("T")


def load_settings(**options: Any) -> Settings:
    """Return the settings, with those options in place that are not None.

    Raises:
        UsageError: A setting has a wrong value.
    """
    try:
        return Settings(**{name: value for name, value in options.items() if value is not None})
    except ValidationError as error:
        raise UsageError(_sentence(error)) from None


def load_with(load: Callable[[Settings], T], settings: Settings) -> T:
    """Return what a function loads or builds by the settings.

    Raises:
        UsageError: A file that the settings name is missing or wrong, or they lack one.
    """
    try:
        return load(settings)
    except (OSError, ValueError) as error:
        raise UsageError(str(error)) from None


def _sentence(error: ValidationError) -> str:
    return "; ".join(
        f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}, got {fault['input']!r}"
        for fault in error.errors()
    )
