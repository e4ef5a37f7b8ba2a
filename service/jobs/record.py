"""A front that is kept under an id, from the moment it is asked for."""

from dataclasses import dataclass
from typing import Any, Literal

from service.jobs.front_document import Rendered
from service.jobs.messages import Work

Status = Literal["queued", "running", "done", "cancelled", "failed"]
UNFINISHED: tuple[Status, ...] = ("queued", "running")


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Whose front it is, how it stands, and what was found so far.

    The work is kept for as long as it is not finished. Where the caller gave an idempotency key,
    the digest tells one body from another. A failed one has a problem document.
    """

    id: str
    caller: str
    request_id: str
    status: Status
    front: Rendered
    work: Work | None = None
    key: str | None = None
    digest: str = ""
    problem: dict[str, Any] | None = None

    @property
    def finished(self) -> bool:
        """Whether nothing about it will change."""
        return self.status not in UNFINISHED

    def json(self) -> bytes:
        """A FrontAnswer."""
        more = {"problem": self.problem} if self.problem else {}
        return self.front.json(id=self.id, status=self.status, **more)
