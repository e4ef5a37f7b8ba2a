"""The exception for a refusal of the service, and the seconds to wait before a retry."""

from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from paretour.expect import UnexpectedAnswer, count, each, members, number, parse_json, text
from paretour.remedies import Remedy, parse_remedy

if TYPE_CHECKING:
    import httpx

RETRY_STATUSES = (429, 503)
_LEAST_SECONDS = 0.1  # between two tries, even if Retry-After is 0
_MOST_SECONDS = 86400.0
_DEFAULT_SECONDS = 1.0


class Refused(Exception):
    """The service answered with an error: a problem document (RFC 9457).

    Attributes:
        status: The HTTP status.
        code: The kind of error, in a word that stays the same in all releases. A response of a
            proxy that is not a problem document has the code `unknown`.
        detail: The error in a sentence.
        request_id: The id of the request in the service's log.
        errors: The wrong fields, each with its `detail` and a JSON `pointer` or `parameter`; with
            the `code` of what is wrong, and by name the `values` of the sentence, if it has any.
        remedies: Changes to the request after each of which there is a plan.
        limit: The most that is allowed, if a limit was exceeded.
        actual: The number that was over the limit.
        document: The problem document.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        problem = members(document, "problem")
        self.document = document
        self.detail: str = problem.read("detail", text)
        super().__init__(self.detail)
        self.status: int = problem.read("status", count)
        self.code: str = problem.read("code", text)
        self.request_id: str | None = problem.maybe("request_id", text)
        faults = problem.maybe("errors", each(members)) or ()
        self.errors: tuple[Mapping[str, Any], ...] = tuple(fault.document for fault in faults)
        self.remedies: tuple[Remedy, ...] = tuple(
            remedy
            for fault in faults
            for remedy in fault.maybe("remedies", each(parse_remedy)) or ()
        )
        self.limit: float | None = problem.maybe("limit", number)
        self.actual: float | None = problem.maybe("actual", number)

    def __str__(self) -> str:
        return f"{self.detail} ({self.code})"


def refused(response: "httpx.Response") -> Refused:
    """Return the exception for a response that is an error and has been read."""
    content_type = response.headers.get("content-type", "").partition(";")[0]
    if content_type == "application/problem+json":
        with suppress(UnexpectedAnswer):
            return Refused(parse_json(response.content, "problem").document)
    detail = f"{response.url} answered {response.status_code} {response.reason_phrase}"
    if response.has_redirect_location:
        detail += f", to {response.headers['location']}"
    return Refused({"status": response.status_code, "code": "unknown", "detail": detail})


def retry_after(response: "httpx.Response") -> float:
    """Return the seconds that Retry-After asks for, as a number or as a date, at most a day."""
    header = response.headers.get("retry-after", str(int(_DEFAULT_SECONDS)))
    if header.strip().isdecimal():
        seconds = float(header)
    else:
        from email.utils import parsedate_to_datetime  # rarely needed, and slow to import

        try:
            date = parsedate_to_datetime(header)
        except (ValueError, TypeError, IndexError, OverflowError):
            return _DEFAULT_SECONDS
        known = date if date.tzinfo else date.replace(tzinfo=UTC)
        seconds = (known - datetime.now(UTC)).total_seconds()
    return min(max(seconds, _LEAST_SECONDS), _MOST_SECONDS)
