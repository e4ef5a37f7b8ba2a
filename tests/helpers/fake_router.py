"""A small server that answers as OSRM's documentation says, on a flat island, or worse."""

import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from numpy.typing import NDArray

from tests.helpers.http_handler import serving_handler

Array = NDArray[np.float64]
Location = tuple[float, float]
Reply = tuple[int, bytes, dict[str, str]]
Misbehaviour = Callable[["FakeOsrm", str], Reply | None]

PACES = {"driving": 1, "truck": 2}  # by what the seconds of each profile are multiplied
DEGREE = 100_000.0  # metres of a degree on the island, in both directions
GRID = 0.001  # degrees between two crossings; places are snapped to them
BEYOND = 30.0  # degrees of longitude: no way leads from west of it to east of it, nor back


def snapped(places: Array) -> Array:
    """Return the crossing nearest to each place, shape (n, 2)."""
    return np.round(places / GRID) * GRID


def road_costs(sources: Array, targets: Array) -> Array:
    """Return seconds and metres along the grid, shape (2, sources, targets); NaN: no way.

    Northward takes twice as long as southward, so that the costs are asymmetric.
    """
    east, north = np.moveaxis(snapped(targets) - snapped(sources)[:, np.newaxis], -1, 0) * DEGREE
    metres = np.abs(east) + np.abs(north)
    seconds = (np.abs(east) + np.where(north > 0, 2, 1) * np.abs(north)) / 10
    parted = (sources[:, np.newaxis, 0] > BEYOND) != (targets[:, 0] > BEYOND)
    return np.where(parted, np.nan, np.stack((seconds, metres)).round(1))


@dataclass
class FakeOsrm:
    """What the server has, and what it was asked.

    Attributes:
        misbehave: Called with each path; where it returns a reply, that is sent.
        most_pairs: Of a table, as `--max-table-size` sets it.
        asked: The paths so far.
        most_at_once: The most questions that were answered at the same time.
    """

    url: str = ""
    misbehave: Misbehaviour = lambda *_: None
    most_pairs: int = 2500
    asked: list[str] = field(default_factory=list)
    most_at_once: int = 0
    _at_once: int = 0
    _lock: Any = field(default_factory=threading.Lock)

    def reply(self, path: str) -> Reply:
        """Return the status, the body and the headers of an answer."""
        with self._lock:
            self.asked.append(path)
            self._at_once += 1
            self.most_at_once = max(self.most_at_once, self._at_once)
        try:
            return self.misbehave(self, path) or self.answer(path)
        finally:
            with self._lock:
                self._at_once -= 1

    def answer(self, path: str) -> Reply:
        """Return what OSRM would."""
        split = urlsplit(path)
        _, service, version, profile, coordinates = split.path.split("/")
        assert (version, profile in PACES) == ("v1", True)
        places = np.array([each.split(",") for each in coordinates.split(";")], dtype=np.float64)
        if len(places) < 2:
            return _error("InvalidOptions")
        query = {name: values[0] for name, values in parse_qs(split.query).items()}
        if service == "table":
            return self._table(places, query, PACES[profile])
        return _route(places, query)

    def _table(self, places: Array, query: dict[str, str], pace: float) -> Reply:
        sources, targets = (
            places[[int(index) for index in query[name].split(";")]]
            for name in ("sources", "destinations")
        )
        if len(sources) * len(targets) > self.most_pairs:
            return _error("TooBig")
        document = {
            "code": "Ok",
            "sources": _waypoints(sources),
            "destinations": _waypoints(targets),
        }
        seconds, metres = road_costs(sources, targets)
        tables = {"duration": pace * seconds, "distance": metres}
        for name in query["annotations"].split(","):
            table = tables[name]
            document[f"{name}s"] = np.where(np.isnan(table), None, table).tolist()
        return 200, json.dumps(document).encode(), {}


def _route(places: Array, query: dict[str, str]) -> Reply:
    assert query["geometries"] == "polyline6"
    if len(set(places[:, 0] > BEYOND)) > 1:
        return _error("NoRoute")
    corners = snapped(places)
    legs = [
        {"steps": [_step(one, (two[0], one[1])), _step((two[0], one[1]), two), _step(two, two)]}
        for one, two in zip(corners[:-1].tolist(), corners[1:].tolist(), strict=True)
    ]
    return 200, json.dumps({"code": "Ok", "routes": [{"legs": legs}]}).encode(), {}


def _step(*places: Location) -> dict[str, str]:
    return {"geometry": encode_polyline(list(places))}


def encode_polyline(line: list[Location], precision: int = 6) -> str:
    """Return a line as an encoded polyline."""
    text, before = "", (0, 0)
    for lon, lat in line:
        place = round(lat * 10**precision), round(lon * 10**precision)
        for step in (place[0] - before[0], place[1] - before[1]):
            number = ~(step << 1) if step < 0 else step << 1
            while number >= 32:
                text += chr((number & 31 | 32) + 63)
                number >>= 5
            text += chr(number + 63)
        before = place
    return text


def _waypoints(places: Array) -> list[dict[str, Any]]:
    return [{"name": "", "location": place} for place in snapped(places).tolist()]


def _error(code: str) -> Reply:
    return 400, json.dumps({"code": code, "message": "it is not possible"}).encode(), {}


@contextmanager
def fake_osrm(
    misbehave: Misbehaviour = lambda *_: None, most_pairs: int = 2500
) -> Iterator[FakeOsrm]:
    """Serve on a port of its own until the block ends."""
    fake = FakeOsrm(misbehave=misbehave, most_pairs=most_pairs)
    with serving_handler(_handler_of(fake)) as fake.url:
        yield fake


def _handler_of(fake: FakeOsrm) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            status, body, headers = fake.reply(self.path)
            if status == 0:  # hang up
                self.close_connection = True
                return
            self.send_response(status)
            for name, value in {"Content-Length": str(len(body)), **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            try:
                self.wfile.write(body)
            except OSError:
                self.close_connection = True

        def log_message(self, *_: object) -> None:
            pass

    return Handler


def replying(status: int, body: bytes = b"", **headers: str) -> Misbehaviour:
    """Return a misbehaviour that always replies so."""
    return lambda *_: (status, body, headers)


def without_ways(places: Array, forgotten: NDArray[np.bool_]) -> Misbehaviour:
    """Return a misbehaviour that knows no way from a place (row) to another (column)."""
    names = [f"{lon:.6f},{lat:.6f}" for lon, lat in places]

    def misbehave(fake: FakeOsrm, path: str) -> Reply | None:
        split = urlsplit(path)
        query = {name: values[0] for name, values in parse_qs(split.query).items()}
        if query.get("annotations") != "duration,distance":
            return None
        asked = [names.index(each) for each in split.path.rpartition("/")[2].split(";")]
        sources, targets = (
            [asked[int(index)] for index in query[name].split(";")]
            for name in ("sources", "destinations")
        )
        status, body, headers = fake.answer(path)
        document = json.loads(body)
        unknown = forgotten[np.ix_(sources, targets)]
        for name in ("durations", "distances"):
            document[name] = np.where(unknown, None, np.array(document[name], object)).tolist()
        return status, json.dumps(document).encode(), headers

    return misbehave


def waiting(gate: threading.Event) -> Misbehaviour:
    """Return a misbehaviour that answers nothing until the gate is set."""

    def misbehave(*_: object) -> None:
        gate.wait(60)

    return misbehave


def sleeping(seconds: float) -> Misbehaviour:
    """Return a misbehaviour that delays each answer."""

    def misbehave(*_: object) -> None:
        time.sleep(seconds)

    return misbehave
