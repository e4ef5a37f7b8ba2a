"""Where fronts are kept for later questions, bounded in number and age, each caller's apart."""

from typing import Protocol

from service.jobs.record import Record


class Unknown(LookupError):
    """The caller never had anything under this id, or so long ago that it is forgotten."""


class Expired(LookupError):
    """What the caller had under this id has made way: it was too old, or the store was full."""


class Mismatch(Exception):
    """The caller has used this idempotency key for another body."""


class Unavailable(Exception):
    """What the records are kept in does not answer."""


class Store(Protocol):
    """Keeps records. What is not finished never makes way."""

    async def put(self, record: Record) -> None:
        """Keep a record, in place of an earlier one with its id."""

    async def admit(self, record: Record) -> Record:
        """Keep a new record, or give the one that the caller has already under its key.

        One that failed gives up its key, so that a repeat is a new try.

        Raises:
            Mismatch: that one is of another body.
        """

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """The caller's record with this id.

        Raises:
            Unknown: there was none.
            Expired: it has made way.
        """

    async def latest(self, caller: str) -> Record:
        """The caller's record that was finished last.

        Raises:
            Unknown: there never was one.
            Expired: it has made way.
        """

    async def forget(self, record: Record) -> None:
        """Keep the record no longer, and nothing in its place."""

    async def unfinished(self) -> list[Record]:
        """All records that still need work, the oldest first."""

    async def close(self) -> None:
        """Let go of what the store is kept in."""
