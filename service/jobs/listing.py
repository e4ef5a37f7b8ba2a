"""Describe stored fronts for a list: what is known of each, without its tours."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from service.jobs.record import Status
from service.kinds.front_document import FrontDocument


@dataclass(frozen=True, kw_only=True)
class ListedFront:
    """A front in a list.

    Attributes:
        number: Grows with each front that is stored. A page begins below a number.
        stored_at: When the front was submitted or, once it is finished, when it was finished.
        front: The front, maybe without its tours.
    """

    number: int
    stored_at: datetime
    id: str
    status: Status
    front: FrontDocument

    def document(self) -> dict[str, Any]:
        """Return the front's item in a list, ready for JSON."""
        front = self.front
        named = {} if front.objectives is None else {"objectives": front.objectives}
        return {
            "id": self.id,
            "status": self.status,
            "kind": front.kind,
            "stored_at": self.stored_at.isoformat(timespec="seconds").replace("+00:00", "Z"),
            "cities": front.cities,
            "points": front.points,
            "hypervolume": front.hypervolume,
            **named,
        }
