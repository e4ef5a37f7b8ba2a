"""The settings of the service and of its workers, from environment variables.

Nothing else in the service reads the environment. The documentation lists every description.
"""

import os
import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

from limits import parse
from pydantic import AfterValidator, BeforeValidator, Field
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from service.actor_info import RELEASED
from service.api.auth import KeyHash
from service.api.site.tiles import checked_template
from service.jobs.store import STORE_BYTES
from service.requests.limits import Limits
from service.roads.router import DEFAULT_PROFILES, RouterName, RouterSettings


def _cores() -> int:
    return min(len(os.sched_getaffinity(0)), 4)


def _split(value: object) -> object:
    return [word.strip() for word in value.split(",") if word] if isinstance(value, str) else value


def _checked_redis_url(value: str) -> str:
    try:
        parts = urlsplit(value)
        named = parts.scheme in ("redis", "rediss") and parts.hostname and parts.port != 0
    except ValueError:  # of the port
        named = False
    if not named:
        raise ValueError("must be redis://HOST:PORT/NUMBER, or rediss:// for TLS")
    return value


def _key_hash(value: object) -> object:
    return KeyHash.read(value) if isinstance(value, str) else value


def _checked_rate(value: str) -> str:
    parse(value)
    return value


def _checked_address(value: str) -> str:
    """Return an http or https URL of a server, maybe with a path, to which more is added."""
    parts = urlsplit(value)
    whole = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    if not whole or parts.query or parts.fragment or not value.isascii() or " " in value:
        raise ValueError("must be like http://valhalla:8002")
    return value


def _checked_network_cities(cities: int) -> int:
    if cities > _MOST_NETWORK_CITIES:
        raise ValueError(
            f"must be at most {_MOST_NETWORK_CITIES}: networks number pairs of cities in 32 bits"
        )
    return cities


Words = Annotated[tuple[str, ...], NoDecode, BeforeValidator(_split)]
KeyHashes = Annotated[
    tuple[Annotated[KeyHash, BeforeValidator(_key_hash)], ...], NoDecode, BeforeValidator(_split)
]
RedisUrl = Annotated[str, AfterValidator(_checked_redis_url)]
Rate = Annotated[str, AfterValidator(_checked_rate)]
NetworkCities = Annotated[int, AfterValidator(_checked_network_cities)]
Address = Annotated[str, AfterValidator(_checked_address)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,50}$")]


class Settings(BaseSettings):
    """All settings; a variable is PARETOUR_ and the field's name in capitals, or its alias."""

    model_config = SettingsConfigDict(env_prefix="PARETOUR_", frozen=True)

    # The address, and the processes that plan.
    host: str = Field("127.0.0.1", description="address to listen on")
    port: int = Field(8000, ge=0, le=65535, description="port to listen on; 0 takes a free one")
    actors: Path = Field(RELEASED, description="directory of the networks, ONNX files")
    own_actors: Path | None = Field(
        None, description="directory of more networks, which are served beside those"
    )
    workers: int = Field(
        default_factory=_cores, ge=1, description="processes that plan, one request at a time each"
    )
    threads: int = Field(1, ge=1, description="threads of one inference call")
    queue: int = Field(16, ge=0, description="requests that may wait for a worker")
    caller_share: float = Field(
        0.5, gt=0, le=1, description="share of workers, queue and bodies that one caller may fill"
    )

    # Connections.
    connections: int = Field(
        1000, ge=1, description="open connections; fewer where descriptors (`ulimit -n`) are few"
    )
    connection_share: float = Field(
        0.25, gt=0, le=1, description="share of these that one address may hold, but for proxies"
    )
    head_seconds: float = Field(
        10.0, gt=0, description="how long a request's head may take, and a connection be silent"
    )

    forwarded_allow_ips: str = Field(
        "127.0.0.1",
        validation_alias="FORWARDED_ALLOW_IPS",
        description="proxies whose X-Forwarded-For is believed, with commas between; or *",
    )

    # Map tiles under the stops on the page, which browsers load from there.
    tiles: Annotated[str, AfterValidator(checked_template)] | None = Field(
        None, description="address of map tiles with {z}, {x}, {y}; none draws no streets"
    )
    tiles_credit: str = Field("© OpenStreetMap contributors", description="whom the tiles are by")

    # Limits of a request.
    max_body_bytes: int = Field(2**24, ge=1, description="the longest request body")
    bodies_bytes: int = Field(
        2**27,
        ge=2**20,
        description="bytes of all bodies of requests under way, and of answers",
    )
    parse_seconds: float = Field(20.0, gt=0, description="how long a body may take to parse")
    parse_bytes: int = Field(
        2**29 + 2**28, ge=2**26, description="memory that parsing a body may take"
    )
    max_cities: int = Field(10_000, ge=1, description="the most cities of an instance")
    max_matrix_cities: int = Field(1000, ge=1, description="the most where costs are matrices")
    max_network_cities: NetworkCities = Field(
        5000, ge=1, description="the most in tours of a network"
    )
    max_fleet_stops: int = Field(
        500, ge=1, description="the most stops of a fleet, and places that robots share"
    )
    max_cells: int = Field(2**20, ge=1, description="the most cells of a map")
    max_path_cells: int = Field(2**21, ge=1, description="the most cells, or stops, of an answer")
    max_preferences: int = Field(200, ge=1, description="the most preferences of a request")
    max_repairs: int = Field(200, ge=0, description="the most repairs of the network's tours")
    max_size: int = Field(1000, ge=1, description="the most tours that a request may ask for")
    max_time_limit: float = Field(60.0, ge=0, description="the most seconds of planning")

    # Deadlines.
    request_seconds: float = Field(
        90.0, gt=0, description="when a request is ended with the best front so far"
    )
    drain_seconds: int = Field(20, ge=0, description="time to finish what is under way at SIGTERM")
    body_seconds: float = Field(30.0, gt=0, description="how long a body may take to arrive")

    # The store of fronts and jobs.
    store: str = Field(
        ":memory:", description="file of fronts and jobs, which then outlive the service"
    )
    store_entries: int = Field(
        256, ge=1, description="fronts kept for later questions; callers with most make way"
    )
    store_bytes: int = Field(
        STORE_BYTES, ge=1, description="the most bytes of those; callers with most make way"
    )
    store_seconds: float = Field(3600.0, gt=0, description="how long a front is kept")
    redis_url: RedisUrl | None = Field(
        None,
        description="Redis of all replicas: rates, fronts and jobs, which `paretour work` plans",
    )

    # The routing engine.
    router_url: Address | None = Field(
        None, description="routing engine that knows costs by road; none refuses these"
    )
    router: RouterName = Field("valhalla", description="whose interface that has, valhalla or osrm")
    router_profile: Name | None = Field(
        None,
        description="its means of transport; by default auto for valhalla and driving for osrm",
    )
    router_snap: float = Field(
        250.0, gt=0, le=10_000, description="metres that a stop may lie from a road"
    )
    router_seconds: float = Field(
        20.0,
        gt=0,
        description="how long it may take for the costs of a request, or its streets",
    )
    router_pairs: int = Field(
        2500, ge=1, le=10_000, description="the most pairs of stops that it is asked about at once"
    )
    router_cache_bytes: int = Field(
        2**26,
        ge=0,
        description="bytes of costs and streets that are remembered, so that it is asked once",
    )
    router_cache_seconds: float = Field(
        3600.0, gt=0, description="how long costs and streets are remembered"
    )
    router_legs: int = Field(
        5000, ge=1, description="the most ways from stop to stop whose streets an answer draws"
    )
    router_positions: int = Field(
        2**20, ge=2, description="the most positions of all lines along streets of an answer"
    )

    # Access.
    api_keys: KeyHashes = Field(
        (), description="who may call, as CALLER:HASH with commas between; none lets everybody in"
    )
    rate: Rate = Field(
        "1000/minute", description="requests that each key may make; without keys, each address"
    )
    origins: Words = Field(
        (), description="origins whose pages may call (CORS), with commas between; or *"
    )

    # Observation.
    traces: str | None = Field(
        None,
        validation_alias="OTEL_EXPORTER_OTLP_ENDPOINT",
        description="where OpenTelemetry traces go, over HTTP",
    )

    @property
    def roads(self) -> RouterSettings | None:
        """The routing engine, if there is one."""
        if self.router_url is None:
            return None
        return RouterSettings(
            url=self.router_url,
            router=self.router,
            profile=self.router_profile or DEFAULT_PROFILES[self.router],
            snap=self.router_snap,
            # So that a slow engine is named as the cause, before the request is overdue.
            seconds=min(self.router_seconds, _ROUTER_SHARE * self.request_seconds),
            pairs=self.router_pairs,
            cache_bytes=self.router_cache_bytes,
            cache_seconds=self.router_cache_seconds,
            legs=self.router_legs,
            positions=self.router_positions,
        )

    @property
    def limits(self) -> Limits:
        """The limits of a request."""
        return Limits(
            body_bytes=self.max_body_bytes,
            cities=self.max_cities,
            matrix_cities=self.max_matrix_cities,
            network_cities=self.max_network_cities,
            fleet_stops=self.max_fleet_stops,
            cells=self.max_cells,
            path_cells=self.max_path_cells,
            preferences=self.max_preferences,
            repairs=self.max_repairs,
            size=self.max_size,
            seconds=self.max_time_limit,
            roads=self.router_url is not None,
        )


PREFIX = "PARETOUR_"
_MOST_NETWORK_CITIES = 46_000
_ROUTER_SHARE = 0.9  # of a request's seconds that its costs by road may take
# Of the command line, and what Kubernetes and Docker set for services beside ours.
_OTHERS = re.compile(
    r"PARETOUR_(API_KEY|(\w+_)?SERVICE_(HOST|PORT(_\w+)?)|(\w+_)?PORT_\d+_(TCP|UDP|SCTP)(_\w+)?)"
)
_LINK = re.compile(r"(tcp|udp|sctp)://")


def variable_of(name: str) -> str:
    """Return the environment variable of a field, or the alias that it is."""
    return f"{PREFIX}{name.upper()}" if name in Settings.model_fields else name


def unknown_variables(environment: Mapping[str, str]) -> Iterable[str]:
    """Yield a sentence for each variable that begins as a setting and is none."""
    known = {variable_of(name) for name in Settings.model_fields}
    for name, value in sorted(environment.items()):
        upper = name.upper()
        if not upper.startswith(PREFIX) or upper in known or _OTHERS.fullmatch(upper):
            continue
        if upper.endswith("_PORT") and _LINK.match(value):
            continue
        nearest = get_close_matches(upper, known, 1)
        yield f"{name} is no setting" + (f"; did you mean {nearest[0]}?" if nearest else "")
