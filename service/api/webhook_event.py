"""Describe in the OpenAPI document what is posted to a webhook."""

from typing import Annotated, Literal

from fastapi import APIRouter, Header
from pydantic import BaseModel, Field

from service.jobs.record import Status


class EndedJob(BaseModel):
    """A job that has ended."""

    id: str
    status: Status
    url: str = Field(description="the path of its front, as `Location` gave it")


class WebhookEvent(BaseModel):
    """The end of a job."""

    type: Literal["front.completed", "front.cancelled", "front.failed"]
    timestamp: str = Field(description="when it ended, by RFC 3339")
    data: EndedJob


def add_webhooks(webhooks: APIRouter) -> None:
    """Add the webhook to those of an application."""

    @webhooks.post(
        "front-ended",
        operation_id="front_ended",
        responses={200: {"description": "Any status from 200 to 299: it has arrived"}},
        openapi_extra={"security": []},
    )
    async def front_ended(
        event: WebhookEvent,
        webhook_id: Annotated[str, Header(description="the same for every attempt")],
        webhook_timestamp: Annotated[int, Header(description="of the attempt, Unix seconds")],
        webhook_signature: Annotated[
            str, Header(description="`v1,` and the HMAC-SHA256 of `id.timestamp.body` in base64")
        ],
    ) -> None:
        """The end of a job, posted to its `Webhook-Url` as Standard Webhooks says.

        Check the signature with the secret that the operator gave you before you believe it.
        """
