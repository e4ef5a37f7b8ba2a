"""Serve an agent over stdin and stdout: plan in this process, or by a service at a URL."""

from functools import partial

from service import installed_version
from service.cli.backends import with_scheme
from service.cli.configuration import load_settings, load_with
from service.cli.errors import UsageError
from service.cli.options import Service
from service.mcp import check_mcp


def serve_agent(service: Service) -> None:
    """Serve until stdin ends.

    Raises:
        UsageError: The extra is not installed, or the URL or a setting is wrong.
    """
    try:
        check_mcp()
    except ValueError as error:
        raise UsageError(str(error)) from None
    from service.mcp.stdio import serve_of_app, serve_of_service

    if service.url is not None:
        return serve_of_service(with_scheme(service.url), service.api_key, installed_version())
    from service import server

    # Whoever starts this process may use it, and it keeps fronts for itself.
    settings = load_settings(api_keys=(), store=":memory:", mcp=False)
    app = load_with(partial(server.build, ending=server.Ending()), settings)
    return serve_of_app(app, installed_version())
