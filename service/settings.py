"""The settings of the service and of its workers, from environment variables.

Nothing else in the service reads the environment. The guide lists every setting.
"""

import math
import os
import re
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Annotated, TypeAlias, TypeVar
from urllib.parse import urlsplit

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from service.actor_info import RELEASED
from service.api.keys import KeyHash
from service.api.transport.root_path import is_root_path
from service.extensions.names import Extensions
from service.jobs.store import STORE_BYTES
from service.requests.limits import Limits
from service.roads.router import DEFAULT_PROFILES, KNOWN_PROFILES, RouterName, RouterSettings
from service.webhooks.signature import Secret
from service.webhooks.targets import Target, Targets

_WEEK = 7 * 86_400  # seconds; timers that count milliseconds in 32 bits end after 24 days
_YEAR = 366 * 86_400  # seconds
_MOST_BYTES = 2**40  # in 64 bits, with which the system and SQLite count, even when added up
_MOST_BODY_BYTES = 2**28  # one value of Redis has at most 2**29 bytes, one of SQLite 10**9
_MOST_PROCESSES = 1024  # and threads
_MOST_WAITING = 100_000
_MOST_CONNECTIONS = 2**20  # the most descriptors that Linux lets a process open by default
_MOST_REQUESTS = 1_000_000  # of one caller: the time of each is remembered
_MOST_CITIES = 1_000_000  # the search's arrays of a row for each city take gigabytes
_MOST_PAIRED_CITIES = 46_000  # their pairs are numbered in 32 bits
_MOST_FLEET_STOPS = 10_000  # to read the legs between all of them takes seconds
_MOST_BREAKPOINTS = 2**26  # of 16 bytes, and 200 while they are parsed
_MOST_CELLS = 2**28  # the paths over them number three times as many in 32 bits
_MOST_PATH_CELLS = 2**23  # of up to 40 bytes each, which are stored as one value
_MOST_TOURS = 10_000  # choosing these from the search's 50,000 takes 2 GB
_MOST_ENTRIES = 1_000_000
_LEAST = 0.001  # of shares, seconds and metres
# No spaces, commas or semicolons: the server's name becomes part of a header.
_TILES = re.compile(r"https?://[A-Za-z0-9.{}:-]+/[A-Za-z0-9_.~/{}?&=%@+-]*")
_PARTS_OF_TILES = ("{z}", "{x}", "{y}")
Each = TypeVar("Each")


def _cores() -> int:
    return min(len(os.sched_getaffinity(0)), 4)


def _split(value: str) -> list[str]:
    return [word.strip() for word in value.split(",") if word]


def _pair(value: str) -> tuple[str, ...]:
    return value.partition(":")[::2]


def _as(read: Callable[[str], object]) -> BeforeValidator:
    """Return what reads a text of the environment, and takes a value as it is."""
    return BeforeValidator(lambda value: read(value) if isinstance(value, str) else value)


def _names_server(value: str, *schemes: str) -> bool:
    try:
        parts = urlsplit(value)
        return parts.scheme in schemes and bool(parts.hostname) and parts.port != 0
    except ValueError:  # the port is not a number
        return False


def _checked_redis_url(value: str) -> str:
    if not _names_server(value, "redis", "rediss"):
        raise ValueError("must be redis://HOST:PORT/NUMBER, or rediss:// for TLS")
    return value


def _checked_rate(value: str) -> str:
    from limits import parse  # imported late: it takes 0.1 s, and few set a rate

    try:
        rate = parse(value)
    except ValueError:
        rate = None
    if rate is None or not (1 <= rate.amount <= _MOST_REQUESTS and 1 <= rate.get_expiry() <= _YEAR):
        demand = f"with 1 to {_MOST_REQUESTS} requests in a second, or longer, up to a year"
        raise ValueError(f"must be like 1000/minute, {demand}")
    return value


def _checked_address(value: str) -> str:
    """Return an http or https URL of a server, which may end in a path."""
    wrong = not value.isascii() or any(sign in value for sign in "?# ")
    if wrong or not _names_server(value, "http", "https"):
        raise ValueError("must be like http://valhalla:8002")
    return value


def _checked_root_path(value: str) -> str:
    if not value or not is_root_path(value):
        raise ValueError("must be like /tours")
    return value


def _checked_tiles(value: str) -> str:
    """Return the template of a tile's address."""
    server = urlsplit(value).netloc.removeprefix("{s}.") if _TILES.fullmatch(value) else "{"
    if "{" in server or not all(value.count(part) == 1 for part in _PARTS_OF_TILES):
        raise ValueError("must be like https://tiles.example.org/{z}/{x}/{y}.png")
    return value


def _number(least: float, most: float, kind: str = "number") -> WrapValidator:
    """Return the check that a setting is a finite number in a range, which its error names."""

    def check(value: object, read: ValidatorFunctionWrapHandler) -> float:
        try:
            number: float = read(value)
        except ValidationError:
            number = math.nan
        if not least <= number <= most:
            raise ValueError(f"must be a {kind} from {least} to {most}")
        return number

    return WrapValidator(check)


_whole = partial(_number, kind="whole number")

Share = Annotated[float, _number(_LEAST, 1)]
Seconds = Annotated[float, _number(_LEAST, _WEEK)]
KeptSeconds = Annotated[float, _number(_LEAST, 10 * _YEAR)]
Listed: TypeAlias = Annotated[tuple[Each, ...], NoDecode, _as(_split)]
Words = Listed[str]
KeyHashes = Listed[Annotated[KeyHash, _as(KeyHash.read)]]
WebhookTargets = Listed[Annotated[Target, _as(Target.read)]]
WebhookSecrets = Listed[Annotated[Secret, _as(Secret.read)]]
RedisUrl = Annotated[str, AfterValidator(_checked_redis_url)]
Rate = Annotated[str, AfterValidator(_checked_rate)]
Address = Annotated[str, AfterValidator(_checked_address)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,50}$")]
Profiles = Listed[Annotated[tuple[Name, Name], _as(_pair)]]


class Settings(BaseSettings):
    """All settings. A variable is PARETOUR_ and the field's name in capitals, or its alias."""

    model_config = SettingsConfigDict(env_prefix="PARETOUR_", frozen=True)

    # The address, and the processes that plan.
    host: str = "127.0.0.1"
    """address to listen on"""
    port: Annotated[int, _whole(0, 65_535)] = 8000
    """port to listen on; 0 takes a free one"""
    actors: Path = RELEASED
    """directory of the networks, ONNX files"""
    own_actors: Path | None = None
    """directory of more networks, served in addition"""
    constructors: Words = ()
    """constructors of tours, separated by commas: functions of installed packages"""
    search: Name | None = None
    """the search in the place of Paretour's: a function of an installed package"""
    workers: Annotated[int, _whole(1, _MOST_PROCESSES)] = Field(default_factory=_cores)
    """processes that plan, one request at a time each"""
    threads: Annotated[int, _whole(1, _MOST_PROCESSES)] = 1
    """threads of one inference call"""
    queue: Annotated[int, _whole(0, _MOST_WAITING)] = 16
    """requests that may wait for a worker"""
    caller_share: Share = 0.5
    """share of workers, queue and bodies that one caller may use"""

    # Connections.
    connections: Annotated[int, _whole(1, _MOST_CONNECTIONS)] = 1000
    """open connections; fewer where descriptors (`ulimit -n`) are few"""
    connection_share: Share = 0.25
    """share of the connections that one address may hold; proxies are exempt"""
    head_seconds: Seconds = 10.0
    """how long a request's head may take, and a connection may be idle"""

    forwarded_allow_ips: str = Field("127.0.0.1", validation_alias="FORWARDED_ALLOW_IPS")
    """proxies whose X-Forwarded headers are trusted, separated by commas; or *"""
    root_path: Annotated[str, AfterValidator(_checked_root_path)] | None = None
    """path under which a proxy serves all this, such as /tours, and which it takes away"""

    # Map tiles under the stops on the page, which browsers load from there.
    tiles: Annotated[str, AfterValidator(_checked_tiles)] | None = None
    """address of map tiles with {z}, {x}, {y}; without it no streets are drawn"""
    tiles_credit: str = "© OpenStreetMap contributors"
    """credit for the map tiles, shown on the map"""

    # Limits of a request.
    max_body_bytes: Annotated[int, _whole(1, _MOST_BODY_BYTES)] = 2**24
    """the longest request body"""
    bodies_bytes: Annotated[int, _whole(2**20, _MOST_BYTES)] = 2**27
    """the most bytes of all request bodies in progress; as many for answers"""
    parse_seconds: Seconds = 20.0
    """how long a body may take to parse, in seconds of a processor"""
    parse_bytes: Annotated[int, _whole(2**26, _MOST_BYTES)] = 2**29 + 2**28
    """memory that parsing a body may take"""
    max_cities: Annotated[int, _whole(1, _MOST_CITIES)] = 10_000
    """the most cities of an instance"""
    max_matrix_cities: Annotated[int, _whole(1, _MOST_PAIRED_CITIES)] = 1000
    """the most cities where costs are matrices"""
    max_network_cities: Annotated[int, _whole(1, _MOST_PAIRED_CITIES)] = 5000
    """the most cities for which a network builds tours"""
    max_fleet_stops: Annotated[int, _whole(1, _MOST_FLEET_STOPS)] = 5000
    """the most stops of a fleet in straight lines, and places that several robots share"""
    max_cells: Annotated[int, _whole(1, _MOST_CELLS)] = 2**20
    """the most cells of a map"""
    max_breakpoints: Annotated[int, _whole(1, _MOST_BREAKPOINTS)] = 2**20
    """the most breakpoints of all pairs of stops, in all objectives"""
    max_path_cells: Annotated[int, _whole(1, _MOST_PATH_CELLS)] = 2**21
    """the most path cells, or stops of tours, of an answer"""
    max_survey_seconds: Seconds = 10.0
    """processor seconds for the paths between places of a map, if no time_limit is longer"""
    max_preferences: Annotated[int, _whole(1, _MOST_TOURS)] = 200
    """the most preferences of a request"""
    max_repairs: Annotated[int, _whole(0, _MOST_TOURS)] = 200
    """the most repairs of the network's tours"""
    max_size: Annotated[int, _whole(1, _MOST_TOURS)] = 1000
    """the most tours that a request may ask for"""
    max_time_limit: Annotated[float, _number(0, _WEEK)] = 60.0
    """the most seconds of planning"""

    # Deadlines.
    request_seconds: Seconds = 90.0
    """seconds after which a request is answered with the best front so far"""
    drain_seconds: Annotated[int, _whole(0, _WEEK)] = 20
    """seconds to finish requests in progress after SIGTERM"""
    body_seconds: Seconds = 30.0
    """how long a body may take to arrive"""

    # The store of fronts and jobs.
    store: str = ":memory:"
    """file for fronts and jobs, which survive a restart; by default memory"""
    store_entries: Annotated[int, _whole(1, _MOST_ENTRIES)] = 256
    """the most fronts kept; when full, the client with most loses its oldest"""
    store_bytes: Annotated[int, _whole(1, _MOST_BYTES)] = STORE_BYTES
    """the most bytes of all fronts kept"""
    store_seconds: KeptSeconds = 3600.0
    """how long a front is kept"""
    redis_url: RedisUrl | None = None
    """Redis shared by all replicas: rates, fronts, and jobs for `paretour work`"""

    # The routing engine.
    router_url: Address | None = None
    """address of the routing engine; without it costs by road are refused"""
    router: RouterName = "valhalla"
    """interface of the routing engine: valhalla or osrm"""
    router_profile: Name | None = None
    """its profile, such as auto; by default auto for valhalla, driving for osrm"""
    router_profiles: Profiles = ()
    """profiles that vehicles may name, as car:auto,van:auto; by default those of a Valhalla"""
    router_snap: Annotated[float, _number(_LEAST, 10_000)] = 250.0
    """the most metres from a stop to a road"""
    router_seconds: Seconds = 20.0
    """how long the routing engine may take for one request's costs, or streets"""
    router_traffic: bool = False
    """whether the routing engine, a Valhalla, has historical traffic, which requests may ask for"""
    router_pairs: Annotated[int, _whole(1, 10_000)] = 2500
    """the most pairs of stops in one question to the routing engine"""
    router_cache_bytes: Annotated[int, _whole(0, _MOST_BYTES)] = 2**26
    """the most bytes of remembered costs and streets, which are asked for once"""
    router_cache_seconds: KeptSeconds = 3600.0
    """how long costs and streets are remembered"""
    router_legs: Annotated[int, _whole(1, _MOST_ENTRIES)] = 5000
    """the most legs whose streets one answer draws"""
    router_positions: Annotated[int, _whole(2, 2**24)] = 2**20
    """the most positions in all lines along streets of one answer"""

    # Access.
    api_keys: KeyHashes = ()
    """callers and their keys, as CALLER:HASH,CALLER:HASH; without it all may call"""
    rate: Rate = Field(default="1000/minute", validate_default=False)
    """the most requests of each caller; without keys, of each address"""
    origins: Words = ()
    """origins whose pages may call (CORS), separated by commas; or *"""

    mcp: bool = False
    """whether agents may call, by the Model Context Protocol at `/mcp`: 1 or 0"""

    webhook_targets: WebhookTargets = ()
    """where webhooks may go: ORIGIN or ORIGIN=NETWORK, separated by commas; without it nowhere"""
    webhook_secrets: WebhookSecrets = ()
    """what webhooks are signed with: whsec_ and base64; two while one is replaced, with a comma"""

    # Observation.
    traces: str | None = Field(None, validation_alias="OTEL_EXPORTER_OTLP_ENDPOINT")
    """where OpenTelemetry traces go, over HTTP"""

    @property
    def extensions(self) -> Extensions:
        """The names of the constructors and of the search of other packages."""
        return Extensions(self.constructors, self.search)

    @property
    def roads(self) -> RouterSettings | None:
        """The routing engine, if there is one."""
        if self.router_url is None:
            return None
        if self.router_traffic and self.router != "valhalla":
            raise ValueError("PARETOUR_ROUTER_TRAFFIC needs PARETOUR_ROUTER=valhalla")
        named = {name.removeprefix("router_"): value for name, value in self if "router_" in name}
        del named["traffic"]
        named["profile"] = self.router_profile or DEFAULT_PROFILES[self.router]
        named["profiles"] = dict(self.router_profiles) or KNOWN_PROFILES[self.router]
        # Less than the request's, so that the error names the slow engine as the cause.
        named["seconds"] = min(self.router_seconds, _ROUTER_SHARE * self.request_seconds)
        return RouterSettings(router=self.router, **named)

    @property
    def webhooks(self) -> Targets | None:
        """Where webhooks may go; None where they may go nowhere."""
        if not self.webhook_targets:
            return None
        if not self.webhook_secrets:
            raise ValueError("PARETOUR_WEBHOOK_TARGETS needs PARETOUR_WEBHOOK_SECRETS")
        return Targets(self.webhook_targets)

    @property
    def limits(self) -> Limits:
        """The limits of a request: the settings whose names begin with `max_`."""
        named = {name.removeprefix("max_"): value for name, value in self if name[:4] == "max_"}
        seconds = named.pop("time_limit")
        roads = self.roads
        return Limits(
            **named,
            seconds=seconds,
            roads=roads is not None,
            traffic=roads is not None and self.router_traffic,
            profiles=() if roads is None else tuple(roads.profiles),
        )


PREFIX = "PARETOUR_"
_ROUTER_SHARE = 0.9  # the share of a request's seconds that its costs by road may take
# Variables of the command line, and those that Kubernetes and Docker set for other services.
_OTHERS = re.compile(
    r"PARETOUR_(API_KEY|(\w+_)?SERVICE_(HOST|PORT(_\w+)?)|(\w+_)?PORT_\d+_(TCP|UDP|SCTP)(_\w+)?)"
)
_LINK = re.compile(r"(tcp|udp|sctp)://")


def variable_of(name: str) -> str:
    """Return the environment variable of a setting, given its field or its alias."""
    return f"{PREFIX}{name.upper()}" if name in Settings.model_fields else name


def unknown_variables(environment: Mapping[str, str]) -> Iterable[str]:
    """Yield a sentence for each variable that has the prefix but is not a setting."""
    known = {variable_of(name) for name in Settings.model_fields}
    for name, value in sorted(environment.items()):
        upper = name.upper()
        if not upper.startswith(PREFIX) or upper in known or _OTHERS.fullmatch(upper):
            continue
        if upper.endswith("_PORT") and _LINK.match(value):
            continue
        nearest = get_close_matches(upper, known, 1)
        yield f"{name} is not a setting" + (f"; did you mean {nearest[0]}?" if nearest else "")
