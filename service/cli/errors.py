"""How the command ends when it cannot do what was asked: a sentence on stderr and a code.

0 is a front, also where Ctrl-C ended its search; 2 what the caller can put right: the command, its
files, the request; 3 a service that cannot be reached, lets nobody in, or fails; 130 Ctrl-C before
there was a front.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import typer
from paretour import Refused

from service.cli.tsplib import NotRead

WRONG = 2
UNAVAILABLE = 3
_NOT_THE_REQUEST = (401, 403, 408, 429)


class Wrong(Exception):
    """What the caller can put right."""


@contextmanager
def explaining() -> Iterator[None]:
    """Ends the command where something in the block went as wrong as may be expected."""
    try:
        yield
    except (Wrong, NotRead) as error:
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
