"""The route that reads files, `POST /files`, and the schema of its answer."""

from typing import Any

from fastapi import APIRouter
from pydantic import BaseModel, Field
from starlette.requests import Request
from starlette.responses import Response

from service.api.auth import client_of
from service.api.body import receive_files
from service.api.body_budget import BodyBudget
from service.api.responses import compressed, json_bytes, problem_responses
from service.api.task_parser import TaskParser
from service.files.reading import ColumnItem, DetailItem, Kind, NamedFile, NoteItem
from service.files.upload import Upload
from service.requests.fields import Maybe, optional

_FILE = {"type": "string", "format": "binary", "description": "a file, with its filename"}
_FORM = {
    "type": "object",
    "description": "One file; one for each objective; or stops and vehicles.",
    "properties": {
        "file": {"type": "array", "items": _FILE, "minItems": 1},
        "columns": {
            "type": "string",
            "contentMediaType": "application/json",
            "description": "columns of tables that are to be taken for something else than their"
            " names say: a list as `columns` of the answer, each taken for one of `choices`",
        },
    },
    "required": ["file"],
}
_BODY = {"required": True, "content": {"multipart/form-data": {"schema": _FORM}}}


class FileAnswer(BaseModel):
    """The request that the files describe, and the assumptions made."""

    kind: Kind = Field(description="the operation that takes the request")
    request: dict[str, Any]
    notes: list[NoteItem]
    columns: Maybe[list[ColumnItem]] = optional("of tables with a heading")
    choices: Maybe[dict[str, list[str]]] = optional(
        "by file, what its columns can be taken for instead: see the part `columns`"
    )
    details: Maybe[list[DetailItem]] = optional(
        "the columns that are taken for `detail`: by default, the first ten of a table of stops"
        " that are not used otherwise and have texts. They are in no request"
    )
    planes: Maybe[list[list[float]]] = optional(
        "for two EUC_2D files: x and y of each city in both planes. The matrices in the request are"
        " the rounded distances"
    )
    unknown_cells: Maybe[list[list[int]]] = optional(
        "of a map with unknown cells, to draw them: rows of 0, and 1 where it is unknown. Whether"
        " the robot may go there is in the request's grid"
    )
    name: str


def file_router(
    parser: TaskParser, budget: BodyBudget, most_bytes: int, answers: BodyBudget
) -> APIRouter:
    """Return the route that reads files in the processes that parse bodies."""
    router = APIRouter(tags=["files"])

    @router.post(
        "/files",
        response_model=FileAnswer,
        responses=problem_responses(400, 408, 413, 415, 422, 503),
        openapi_extra={"requestBody": _BODY},
    )
    async def read_files(request: Request) -> Response:
        """Read files of stops, fleets or maps, and return the request that they describe.

        A file is CSV with any separator, XLSX, GeoJSON, GPX, KML, JSON, TSPLIB, CVRPLIB, in the
        format of Solomon, of Li and Lim or of VROOM, or a map: a picture, with or without its
        map.yaml, or in the format of MovingAI. Two to four tables or TSPLIB files are one objective
        each; a table of stops and one of vehicles are a fleet. The answer also lists what was
        assumed, and what the unused columns of a table of stops tell drivers: `details`, which are
        stored nowhere.
        Nothing is planned: the request in the answer is for `POST /front`, `/fleet` or `/coverage`,
        as its `kind` says.
        """
        client = client_of(request)
        with budget.open(client) as allowance:
            files, columns = await receive_files(request, most_bytes, allowance)
            upload = Upload([NamedFile(*each) for each in files], columns)
            answer = await parser.read_files(upload, client)
            with answers.open(client, len(answer), always=True) as sent:
                return sent.until_sent(await compressed(request, json_bytes(answer)))

    return router
