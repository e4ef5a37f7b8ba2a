"""Describe the webhook of a job, in the form in which stores keep it."""

import json
from dataclasses import asdict, dataclass
from typing import Self


@dataclass(frozen=True)
class Webhook:
    """The URL that is told when a job has ended, and the path of its front for that receiver."""

    url: str
    location: str

    def json(self) -> str:
        """Return the webhook as JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def read(cls, text: str) -> Self:
        """Return the webhook in JSON.

        Raises:
            ValueError: It is damaged.
        """
        members = json.loads(text)
        if not isinstance(members, dict) or members.keys() != {"url", "location"}:
            raise ValueError("a webhook must have url and location")
        return cls(**{name: str(value) for name, value in members.items()})
