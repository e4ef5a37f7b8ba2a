"""What stands between the network and the paths: access, metrics, the log, other origins, time."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from starlette.middleware import Middleware
from starlette.middleware.cors import CORSMiddleware

from service.api.auth import Access
from service.api.headers import BrowserHeaders
from service.api.identity import RequestIds
from service.api.metrics import Metrics
from service.api.observed import ObservedRequests, log_request
from service.api.timely import TimelyBodies
from service.errors import responses


@dataclass(frozen=True, kw_only=True)
class Edge:
    """Everybody may call, as one, and no page of another origin, unless it is said otherwise."""

    access: Access = field(default_factory=Access)
    metrics: Metrics = field(default_factory=Metrics)
    origins: Sequence[str] = ()
    body_seconds: float = 30.0

    @property
    def guard(self) -> dict[str, Any]:
        """What a router that is not open to all is included with."""
        return {"dependencies": self.access.dependencies, "responses": responses(401, 429)}

    @property
    def middleware(self) -> list[Middleware]:
        """What each request passes through, outermost first."""
        observers = (self.metrics.answered, log_request)
        cors = [Middleware(CORSMiddleware, **self._cors)] if self.origins else []
        return [
            Middleware(BrowserHeaders),
            Middleware(RequestIds),
            Middleware(ObservedRequests, observers),
            *cors,
            Middleware(TimelyBodies, self.body_seconds),
        ]

    @property
    def _cors(self) -> dict[str, Any]:
        return {
            "allow_origins": self.origins,
            "allow_methods": ["GET", "POST", "DELETE"],
            "allow_headers": ["Authorization", "Content-Type", "Idempotency-Key", "Prefer"],
            "expose_headers": ["Location", "Preference-Applied", "Retry-After", "X-Request-ID"],
        }
