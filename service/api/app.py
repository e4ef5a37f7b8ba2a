"""The application: every path, its middleware and its exception handlers, put together."""

from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import asdict, dataclass, field
from typing import Any

from fastapi import APIRouter, FastAPI
from starlette.middleware import Middleware
from starlette.middleware.cors import CORSMiddleware
from starlette.responses import Response

from service.actor import ActorInfo
from service.api.auth import Access
from service.api.exception_handlers import HANDLED, answer_refusal
from service.api.metrics import Metrics
from service.api.middleware import (
    BodyTimeoutMiddleware,
    RequestIdMiddleware,
    RequestLogMiddleware,
    SecurityHeadersMiddleware,
    log_request,
)
from service.api.openapi import illustrate
from service.api.plan import Answers, FrontRoutes
from service.api.responses import (
    ActorsAnswer,
    HealthAnswer,
    Problem,
    json_response,
    problem_responses,
)
from service.api.static import page_routes
from service.api.stored_fronts import StoredFrontRoutes
from service.jobs.engine import Engine
from service.jobs.store import Store
from service.requests.limits import Limits


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
        return {"dependencies": self.access.dependencies, "responses": problem_responses(401, 429)}

    @property
    def middleware(self) -> list[Middleware]:
        """What each request passes through, outermost first."""
        observers = (self.metrics.answered, log_request)
        cors = [Middleware(CORSMiddleware, **self._cors)] if self.origins else []
        return [
            Middleware(SecurityHeadersMiddleware),
            Middleware(RequestIdMiddleware),
            Middleware(RequestLogMiddleware, observers),
            *cors,
            Middleware(BodyTimeoutMiddleware, self.body_seconds),
        ]

    @property
    def _cors(self) -> dict[str, Any]:
        return {
            "allow_origins": self.origins,
            "allow_methods": ["GET", "POST", "DELETE"],
            "allow_headers": ["Authorization", "Content-Type", "Idempotency-Key", "Prefer"],
            "expose_headers": ["Location", "Preference-Applied", "Retry-After", "X-Request-ID"],
        }


_OPEN: dict[str, Any] = {"security": []}  # an orchestrator has no key


def create_app(
    actors: Mapping[str, ActorInfo],
    store: Store,
    engine: Engine,
    limits: Limits,
    version: str,
    edge: Edge | None = None,
) -> FastAPI:
    """The application. It starts the engine and closes it when it shuts down."""
    edge = edge or Edge()

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        await engine.start()
        yield
        await engine.close()
        await store.close()

    app = _Documented(
        title="Paretour",
        summary="Pareto fronts of tours under two objectives",
        version=version,
        lifespan=lifespan,
        middleware=edge.middleware,
        routes=page_routes(),
        exception_handlers=dict.fromkeys(HANDLED, answer_refusal),
        redirect_slashes=False,
        docs_url=None,
        redoc_url=None,
    )
    fronts = FrontRoutes(actors, engine, Answers(engine, store), limits)
    app.include_router(fronts.router(), **edge.guard)
    app.include_router(StoredFrontRoutes(store, engine).router(), **edge.guard)
    app.include_router(_actor_router(actors), **edge.guard)
    app.include_router(edge.metrics.router(), **edge.guard)
    app.include_router(_HealthRoutes(engine).router())
    return app


class _Documented(FastAPI):
    """An application whose OpenAPI document knows the problem document, and has examples."""

    def openapi(self) -> dict[str, Any]:
        if self.openapi_schema is None:
            document = super().openapi()
            document["components"]["schemas"]["Problem"] = _problem_schema()
            document["components"]["securitySchemes"] = {
                "key": {"type": "http", "scheme": "bearer"}
            }
            document["security"] = [{}, {"key": []}]  # which of them is for the settings to say
            _forget_default_refusals(document)
            illustrate(document)
        return super().openapi()


def _forget_default_refusals(document: dict[str, Any]) -> None:
    """Leave out what FastAPI says of every path with parameters: nothing is refused so here."""
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    for methods in document["paths"].values():
        for operation in methods.values():
            if "HTTPValidationError" in str(operation["responses"].get("422")):
                del operation["responses"]["422"]


def _problem_schema() -> dict[str, Any]:
    schema = Problem.model_json_schema()
    schema["properties"]["errors"] = {"type": "array", "items": schema.pop("$defs")["FaultItem"]}
    return schema


def _actor_router(actors: Mapping[str, ActorInfo]) -> APIRouter:
    router = APIRouter(tags=["service"])

    @router.get("/actors", response_model=ActorsAnswer)
    async def actors_there_are() -> Response:
        """List the networks to choose from."""
        facts = [asdict(each) for _, each in sorted(actors.items())]
        return json_response({"actors": facts})

    return router


class _HealthRoutes:
    """How the service is. These are open to all."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def router(self) -> APIRouter:
        """The paths, with what the OpenAPI document says of them."""
        router = APIRouter(tags=["service"])
        router.get("/health/live", response_model=HealthAnswer, openapi_extra=_OPEN)(self.live)
        router.get(
            "/health/ready",
            response_model=HealthAnswer,
            responses=problem_responses(503),
            openapi_extra=_OPEN,
        )(self.ready)
        return router

    async def live(self) -> Response:
        """Say whether the process answers."""
        return json_response({"status": "live"})

    async def ready(self) -> Response:
        """Say whether the process takes work of every kind."""
        await self._engine.check_ready()
        return json_response({"status": "ready"})
