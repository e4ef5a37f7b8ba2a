"""Why the service did not do what was asked, and when to ask again."""

from collections.abc import Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

ASK_AGAIN = (429, 503)
_SOONEST = 0.1  # seconds; whoever says 0 is not asked without a pause


class Refused(Exception):
    """A problem document (RFC 9457); `code` is the member to branch on.

    `errors` are the fields at fault, each with its `detail` and a JSON `pointer` or `parameter`.
    An answer that is no problem document, from a proxy in between, has the code `unknown`.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        super().__init__(document["detail"])
        self.status: int = document["status"]
        self.code: str = document["code"]
        self.detail: str = document["detail"]
        self.request_id: str | None = document.get("request_id")
        self.errors: tuple[Mapping[str, str], ...] = tuple(document.get("errors", ()))
        self.limit: float | None = document.get("limit")
        self.actual: float | None = document.get("actual")

    def __str__(self) -> str:
        return f"{self.detail} ({self.code})"


def refusal(response: httpx.Response) -> Refused:
    """What an answer that is an error says, once it has been read."""
    kind = response.headers.get("content-type", "").partition(";")[0]
    if kind == "application/problem+json":
        return Refused(response.json())
    detail = f"{response.url} answered {response.status_code} {response.reason_phrase}"
    return Refused({"status": response.status_code, "code": "unknown", "detail": detail})


def pause_before_next(answer: httpx.Response) -> float:
    """Seconds that Retry-After asks for, written as a number or as a date."""
    given = answer.headers.get("retry-after", "1")
    if given.strip().isdecimal():
        return max(float(given), _SOONEST)
    try:
        moment = parsedate_to_datetime(given)
    except ValueError:
        return 1.0
    return max((moment - datetime.now(UTC)).total_seconds(), _SOONEST)
