"""The schema of a problem document (RFC 9457), with its faults and remedies."""

from typing import Any, Literal

from pydantic import BaseModel, Field

from service.requests.fields import optional


class PatchOperation(BaseModel):
    """An operation of a JSON patch (RFC 6902)."""

    op: Literal["add", "remove"]
    path: str = Field(description="JSON pointer into the body of the request (RFC 6901)")
    value: Any = optional("of `add`: what the member gets")


class RemedyItem(BaseModel):
    """A change to the request that was tried: after it, there is a plan."""

    code: str = Field(description="what is changed; stable")
    detail: str
    values: dict[str, float | str] = Field(description="the values in the sentence by name")
    patch: list[PatchOperation] = Field(description="the change, as a JSON patch (RFC 6902)")


class FaultItem(BaseModel):
    """One thing wrong with a request."""

    detail: str
    pointer: str | None = optional("JSON pointer into the body (RFC 6901)")
    parameter: str | None = optional("name of the query parameter")
    code: str | None = optional("what is wrong with it; stable")
    demand: str | None = optional("`detail` without the name of the field at its beginning")
    values: dict[str, float | str] | None = optional(
        "the values in the sentence by name; `came` is what came, `near` what was probably meant,"
        " and `other` the pointer to another field"
    )
    remedies: list[RemedyItem] | None = optional(
        "changes to the request after each of which there is a plan, as was tried; in the first of"
        " `errors` alone"
    )


class Problem(BaseModel):
    """Why a request was refused (RFC 9457)."""

    type: str = Field(description="where the guide explains the code: `/guide/errors#CODE`")
    title: str
    status: int
    code: str = Field(description="stable; the one member to branch on")
    detail: str
    request_id: str
    errors: list[FaultItem] | None = None
    limit: float | None = optional("the most that is allowed")
    actual: float | None = optional("what came, where it is known")
