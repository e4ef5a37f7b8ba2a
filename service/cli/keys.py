"""The command that makes API keys."""

import typer

from service.api.auth import KeyHash, new_key
from service.cli.errors import Wrong, explaining


def run_key(caller: str) -> None:
    """Print a new key, and what the settings need to know of it."""
    key, digest = new_key()
    with explaining():
        try:
            KeyHash(caller=caller, digest=digest)
        except ValueError as error:
            raise Wrong(str(error)) from None
    typer.echo(f"{key}\n{caller}:{digest}")
    typer.echo("The key, for its caller alone; then its entry for PARETOUR_API_KEYS.", err=True)
