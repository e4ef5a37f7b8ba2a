"""Post an event to the webhook of each ended job; after a failure, try again after a pause.

Deliveries wait in the store. A service leases a delivery for longer than an attempt can last, so
two replicas do not post it at the same time. If the service ends during an attempt, the lease ends
too, and the event is posted again. If an answer is lost, the event arrives twice, with the same
`webhook-id`.
"""

import asyncio
import logging
import random
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from http import HTTPStatus
from time import time
from typing import Literal

from pydantic_core import to_json

from service.errors import StoreUnavailable
from service.jobs.cancelling import cancel_all
from service.jobs.outbox import Delivery, Outbox
from service.jobs.record import Status
from service.webhooks.signature import Secret, signed_headers
from service.webhooks.targets import Targets
from service.webhooks.transport import Undeliverable, WebhookTransport

Outcome = Literal["delivered", "failed", "given-up"]
PAUSES = (5.0, 60.0, 300.0, 1800.0, 7200.0)  # seconds before the second attempt, the third, ...
_JITTER = 0.2  # a pause is longer by up to this share, so that attempts do not come all at once
_SECONDS = 15.0  # that an attempt may last
_LEASE = 60.0  # seconds for which a delivery is leased
_AT_ONCE = 64  # attempts: enough that targets without an answer hardly delay the others
_POLL = 0.5  # seconds between two looks for deliveries that are due
_TYPES: Mapping[Status, str] = {
    "done": "front.completed",
    "cancelled": "front.cancelled",
    "failed": "front.failed",
}
_LINE = "webhook of front %s, attempt %d: %s, %s"
_LOG = logging.getLogger("paretour")


@dataclass(frozen=True, kw_only=True)
class Webhooks:
    """The settings of webhooks: allowed targets, secrets and pauses.

    Args:
        targets: The origins to which webhooks may go.
        secrets: The secrets that sign each event.
        observe: Called with the outcome of every attempt.
        pauses: Seconds before the second attempt, the third, and so on. After the last pause and
            one more failure the event is given up.
    """

    targets: Targets
    secrets: Sequence[Secret]
    observe: Callable[[Outcome], None] = lambda _: None
    pauses: Sequence[float] = PAUSES

    @asynccontextmanager
    async def running(self, outbox: Outbox) -> AsyncIterator[None]:
        """Post the deliveries of an outbox while the block runs; its end cancels attempts."""
        sender = _Sender(self, outbox)
        running = asyncio.create_task(sender.run())
        try:
            yield
        finally:
            await cancel_all([running])
            await sender.close()


class _Sender:
    """Takes deliveries from an outbox, and makes at most `_AT_ONCE` attempts at the same time."""

    def __init__(self, webhooks: Webhooks, outbox: Outbox) -> None:
        self._webhooks = webhooks
        self._outbox = outbox
        self._transport = WebhookTransport()
        self._attempts: set[asyncio.Task[None]] = set()

    async def run(self) -> None:
        """Post deliveries that are due, until cancelled."""
        while True:
            try:
                await self._begin()
            except StoreUnavailable:
                pass
            except Exception:
                # Go on: an error that ended the loop would end all deliveries.
                _LOG.exception("deliveries to webhooks could not be begun")
            await asyncio.sleep(_POLL)

    async def close(self) -> None:
        """Cancel the attempts in progress. Once their leases end, they are made again."""
        await cancel_all(self._attempts)
        self._transport.close()

    async def _begin(self) -> None:
        """Begin an attempt for each delivery that is due, as long as fewer than `_AT_ONCE` run."""
        free = _AT_ONCE - len(self._attempts)
        for delivery in await self._outbox.due_deliveries(free, _LEASE) if free else ():
            attempt = asyncio.create_task(self._deliver(delivery))
            self._attempts.add(attempt)
            attempt.add_done_callback(self._attempts.discard)

    async def _deliver(self, delivery: Delivery) -> None:
        """Make one attempt; then remove the delivery, or postpone it for another attempt."""
        failure, final = await self._attempt(delivery)
        pauses = self._webhooks.pauses
        outcome: Outcome = "failed"
        with suppress(StoreUnavailable):  # then it is due again when the lease ends
            if not failure:
                outcome = "delivered"
                await self._outbox.remove_delivery(delivery.id)
            elif final or delivery.attempts > len(pauses):
                outcome = "given-up"
                await self._outbox.remove_delivery(delivery.id)
            else:
                pause = pauses[delivery.attempts - 1] * random.uniform(1, 1 + _JITTER)
                await self._outbox.postpone(delivery.id, pause)
        self._webhooks.observe(outcome)
        level = logging.WARNING if failure else logging.INFO
        _LOG.log(level, _LINE, delivery.id, delivery.attempts, outcome, failure or "it has arrived")

    async def _attempt(self, delivery: Delivery) -> tuple[str, bool]:
        """Post a delivery.

        Returns:
            Why the attempt failed, or "" if it did not; and whether further attempts are useless.
        """
        try:
            destination = self._webhooks.targets.find(delivery.webhook.url)
        except ValueError:
            destination = None
        if destination is None:
            return "the settings no longer allow its target", True
        body = _body(delivery)
        message = f"msg_{delivery.id}"
        headers = signed_headers(message, int(time()), body, self._webhooks.secrets)
        try:
            async with asyncio.timeout(_SECONDS):
                status = await self._transport.post(destination, headers, body)
        except TimeoutError:
            return f"it does not answer within {_SECONDS:g} s", False
        except Undeliverable as error:
            return str(error), False
        failed = not HTTPStatus(200) <= status < HTTPStatus(300)
        return f"its answer is {status}" if failed else "", status == HTTPStatus.GONE


def _body(delivery: Delivery) -> bytes:
    """Return the event of a delivery as JSON. It is the same in every attempt."""
    ended = datetime.fromtimestamp(delivery.ended_at, UTC)
    event = {
        "type": _TYPES[delivery.status],
        "timestamp": ended.isoformat(timespec="milliseconds").replace("+00:00", "Z"),
        "data": {
            "id": delivery.id,
            "status": delivery.status,
            "url": delivery.webhook.location,
        },
    }
    return to_json(event)
