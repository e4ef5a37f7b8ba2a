"""The errors that a caller can cause, and the exit codes that the command ends with."""

from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import typer
from paretour import Refused, UnexpectedAnswer

from service.files.reading import UnreadableFile

EXIT_STALLED = 1  # of `paretour work --alive`
EXIT_USAGE = 2
EXIT_UNAVAILABLE = 3
_NOT_THE_REQUEST = (401, 403, 408, 429)  # refusals that another request would meet too


class UsageError(Exception):
    """A mistake of the caller: an option, a request, or a setting."""


@contextmanager
def exit_on_error() -> Iterator[None]:
    """End the command with a sentence and an exit code where the block raises an expected error.

    Raises:
        typer.Exit: In place of the error.
    """
    try:
        yield
    except (UsageError, UnreadableFile) as error:
        raise exit_with(str(error), EXIT_USAGE) from None
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise exit_with(f"{error.filename}: {error.strerror}", EXIT_USAGE) from None
    except Refused as error:
        faulty = 400 <= error.status < 500 and error.status not in _NOT_THE_REQUEST
        raise exit_with(str(error), EXIT_USAGE if faulty else EXIT_UNAVAILABLE) from None
    except UnexpectedAnswer as error:
        raise exit_with(f"the service answers oddly: {error}", EXIT_UNAVAILABLE) from None
    except httpx.TransportError as error:
        raise exit_with(f"the service does not answer: {error}", EXIT_UNAVAILABLE) from None


def exit_with(sentence: str, code: int) -> typer.Exit:
    """Print a sentence on stderr; return the exception that ends the command with a code."""
    typer.echo(f"paretour: {sentence}", err=True)
    return typer.Exit(code)
