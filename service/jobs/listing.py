"""Describe stored fronts for a list: what is known of each, without its tours."""

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Self

from service.jobs.record import Status
from service.kinds.front_document import FrontDocument
from service.requests.task import KindName


@dataclass(frozen=True, kw_only=True)
class ListedFront:
    """A front in a list.

    Attributes:
        number: Grows with each front that is stored. A page begins below a number.
        stored_at: When the front was submitted or, once it is finished, when it was finished.
        objectives: Name and unit of each, where the caller named them.
    """

    number: int
    stored_at: datetime
    id: str
    status: Status
    kind: KindName
    cities: int
    points: int
    hypervolume: float
    objectives: list[dict[str, Any]] | None

    @classmethod
    def of(
        cls,
        front: FrontDocument,
        *,
        number: int,
        stored_at: float,
        id: str,  # noqa: A002
        status: Status,
    ) -> Self:
        """Return what a list says of a front that was stored at a time, in seconds since 1970."""
        return cls(
            number=number,
            stored_at=datetime.fromtimestamp(stored_at, UTC),
            id=id,
            status=status,
            kind=front.kind,
            cities=front.cities,
            points=front.points,
            hypervolume=front.hypervolume,
            objectives=front.objectives,
        )

    def document(self) -> dict[str, Any]:
        """Return the front's item in a list, ready for JSON."""
        named = {} if self.objectives is None else {"objectives": self.objectives}
        return {
            "id": self.id,
            "status": self.status,
            "kind": self.kind,
            "stored_at": self.stored_at.isoformat(timespec="seconds").replace("+00:00", "Z"),
            "cities": self.cities,
            "points": self.points,
            "hypervolume": self.hypervolume,
            **named,
        }
