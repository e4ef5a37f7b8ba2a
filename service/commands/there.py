"""Planning by a service that runs somewhere."""

from rich.console import Console

from service.client import Client, Front, Plan
from service.commands.watching import watching


def plan_there(client: Client, plan: Plan, stderr: Console) -> Front:
    """The front that the service finds, or had found when Ctrl-C was pressed."""
    job = client.post(plan)
    try:
        with watching(stderr, plan) as tell:
            for progress in job.progress():
                tell(progress)
        return job.result()
    except KeyboardInterrupt:
        found = job.cancel()
        if not len(found.tours):
            raise
        return found
