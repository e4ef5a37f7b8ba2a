"""Planning by a service that runs somewhere."""

from rich.console import Console

from service.client import Client, Front, Plan
from service.commands.watching import watching


def plan_there(client: Client, plan: Plan, stderr: Console) -> Front:
    """The front that the service finds."""
    with watching(stderr, plan):
        return client.plan(plan)
