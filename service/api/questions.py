"""The route that asks which of a few options is best: `GET /front/{id}/questions`."""

import asyncio
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.answers import QuestionAnswer
from service.api.responses import json_bytes, problem_responses
from service.api.schemas import documented
from service.api.stored_fronts import find_record
from service.errors import Refusal
from service.jobs.engine import Engine
from service.jobs.store import Store
from service.kinds.table import KINDS
from service.requests.questions import QuestionsQuery, members_of


@dataclass(frozen=True, eq=False)
class QuestionRoutes:
    """Asks questions about stored fronts. Each caller sees only its own."""

    store: Store
    engine: Engine

    def router(self) -> APIRouter:
        """Return the route with its entry in the OpenAPI document."""
        router = APIRouter(tags=["fronts"])
        router.get(
            "/front/{id}/questions",
            response_model=documented(QuestionAnswer),
            responses=problem_responses(404, 409, 410, 422, 503),
        )(self.ask_about_front)
        return router

    async def ask_about_front(
        self, request: Request, id: str, query: Annotated[QuestionsQuery, Query()]
    ) -> Response:
        """Ask which option of a few is best, and after some picks return a tour of the front.

        The first question begins at the worst length of every objective. Each option is at least as
        good in all of them, and says the best that stays within reach (E-NAUTILUS). Nothing is
        stored: the picks so far are a parameter.
        """
        record = self.engine.state(await find_record(self.store, request, id)).record
        front = record.front
        if not record.finished:
            raise Refusal("front-unfinished", front=record.id, status=record.status)
        if not front.tours:
            raise Refusal("no-tour", front=record.id)
        question = await asyncio.to_thread(query.ask, front.lengths)
        named = {} if front.objectives is None else {"objectives": front.objectives}
        answer = to_json({"front": record.id, **members_of(question), **named})
        if question.chosen is not None:
            item = KINDS[front.kind].item.encode()
            chosen = front.tour(question.chosen)
            answer = b"".join((answer[:-1], b',"', item, b'":', chosen, b"}"))
        return json_bytes(answer)
