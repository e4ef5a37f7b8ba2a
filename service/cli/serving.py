"""The command that serves."""

from service.cli.configured import configured, loaded
from service.cli.errors import explaining
from service.server import build, serve


def run_serve(host: str | None, port: int | None, workers: int | None) -> None:
    """Answer requests until told to stop. What is None is left to the settings."""
    with explaining():
        settings = configured(host=host, port=port, workers=workers)
        app = loaded(build, settings)
    serve(app, settings)
