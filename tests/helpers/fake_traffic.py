"""A small server that answers as a Valhalla with historical traffic, on the fake OSRM's island."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler
from typing import Any

import numpy as np

from tests.helpers.fake_router import Array, road_costs, snapped
from tests.helpers.http_handler import serving_handler

RUSH = range(7, 9)  # hours of the day
SLOWER = 1.8  # in these hours


def seconds_at(places: Array, departure: str) -> Array:
    """Return the seconds between places at a time, as 2026-11-27T07:30, shape (n, n)."""
    hour = int(departure[11:13])
    return road_costs(places, places)[0] * (SLOWER if hour in RUSH else 1.0)


@dataclass
class FakeTraffic:
    """What the server was asked: the body of each question for a table."""

    url: str = ""
    asked: list[dict[str, Any]] = field(default_factory=list)

    def answer(self, path: str, body: dict[str, Any]) -> object:
        """Return what Valhalla would."""
        if path == "/locate":
            return [{"edges": [_edge(place)]} for place in snapped(_places(body["locations"]))]
        assert path == "/sources_to_targets", path
        self.asked.append(body)
        seconds, metres = road_costs(_places(body["sources"]), _places(body["targets"]))
        if "date_time" in body:
            assert body["date_time"]["type"] == 1
            seconds *= SLOWER if int(body["date_time"]["value"][11:13]) in RUSH else 1.0
        tables = {"durations": seconds.tolist(), "distances": (metres / 1000).tolist()}
        return {"sources_to_targets": tables, "units": "kilometers"}


def _places(locations: list[dict[str, float]]) -> Array:
    return np.array([(each["lon"], each["lat"]) for each in locations])


def _edge(place: Array) -> dict[str, float]:
    return {"correlated_lon": place[0], "correlated_lat": place[1]}


@contextmanager
def fake_traffic() -> Iterator[FakeTraffic]:
    """Serve on a port of its own until the block ends."""
    fake = FakeTraffic()

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            answer = json.dumps(fake.answer(self.path, body)).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(answer)))
            self.end_headers()
            self.wfile.write(answer)

        def log_message(self, *_: object) -> None:
            pass

    with serving_handler(Handler) as fake.url:
        yield fake
