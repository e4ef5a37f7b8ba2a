"""Describe deliveries to webhooks, and the interface of stores that keep them until made."""

from dataclasses import dataclass
from typing import Protocol, Self, cast, get_args

from service.jobs.record import UNFINISHED, Status
from service.jobs.webhook import Webhook

MOST_DELIVERIES = 10_000  # that are kept; beyond that those due last are given up


@dataclass(frozen=True, kw_only=True)
class Delivery:
    """The end of a job, which is to be posted to its webhook.

    Attributes:
        id: The job's id.
        status: The status with which the job ended.
        ended_at: When it ended, in seconds since 1970.
        attempts: How often it was tried, this time included.
    """

    id: str
    webhook: Webhook
    status: Status
    ended_at: float
    attempts: int

    @classmethod
    def read(cls, id: str, webhook: str, status: str, ended: str, attempts: str) -> Self:
        """Return the delivery with these values, as stores keep them.

        Raises:
            ValueError: They are damaged.
        """
        if status not in _FINISHED:
            raise ValueError(f"status is {status!r}")
        return cls(
            id=id,
            webhook=Webhook.read(webhook),
            status=cast(Status, status),
            ended_at=float(ended),
            attempts=int(attempts),
        )


_FINISHED = frozenset(get_args(Status)) - set(UNFINISHED)


class Outbox(Protocol):
    """Keeps the deliveries of jobs that have ended and had a webhook.

    A delivery is stored together with the end of its job, so it outlives the process where fronts
    do. A service that takes a delivery has it alone for a while. If it is not removed by then, it
    is due again.
    """

    async def due_deliveries(self, most: int, seconds: float) -> list[Delivery]:
        """Take deliveries that are due.

        Args:
            seconds: The time after which they are due again.

        Raises:
            StoreUnavailable: The store does not answer.
        """

    async def postpone(self, id: str, seconds: float) -> None:
        """Have the delivery of a job tried again after some seconds."""

    async def remove_delivery(self, id: str) -> None:
        """Remove the delivery of a job: it was made, or is given up."""
