"""Planning by a service that runs somewhere."""

from paretour import Client, Front, Plan
from rich.console import Console

from service.cli.progress import watching


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
