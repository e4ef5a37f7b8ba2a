"""How the command ends when it cannot do what was asked: a sentence on stderr and an exit code."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import httpx
import typer
from paretour import Refused
from pydantic import ValidationError

from service.cli.tsplib import UnreadableFile
from service.settings import Settings

WRONG = 2
UNAVAILABLE = 3
_NOT_THE_REQUEST = (401, 403, 408, 429)


class UsageError(Exception):
    """What the caller can put right."""


@contextmanager
def explaining() -> Iterator[None]:
    """Ends the command where something in the block went as wrong as may be expected."""
    try:
        yield
    except (UsageError, UnreadableFile) as error:
        raise ended(str(error), WRONG) from None
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise ended(f"{error.filename}: {error.strerror}", WRONG) from None
    except Refused as error:
        faulty = 400 <= error.status < 500 and error.status not in _NOT_THE_REQUEST
        raise ended(str(error), WRONG if faulty else UNAVAILABLE) from None
    except httpx.TransportError as error:
        raise ended(f"the service does not answer: {error}", UNAVAILABLE) from None


def ended(sentence: str, code: int) -> typer.Exit:
    """What ends the command, after the sentence is said."""
    typer.echo(f"paretour: {sentence}", err=True)
    return typer.Exit(code)


T = TypeVar("T")


def configured(**given: Any) -> Settings:
    """The settings, of which some are given and not None.

    Raises:
        UsageError: one of them is not what it must be.
    """
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        raise UsageError(_explained(error)) from None


def loaded(load: Callable[[Settings], T], settings: Settings) -> T:
    """What is made as the settings say.

    Raises:
        UsageError: the files that they name are not there, or not what they must be.
    """
    try:
        return load(settings)
    except (OSError, ValueError) as error:
        raise UsageError(str(error)) from None


def _explained(error: ValidationError) -> str:
    return "; ".join(
        f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}, got {fault['input']!r}"
        for fault in error.errors()
    )
