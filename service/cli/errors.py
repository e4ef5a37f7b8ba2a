"""End the command with a sentence and an exit code when an expected error is raised."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import httpx
import typer
from paretour import Refused, Remedy, UnexpectedAnswer
from paretour.remedies import in_words

from service.errors.printable import printable
from service.files.reading import UnreadableFile

EXIT_STALLED = 1  # if `paretour work --alive` finds no working worker
EXIT_USAGE = 2
EXIT_UNAVAILABLE = 3
_NOT_THE_REQUEST = (401, 403, 408, 429)  # errors that any other request would get, too


class UsageError(Exception):
    """A mistake of the caller, in an option, a request or a setting, and what helps."""

    def __init__(self, sentence: str, remedies: Sequence[Remedy] = ()) -> None:
        super().__init__(sentence)
        self.remedies = remedies


@contextmanager
def exit_on_error() -> Iterator[None]:
    """End the command with a sentence and an exit code if the block raises an expected error.

    Raises:
        typer.Exit: In place of the error.
    """
    try:
        yield
    except UsageError as error:
        raise exit_with(str(error), EXIT_USAGE, error.remedies) from None
    except UnreadableFile as error:
        raise exit_with(str(error), EXIT_USAGE) from None
    except OSError as error:
        if error.filename is None:  # not about a file
            raise
        raise exit_with(f"{error.filename}: {error.strerror}", EXIT_USAGE) from None
    except Refused as error:
        faulty = 400 <= error.status < 500 and error.status not in _NOT_THE_REQUEST
        code = EXIT_USAGE if faulty else EXIT_UNAVAILABLE
        raise exit_with(str(error), code, error.remedies) from None
    except UnexpectedAnswer as error:
        raise exit_with(f"the service's answer is wrong: {error}", EXIT_UNAVAILABLE) from None
    except httpx.TransportError as error:
        raise exit_with(f"the service does not answer: {error}", EXIT_UNAVAILABLE) from None


def exit_with(sentence: str, code: int, remedies: Sequence[Remedy] = ()) -> typer.Exit:
    """Print a sentence on stderr, and what helps; return the exception that ends the command."""
    typer.echo(f"paretour: {printable(sentence)}", err=True)
    for line in in_words(remedies):
        typer.echo(printable(line), err=True)
    return typer.Exit(code)
