"""The route that reads files: `POST /files`."""

from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from service.api.auth import client_of
from service.api.body import receive_files
from service.api.body_budget import BodyBudget
from service.api.responses import FileAnswer, compressed, json_bytes, problem_responses
from service.api.task_parser import TaskParser
from service.files.reading import NamedFile

_FILE = {"type": "string", "format": "binary", "description": "a file, with its filename"}
_FORM = {
    "type": "object",
    "description": "One file, or two: an objective each, or stops and vehicles.",
    "properties": {"file": {"type": "array", "items": _FILE, "minItems": 1}},
    "required": ["file"],
}
_BODY = {"required": True, "content": {"multipart/form-data": {"schema": _FORM}}}


class FileRoutes:
    """Reads files in the processes that parse bodies, within the same bounds.

    Args:
        parser: What parses bodies.
        budget: Of the bodies of all requests.
        most_bytes: Of one body.
        answers: The budget of all answers.
    """

    def __init__(
        self, parser: TaskParser, budget: BodyBudget, most_bytes: int, answers: BodyBudget
    ) -> None:
        self._parser = parser
        self._budget = budget
        self._most_bytes = most_bytes
        self._answers = answers

    def router(self) -> APIRouter:
        """Return the route with its entry in the OpenAPI document."""
        router = APIRouter(tags=["files"])
        extra: dict[str, Any] = {"requestBody": _BODY}
        router.post(
            "/files",
            response_model=FileAnswer,
            responses=problem_responses(400, 408, 413, 415, 422, 503),
            openapi_extra=extra,
        )(self.read_files)
        return router

    async def read_files(self, request: Request) -> Response:
        """Read files of stops, fleets or maps, and return the request that they describe.

        A file is CSV with any separator, XLSX, GeoJSON, JSON, TSPLIB, CVRPLIB, in the format of
        Solomon, of Li and Lim or of VROOM, or a map: a picture, with or without its map.yaml. Two
        tables or TSPLIB files are one objective each; a table of stops and one of vehicles are a
        fleet. The answer also lists what was assumed. Nothing is planned: the request in the
        answer is for `POST /front`, `/fleet` or `/coverage`, as its `kind` says.
        """
        client = client_of(request)
        with self._budget.open(client) as allowance:
            received = await receive_files(request, self._most_bytes, allowance)
            files = [NamedFile(name, content) for name, content in received]
            answer = await self._parser.read_files(files)
            with self._answers.open(client, len(answer), always=True) as sent:
                return sent.until_sent(await compressed(request, json_bytes(answer)))
