"""The service over HTTP: every path, and what any of them answers when it refuses."""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import asdict
from typing import Any

from fastapi import APIRouter, FastAPI
from starlette.responses import Response

from service.actor import ActorFacts
from service.api.answers import Answers
from service.api.body import json_response
from service.api.edge import Edge
from service.api.exception_handlers import REFUSALS, answer_refusal
from service.api.openapi import illustrate
from service.api.plan import FrontRoutes
from service.api.responses import ActorsAnswer, HealthAnswer
from service.api.static import page_routes
from service.api.stored_fronts import KeptRoutes
from service.errors import Problem, responses
from service.jobs.engine import Engine
from service.jobs.store import Store
from service.requests.schemas import Limits

_OPEN: dict[str, Any] = {"security": []}  # an orchestrator has no key


def create_app(
    actors: Mapping[str, ActorFacts],
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
        exception_handlers=dict.fromkeys(REFUSALS, answer_refusal),
        redirect_slashes=False,
        docs_url=None,
        redoc_url=None,
    )
    fronts = FrontRoutes(actors, engine, Answers(engine, store), limits)
    app.include_router(fronts.router(), **edge.guard)
    app.include_router(KeptRoutes(store, engine).router(), **edge.guard)
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
    schema["properties"]["errors"] = {"type": "array", "items": schema.pop("$defs")["Fault"]}
    return schema


def _actor_router(actors: Mapping[str, ActorFacts]) -> APIRouter:
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
            responses=responses(503),
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
