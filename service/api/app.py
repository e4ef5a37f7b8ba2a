"""The FastAPI application: every route, middleware and exception handler, put together."""

from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager, nullcontext
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, FastAPI
from starlette.middleware import Middleware
from starlette.middleware.cors import CORSMiddleware
from starlette.responses import Response

from service.actor_info import ActorInfo
from service.api.answers import ActorsAnswer
from service.api.auth import Access
from service.api.body_budget import BodyBudget
from service.api.exception_handlers import HANDLED, answer_refusal
from service.api.files import file_router
from service.api.geojson.answers import FrontAnswers
from service.api.metrics import Metrics
from service.api.middleware import (
    BodyTimeoutMiddleware,
    ProblemMiddleware,
    RequestMiddleware,
    SecurityHeadersMiddleware,
    log_request,
)
from service.api.offers import Measure, OfferRoutes
from service.api.openapi import complete
from service.api.plan import PlanRoutes
from service.api.questions import QuestionRoutes
from service.api.request_bodies import request_schemas
from service.api.request_headers import ALLOWED
from service.api.response_headers import EXPOSED
from service.api.responses import HealthAnswer, json_response, problem_responses
from service.api.schemas import documented
from service.api.site.guide import guide_routes
from service.api.site.static import static_routes
from service.api.site.tiles import Tiles
from service.api.stored_fronts import StoredFrontRoutes
from service.api.task_parser import ParserBounds, TaskParser
from service.api.webhook_event import add_webhooks
from service.jobs.engine import Engine
from service.jobs.store import Store
from service.requests.limits import Limits
from service.roads.client import RoadClient
from service.webhooks.sender import Webhooks
from service.webhooks.targets import Targets

if TYPE_CHECKING:
    from service.api.mcp import AgentRoute


@dataclass(frozen=True, kw_only=True)
class Edge:
    """The settings of the application's edge: access, origins, deadlines and budgets.

    Args:
        access: API keys and rates; by default everybody may call, as one caller.
        metrics: The metrics that requests are counted in.
        origins: Other origins whose pages may call (CORS); by default none.
        body_seconds: The time that a body may take to arrive.
        request_seconds: The time after which a request is answered with the best front so far.
        bodies_bytes: The most bytes of all request bodies in progress; as many for answers.
        share: The share of these that the long bodies of one client may take.
        parser: The bounds of a process that parses bodies.
        measure: Measures the costs by road of a task; by default there are none.
        streets: The streets that lines of GeoJSON may follow; by default there are none.
        tiles: The map tiles that the page draws under stops; by default there are none.
        agents: Whether agents may call, by the Model Context Protocol at `/mcp`.
        webhooks: How the ends of jobs are posted to webhooks; by default they are refused.
    """

    access: Access = field(default_factory=Access)
    metrics: Metrics = field(default_factory=Metrics)
    origins: Sequence[str] = ()
    body_seconds: float = 30.0
    request_seconds: float = 90.0
    bodies_bytes: int = 2**27
    share: float = 0.5
    parser: ParserBounds = field(default_factory=ParserBounds)
    measure: Measure | None = None
    streets: RoadClient | None = None
    tiles: Tiles = field(default_factory=Tiles)
    agents: bool = False
    webhooks: Webhooks | None = None

    @property
    def middleware(self) -> list[Middleware]:
        """The middleware that each request passes, outermost first."""
        cors = Middleware(
            CORSMiddleware,
            allow_origins=self.origins,
            allow_methods=["GET", "POST", "DELETE"],
            allow_headers=ALLOWED,
            expose_headers=EXPOSED,
        )
        return [
            Middleware(SecurityHeadersMiddleware, self.tiles.source),
            Middleware(RequestMiddleware, (self.metrics.answered, log_request)),
            Middleware(ProblemMiddleware),
            *([cors] if self.origins else []),
            Middleware(BodyTimeoutMiddleware, self.body_seconds),
        ]


def create_app(
    actors: Mapping[str, ActorInfo],
    store: Store,
    engine: Engine,
    limits: Limits,
    version: str,
    edge: Edge | None = None,
) -> FastAPI:
    """Return the application, which starts the engine and closes engine and store at its end."""
    edge = edge or Edge()
    parser = TaskParser(limits, actors, edge.parser)
    budget = BodyBudget(edge.bodies_bytes, edge.share)
    answers_budget = BodyBudget(edge.bodies_bytes, edge.share, answers=True)
    answers = FrontAnswers(edge.streets, answers_budget)
    most_bytes, seconds = limits.body_bytes, edge.request_seconds
    webhooks = edge.webhooks
    targets = Targets() if webhooks is None else webhooks.targets

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        await engine.start()
        async with (
            nullcontext() if agents is None else agents.running(),
            nullcontext() if webhooks is None else webhooks.running(store),
        ):
            yield
        await engine.close()
        await store.close()
        await answers.close()

    app = _DocumentedApp(
        request_schemas(limits, actors),
        title="Paretour API",  # generators name the packages of clients after it
        summary="Pareto fronts of tours under two to four objectives",
        version=version,
        lifespan=lifespan,
        middleware=edge.middleware,
        exception_handlers=dict.fromkeys(HANDLED, answer_refusal),
        redirect_slashes=False,
        generate_unique_id_function=lambda route: route.name,
        docs_url=None,
        redoc_url=None,
    )
    add_webhooks(app.webhooks)
    agents = _agent_route(app, budget, most_bytes, version) if edge.agents else None
    refusals = problem_responses(401, 429)
    for guarded in (
        PlanRoutes(parser, budget, most_bytes, engine, store, seconds, answers, targets).router(),
        file_router(parser, budget, most_bytes, answers_budget),
        StoredFrontRoutes(store, engine, answers).router(),
        QuestionRoutes(store, engine).router(),
        OfferRoutes(parser, budget, answers_budget, most_bytes, store, edge.measure).router(),
        _actor_router(actors),
        edge.metrics.router(),
        *([] if agents is None else [agents.router()]),
    ):
        app.include_router(guarded, dependencies=edge.access.dependencies, responses=refusals)
    app.include_router(_health_router(engine))
    # Last, because routes are tried in order and these are many.
    app.routes.extend(
        [
            edge.tiles.route(edge.streets is not None, limits.seconds),
            *static_routes(),
            *guide_routes(),
        ]
    )
    return app


def _agent_route(app: FastAPI, budget: BodyBudget, most_bytes: int, version: str) -> "AgentRoute":
    """Return the route of agents; the protocol is loaded here alone, as it takes half a second."""
    from service.api.mcp import AgentRoute

    return AgentRoute(app, budget, most_bytes, version)


class _DocumentedApp(FastAPI):
    """A FastAPI application whose OpenAPI document is complete.

    Args:
        schemas: The schemas that request bodies refer to, by name.
        arguments: FastAPI's own.
    """

    def __init__(self, schemas: Mapping[str, Any], **arguments: Any) -> None:
        super().__init__(**arguments)
        self._schemas = schemas

    def openapi(self) -> dict[str, Any]:
        """Return the OpenAPI document, made once."""
        if self.openapi_schema is None:
            complete(super().openapi(), self._schemas)
        return super().openapi()


def _actor_router(actors: Mapping[str, ActorInfo]) -> APIRouter:
    router = APIRouter(tags=["service"])

    @router.get("/actors", response_model=documented(ActorsAnswer))
    async def list_actors() -> Response:
        """List the networks to choose from."""
        return json_response({"actors": [asdict(actors[name]) for name in sorted(actors)]})

    return router


def _health_router(engine: Engine) -> APIRouter:
    """Return the routes for orchestrators, which are open to all: an orchestrator has no key."""
    router = APIRouter(tags=["service"])
    public: dict[str, Any] = {"security": []}

    @router.get("/health/live", response_model=HealthAnswer, openapi_extra=public)
    async def check_live() -> Response:
        """Say whether the process answers."""
        return json_response({"status": "live"})

    @router.get(
        "/health/ready",
        response_model=HealthAnswer,
        responses=problem_responses(503),
        openapi_extra=public,
    )
    async def check_ready() -> Response:
        """Say whether the process plans, and what is still being compiled for rarer requests."""
        await engine.check_ready()
        compiling = engine.compiling
        return json_response(
            {"status": "ready", **({"compiling": asdict(compiling)} if compiling else {})}
        )

    # Some probes ask for the status alone.
    router.head(
        "/health/live", name="check_live_head", response_class=Response, openapi_extra=public
    )(check_live)
    router.head(
        "/health/ready",
        name="check_ready_head",
        response_class=Response,
        responses={503: {"description": "Service Unavailable"}},
        openapi_extra=public,
    )(check_ready)
    return router
