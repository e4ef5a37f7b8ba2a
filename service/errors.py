"""Refusals, and the problem documents (RFC 9457) that say them.

A refusal names the thing, the demand and what came; its code is stable, its sentence is not.
"""

from collections.abc import Callable, Sequence
from functools import partial
from http import HTTPStatus
from typing import Any

from pydantic import BaseModel, Field
from pydantic_core import to_json
from starlette.responses import Response

MEDIA_TYPE = "application/problem+json"
MOST_FAULTS = 20  # that one document lists


class Fault(BaseModel):
    """One thing wrong with a request."""

    detail: str
    pointer: str | None = Field(default=None, description="JSON pointer into the body (RFC 6901)")
    parameter: str | None = Field(default=None, description="name of the query parameter")


class Problem(BaseModel):
    """Why a request was refused (RFC 9457)."""

    type: str = Field(description="always about:blank; the code tells problems apart")
    title: str
    status: int
    code: str = Field(description="stable; the one member to branch on")
    detail: str
    request_id: str
    errors: list[Fault] | None = None
    limit: float | None = Field(default=None, description="the most that is allowed")
    actual: float | None = Field(default=None, description="what came, where it is known")


class Refusal(Exception):
    """A request that will not be served; everything its problem document says."""

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        errors: Sequence[Fault] = (),
        limit: float | None = None,
        actual: float | None = None,
    ) -> None:
        super().__init__(detail)
        self._made = partial(
            Refusal, status, code, detail, errors=errors, limit=limit, actual=actual
        )
        self.status = status
        self.headers = {"Retry-After": "1"} if status == HTTPStatus.SERVICE_UNAVAILABLE else {}
        self.members: dict[str, Any] = {
            "type": "about:blank",
            "title": HTTPStatus(status).phrase,
            "status": status,
            "code": code,
            "detail": detail,
            "errors": [fault.model_dump(exclude_none=True) for fault in errors] or None,
            "limit": limit,
            "actual": actual,
        }

    def __reduce__(self) -> tuple[Callable[[], "Refusal"], tuple[()]]:
        """How it travels from one process to another."""
        return self._made, ()

    def document(self, request_id: str) -> dict[str, Any]:
        """The problem document."""
        members = {name: value for name, value in self.members.items() if value is not None}
        return {**members, "request_id": request_id}

    def response(self, request_id: str) -> Response:
        """The answer."""
        document = to_json(self.document(request_id))
        return Response(document, self.status, headers=self.headers, media_type=MEDIA_TYPE)


def bug() -> Refusal:
    """What is answered where the service itself is at fault."""
    return Refusal(500, "internal-error", "this is a fault of the service, not of the request")


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """What the OpenAPI document says of a path's refusals."""
    schema = {"$ref": "#/components/schemas/Problem"}
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": {MEDIA_TYPE: {"schema": schema}},
        }
        for status in statuses
    }
