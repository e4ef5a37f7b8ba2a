"""The networks that a service has loaded."""

from dataclasses import dataclass
from typing import Any

from paretour.expect import value_of


@dataclass(frozen=True, kw_only=True)
class Actor:
    """A network that the service has loaded.

    Attributes:
        name: The name to choose it by.
        digest: The SHA-256 of its file.
        inputs: The kind of instance that it reads: `coordinates` or `matrices`.
        commit: The commit of the source that exported it.
        sizes: The smallest and largest number of cities that it was trained on.
        angles: The least and the greatest angle that it was trained on, in degrees.
        config: The configuration of its training.
        figures: Its hypervolumes, measured at export.
        repairs: Whether it can repair its tours.
        most_objectives: The most objectives that it takes.
    """

    name: str
    digest: str
    inputs: str
    commit: str
    sizes: Any
    angles: Any
    config: Any
    figures: Any
    repairs: bool = False
    most_objectives: int = 2


parse_actor = value_of(Actor)
