"""The exception for a refusal of the service, and the seconds to wait before a retry."""

from collections.abc import Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

RETRY_STATUSES = (429, 503)
_LEAST_SECONDS = 0.1  # between two tries, even where Retry-After is 0
_DEFAULT_SECONDS = 1.0


class Refused(Exception):
    """A problem document (RFC 9457) that the service answered with.

    Attributes:
        status: The HTTP status.
        code: What went wrong, in a word that stays the same over releases. A response that is no
            problem document, from a proxy in between, has the code `unknown`.
        detail: What went wrong, in a sentence.
        request_id: What the service's log calls the request.
        errors: The fields at fault, each with its `detail` and a JSON `pointer` or `parameter`.
        limit: The most that is allowed, where a limit was exceeded.
        actual: What came instead.
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


def refused(response: httpx.Response) -> Refused:
    """Return the exception for an error response that has been read."""
    content_type = response.headers.get("content-type", "").partition(";")[0]
    if content_type == "application/problem+json":
        return Refused(response.json())
    detail = f"{response.url} answered {response.status_code} {response.reason_phrase}"
    return Refused({"status": response.status_code, "code": "unknown", "detail": detail})


def retry_after(response: httpx.Response) -> float:
    """Return the seconds that Retry-After asks for, as a number or as a date."""
    header = response.headers.get("retry-after", str(int(_DEFAULT_SECONDS)))
    if header.strip().isdecimal():
        return max(float(header), _LEAST_SECONDS)
    try:
        date = parsedate_to_datetime(header)
    except ValueError:
        return _DEFAULT_SECONDS
    return max((date - datetime.now(UTC)).total_seconds(), _LEAST_SECONDS)
