"""The interface of routing engines: questions to one, and how its answers are read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Location = tuple[float, float]  # longitude and latitude in degrees, WGS84
Line = Array  # the places along a street, shape (m, 2), longitude first
RouterName = Literal["valhalla", "osrm"]
DEFAULT_PROFILES: Mapping[RouterName, str] = {"valhalla": "auto", "osrm": "driving"}
# The means of transport of vehicles that name one. A program of OSRM knows one alone, whichever it
# is asked for.
KNOWN_PROFILES: Mapping[RouterName, Mapping[str, str]] = {
    "valhalla": {"car": "auto", "truck": "truck", "bicycle": "bicycle", "foot": "pedestrian"},
    "osrm": {},
}


@dataclass(frozen=True, kw_only=True)
class RouterSettings:
    """The routing engine of a service, and the limits of its use.

    Attributes:
        url: Its address, to which the paths of its services are added.
        router: The kind of its interface.
        profile: The means of transport, in the engine's own words.
        profiles: The same, by the profiles that vehicles may name.
        snap: Metres that a stop may lie from a road.
        seconds: The time for all matrices of one request, or all streets of one.
        pairs: The most pairs of stops that the engine answers at once.
        cache_bytes: Bytes of matrices and streets that are remembered.
        cache_seconds: How long these are remembered.
        legs: The most legs of one answer whose streets are asked for.
        positions: The most positions of all lines along streets of one answer.
    """

    url: str
    router: RouterName = "valhalla"
    profile: str = "auto"
    profiles: Mapping[str, str] = field(default_factory=dict)
    snap: float = 250.0
    seconds: float = 20.0
    pairs: int = 2500
    cache_bytes: int = 2**26
    cache_seconds: float = 3600.0
    legs: int = 5000
    positions: int = 2**20


class RouterRequest(NamedTuple):
    """A request to a routing engine: a POST where it has a body of JSON, else a GET.

    `most_bytes` is how long the answer may be.
    """

    path: str
    most_bytes: int
    body: bytes | None = None


class Answer(NamedTuple):
    """The status and the body of an engine's answer: 200, or 400 with an error of its own."""

    status: int
    content: bytes


class Unintelligible(ValueError):
    """An answer that is not as the engine's documentation says; the text says how it differs."""


class NoWay(Exception):
    """The engine knows no way between some of the places asked about, but does not say which."""


class RouterInterface(Protocol):
    """The interface of a routing engine: how to ask, and how to read the answers.

    Readers raise Unintelligible where an answer is not of the documented form.
    """

    @property
    def most_route_stops(self) -> int:
        """The most places that the engine finds a route through at once."""

    def ask_snapped(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question for the roads nearest to places."""

    def read_snapped(self, answer: Answer, places: Sequence[Location]) -> Array:
        """Return the metres from each place to its road, shape (n,); infinity if it has none."""

    def ask_table(self, sources: Sequence[Location], targets: Sequence[Location]) -> RouterRequest:
        """Return the question for the times and distances from each source to each target."""

    def read_table(self, answer: Answer, shape: tuple[int, int]) -> Array:
        """Return seconds and metres, shape (2, sources, targets), infinite where there is none.

        Raises:
            NoWay: The engine refuses the whole table because some pair has no way.
        """

    def ask_route(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question for the way through places in this order."""

    def read_route(self, answer: Answer, legs: int) -> list[Line]:
        """Return the line of each leg of a route.

        Raises:
            NoWay: There is none.
        """
