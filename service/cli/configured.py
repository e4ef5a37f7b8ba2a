"""Settings as the command finds them, and what can be loaded with them."""

from collections.abc import Callable
from typing import Any, TypeVar

from pydantic import ValidationError

from service.cli.errors import Wrong
from service.settings import Settings

T = TypeVar("T")


def configured(**given: Any) -> Settings:
    """The settings, of which some are given and not None.

    Raises:
        Wrong: one of them is not what it must be.
    """
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        raise Wrong(_explained(error)) from None


def loaded(load: Callable[[Settings], T], settings: Settings) -> T:
    """What is made as the settings say.

    Raises:
        Wrong: the files that they name are not there, or not what they must be.
    """
    try:
        return load(settings)
    except (OSError, ValueError) as error:
        raise Wrong(str(error)) from None


def _explained(error: ValidationError) -> str:
    return "; ".join(
        f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}, got {fault['input']!r}"
        for fault in error.errors()
    )
