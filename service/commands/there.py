"""Planning by a service that runs somewhere."""

from typing import cast

from rich.console import Console

from service.client import Client, Front, FrontRequest
from service.commands.reading import Request
from service.commands.watching import watching


def plan_there(client: Client, request: Request, stderr: Console) -> Front:
    """The front that the service finds."""
    # Whatever a file says is sent; the service refuses what it does not know.
    with watching(stderr, request.get("time_limit", 1.0)):
        return client.front(**cast(FrontRequest, request))
