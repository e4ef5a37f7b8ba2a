"""Plan for the command: in this process, or by a service at a URL, with progress on a console.

Ctrl-C ends a search early: the front is then the best so far.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING

import httpx
from paretour import Actor, Client, FrontOfAnyKind, Job, Offers, OffersRequest, Plan, Refused
from paretour.calls import address_of
from rich.console import Console

from service.cli.errors import UsageError
from service.cli.options import Service
from service.cli.progress import ConsoleDisplay, progress_bar

if TYPE_CHECKING:
    from service.actor_info import ActorInfo
    from service.settings import Settings


@dataclass(frozen=True)
class RemoteBackend:
    """A service at a URL, which plans as a job."""

    url: str
    api_key: str | None

    def front(self, plan: Plan, console: Console) -> FrontOfAnyKind:
        """Plan a front of any kind.

        Raises:
            Refused: The service does not plan it.
            KeyboardInterrupt: Ctrl-C was pressed before there was a front.
        """
        with self._client() as client:
            return _result(client.any_job(client.post(plan).id), plan, console)

    def stored(self, front: str) -> FrontOfAnyKind:
        """Return a front of any kind by its id, as it is now.

        Raises:
            Refused: The service does not have it.
        """
        with self._client() as client:
            return client.any_job(front).front()

    def offers(self, front: str, request: OffersRequest) -> Offers:
        """Return in which slots an order can be promised, beside a front's plan that is driven.

        Raises:
            Refused: The service makes no such offers.
        """
        with self._client() as client:
            return client.offers(front, **request)

    def actors(self) -> tuple[Actor, ...]:
        """Return the actors that the service has loaded."""
        with self._client() as client:
            return client.actors()

    def _client(self) -> Client:
        return Client(with_scheme(self.url), api_key=self.api_key)


class LocalBackend:
    """This process.

    The service's own modules are imported where they are needed. They take a second and load the
    compiler, and a command with an error or with a URL need not wait for that.
    """

    def front(self, plan: Plan, console: Console) -> FrontOfAnyKind:
        """Plan a front of any kind, and answer as the service does.

        Raises:
            UsageError: The request cannot be planned.
            Refused: A routing engine is needed, and fails.
            KeyboardInterrupt: Ctrl-C was pressed before there was a front.
        """
        from service.cli.configuration import load_settings, load_with
        from service.library.local_planner import load_planner

        planner = load_with(load_planner, load_settings())
        try:
            return planner.plan(plan, ConsoleDisplay(console)).front()
        except Refused as error:
            if error.status >= HTTPStatus.INTERNAL_SERVER_ERROR:
                raise
            raise UsageError(error.detail, error.remedies) from None

    def actors(self) -> tuple[Actor, ...]:
        """Return the actors and the constructors that the settings name."""
        from service.actor import load_actors
        from service.cli.configuration import load_settings, load_with
        from service.extensions.constructors import constructor_infos

        def known(settings: "Settings") -> Mapping[str, "ActorInfo"]:
            loaded = load_actors(settings.actors, settings.threads, settings.own_actors)
            infos = {name: actor.info for name, actor in loaded.items()}
            return {**infos, **constructor_infos(settings.constructors, infos)}

        infos = load_with(known, load_settings())
        return tuple(Actor(**asdict(infos[name])) for name in sorted(infos))


Backend = LocalBackend | RemoteBackend


def backend_for(service: Service) -> Backend:
    """Return a service as a backend, or without a URL this process."""
    return LocalBackend() if service.url is None else RemoteBackend(service.url, service.api_key)


def _result(job: Job[FrontOfAnyKind], plan: Plan, console: Console) -> FrontOfAnyKind:
    """Return the front of a job, with progress until it ends; at Ctrl-C the best so far.

    Raises:
        Refused: The job failed.
        KeyboardInterrupt: Ctrl-C was pressed before there was a front.
    """
    try:
        with progress_bar(console, plan.seconds) as show:
            for progress in job.progress():
                show(progress)
        return job.result()
    except KeyboardInterrupt:
        front = job.cancel()
        if not len(front.lengths):
            raise
        return front


def with_scheme(url: str) -> str:
    """Return a URL, whose scheme is http where it has none, as localhost:8000.

    Raises:
        UsageError: It is not the URL of a service.
    """
    whole = address_of(url)
    try:
        parsed = httpx.URL(whole)
    except httpx.InvalidURL as error:
        raise UsageError(f"--url must be a URL, as localhost:8000, got {url!r}: {error}") from None
    if parsed.scheme not in ("http", "https") or not parsed.host:
        raise UsageError(f"--url must be a URL, as localhost:8000, got {url!r}")
    return whole
